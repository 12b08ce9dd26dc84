r"""Exponential integration of z' = A z + N(t, z), with the linear part A carried exactly.

The bending modes are fast and linear, what makes equation (1) nonlinear is slow; so the step is set
by the motion and not by the highest mode. With φ_0 = exp, φ_{k+1}(Z) = (φ_k(Z) - 1/k!)/Z, all at Z
= h A unless stated,

    a  = exp(Z/2) z + h/2 φ_1(Z/2) N(t, z)                                                 (E1)
    b  = exp(Z/2) z + h/2 φ_1(Z/2) N(t + h/2, a)
    c  = exp(Z/2) a + h/2 φ_1(Z/2) [2 N(t + h/2, b) - N(t, z)]
    z₁ = exp(Z) z + h [(φ_1 - 3 φ_2 + 4 φ_3) N(t, z) + (2 φ_2 - 4 φ_3) (N_a + N_b)
                       + (4 φ_3 - φ_2) N(t + h, c)]                                        (E2)

is of order four [CoxMatthews2002]. Where N depends on time alone and is a cubic Σ_j g_j (s/h)^j in
a step,

    z₁ = exp(Z) z + h Σ_j j! φ_{j+1} g_j                                                   (E3)

is exact; other N(t) are replaced by the cubic through four of their values in each step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from flexarm.analytic.nonlinear_modal import Array
from flexarm.errors import NotConverged

_THIRDS = np.arange(4) / 3
_CUBIC = np.linalg.inv(np.vander(_THIRDS, 4, increasing=True))
"""Coefficients g_j of the cubic through values at 0, h/3, 2h/3, h."""


@dataclass(frozen=True)
class Propagator:
    """φ_0 to φ_4 of h A and φ_0, φ_1 of h A/2 for one step h."""

    h: float
    full: tuple[Array, ...]
    half: tuple[Array, ...]

    @classmethod
    def of(cls, A: Array, h: float) -> Propagator:
        """Evaluate the matrix functions once for all steps of this length."""
        return cls(h, phi_functions(h * A, 4), phi_functions(h / 2 * A, 1))

    def runge_kutta(self, nonlinear: Callable[[float, Array], Array], t: float, z: Array) -> Array:
        """Make one step of (E1), (E2)."""
        h, (E, f1, f2, f3, _), (E_half, f_half) = self.h, self.full, self.half
        N = nonlinear(t, z)
        a = E_half @ z + h / 2 * (f_half @ N)
        N_a = nonlinear(t + h / 2, a)
        b = E_half @ z + h / 2 * (f_half @ N_a)
        N_b = nonlinear(t + h / 2, b)
        c = E_half @ a + h / 2 * (f_half @ (2 * N_b - N))
        N_c = nonlinear(t + h, c)
        first, middle, last = N, N_a + N_b, N_c
        by_phi = f1 @ first + f2 @ (2 * middle - 3 * first - last) + f3 @ (4 * (first - middle + last))
        return E @ z + h * by_phi  # eq. (E2)

    def forced(self, load: Callable[[float], Array], t: float, z: Array) -> Array:
        """Make one step of (E3)."""
        g = _CUBIC @ np.array([load(t + part * self.h) for part in _THIRDS])
        terms = [math.factorial(j) * (self.full[j + 1] @ g[j]) for j in range(4)]
        result: Array = self.full[0] @ z + self.h * np.sum(terms, axis=0)  # eq. (E3)
        return result


Advance = Callable[[Propagator, float, Array], Array]
"""One step from time and state."""


def phi_functions(Z: Array, highest: int) -> tuple[Array, ...]:
    """Return φ_0(Z) to φ_highest(Z), all from one exponential of a block matrix."""
    from scipy.linalg import expm

    n = len(Z)
    block = np.zeros((n * (highest + 1), n * (highest + 1)))
    block[:n, :n] = Z
    for k in range(highest):
        block[k * n : (k + 1) * n, (k + 1) * n : (k + 2) * n] = np.eye(n)
    row = expm(block)[:n]
    return tuple(row[:, k * n : (k + 1) * n] for k in range(highest + 1))


def march(A: Array, advance: Advance, z: Array, time: Array, step: float) -> Array:
    """Return states at `time`, in equal steps no longer than `step` in each interval; shape (n, len(z))."""
    # No arm moves 1e9 kg^½ m or as much per second; beyond it the step is too long for the nonlinear part.
    largest_state = 1e9
    propagators: dict[float, Propagator] = {}
    states = [z]
    for start, stop in pairwise(time):
        n_steps = max(1, math.ceil((stop - start) / step - 1e-6))
        h = (stop - start) / n_steps
        key = round(h, 12)
        if key not in propagators:
            propagators[key] = Propagator.of(A, h)
        for k in range(n_steps):
            z = advance(propagators[key], start + k * h, z)
            if not np.abs(z).max() < largest_state:
                reached = float(start + (k + 1) * h)
                raise NotConverged(f"t = {reached:.4g} s: the motion grows without bound", time=reached)
        states.append(z)
    return np.array(states)
