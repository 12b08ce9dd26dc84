"""A link as a chain of rigid rods in the plane, written apart from flexarm: absolute angles, complex numbers.

A place of the arm is p = z + i x, and rod j points along E_j = exp(i alpha_j): upright at alpha = 0, leaning
to +x. The centre of mass p is linear in E, so that the equations of motion are those of a multiple pendulum:

    p = sum_j a_pj E_j,   G_ij = sum_p m_p conj(a_pi) a_pj + J_i delta_ij,   b_j = sum_p m_p a_pj          (1)
    C_ij = conj(E_i) G_ij E_j                                                                             (2)
    Re(C) alpha'' = Im(C) alpha'^2 + g Im(b E) + Q                                                        (3)

Bending sits in springs at two Gauss points of each of n equal segments, with weights w_g = L/(2 n):

    tau_g = (EI/w_g) [Delta_g - r_g + eta (Delta_g' - r_g')],   Delta_g = alpha_(g+1) - alpha_g            (4)

The quadrature of the bending moment is exact for cubics: ends of segments deflect as Euler and Bernoulli's
beam does under loads at them, and turn with it. The rods are inextensible; a rod's weight and momentum are
those of a straight one. A bow is a uniform curvature without load: r_g = w_g 2 u/L^2 (1 - exp(-t/tau)).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]


@dataclass(frozen=True)
class Link:
    """A tube and what it carries at its end; SI units.

    Attributes
    ----------
    offset : (2,)
        Centre of the load from the tip, across (x at alpha = 0) and along the link.
    damping_ratio : float
        Of the link alone in its first clamped mode, proportional to stiffness.
    bow, bow_time
        u and tau of the bow [m], [s]; with bow_time = 0 it is there from the start.
    """

    length: float
    EI: float
    rho_A: float
    rho_I: float = 0.0
    segments: int = 4
    mass: float = 0.0
    offset: tuple[float, float] = (0.0, 0.0)
    inertia: float = 0.0
    damping_ratio: float = 0.0
    bow: float = 0.0
    bow_time: float = 0.0
    gravity: float = 9.81

    @cached_property
    def rods(self) -> Floats:
        """Lengths of the rods, between the Gauss points."""
        half = 0.5 / np.sqrt(3)
        points = np.ravel(np.arange(self.segments)[:, None] + [0.5 - half, 0.5 + half]) / self.segments
        return self.length * np.diff(points, prepend=0.0, append=1.0)

    @cached_property
    def inertias(self) -> tuple[Complexes, Complexes]:
        """G and b of (1)."""
        n, lengths = len(self.rods), self.rods.astype(complex)
        masses = self.rho_A * self.rods
        arms = np.tril(np.tile(lengths, (n, 1)), -1) + np.diag(lengths / 2)  # centres of the rods
        load = lengths.copy()
        load[-1] += self.offset[1] + 1j * self.offset[0]
        arms, masses = np.vstack([arms, load]), np.append(masses, self.mass)
        G = arms.conj().T @ (masses[:, None] * arms)
        turning = self.rho_A * self.rods**3 / 12 + self.rho_I * self.rods
        turning[-1] += self.inertia
        return G + np.diag(turning), masses @ arms  # eq. (1)

    @property
    def spring(self) -> float:
        """Stiffness of one spring, EI/w_g of (4) [N m/rad]."""
        return self.EI * 2 * self.segments / self.length

    @property
    def retardation(self) -> float:
        """eta of (4) = 2 zeta/omega_1 [s], omega_1 = 1.8751^2 sqrt(EI/(rho A L^4))."""
        if self.damping_ratio == 0:
            return 0.0
        return 2 * self.damping_ratio / (1.875104069**2 * np.sqrt(self.EI / self.rho_A) / self.length**2)

    def rest(self, t: float) -> tuple[float, float]:
        """r_g of (4) and its rate."""
        full = self.length / (2 * self.segments) * 2 * self.bow / self.length**2
        if self.bow_time == 0:
            return full, 0.0
        fading = np.exp(-t / self.bow_time)
        return full * (1 - fading), full * fading / self.bow_time

    def bending(self, t: float, alpha: Floats, rate: Floats) -> Floats:
        """Q of (3) that the springs (4) give; first axis the rods."""
        r, r_rate = self.rest(t)
        tau = self.spring * (
            np.diff(alpha, axis=0) - r + self.retardation * (np.diff(rate, axis=0) - r_rate)
        )  # eq. (4)
        Q = np.zeros_like(alpha)
        Q[:-1] += tau
        Q[1:] -= tau
        return Q

    def equations(self, t: float, alpha: Floats, rate: Floats) -> tuple[Floats, Floats]:
        """Mass matrices Re C and right-hand sides of (3), for columns of angles: (k, n, n) and (k, n)."""
        G, b = self.inertias
        E = np.exp(1j * alpha.T)
        C = E.conj()[:, :, None] * G * E[:, None, :]  # eq. (2)
        turning = np.einsum("kij,kj->ki", C.imag, rate.T**2)
        weight = self.gravity * (b * E).imag
        return C.real, turning + weight + self.bending(t, alpha, rate).T  # eq. (3)

    def energy(self, t: float, alpha: Floats, rate: Floats) -> float:
        """Kinetic, elastic and gravity energy of one state [J]."""
        G, b = self.inertias
        E = np.exp(1j * alpha)
        kinetic = 0.5 * np.real(np.conj(rate * E) @ G @ (rate * E))
        elastic = 0.5 * self.spring * np.sum((np.diff(alpha) - self.rest(t)[0]) ** 2)
        return float(kinetic + elastic + self.gravity * np.real(b @ E))

    def place(self, alpha: Floats, fraction: float, offset: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """x and z of a point at the end of a segment, shape (instants, 2); `offset` across and along there.

        Raises
        ------
        ValueError
            If the fraction of the length is no end of a segment: between them the chain is not exact.
        """
        segment = fraction * self.segments
        if abs(segment - round(segment)) > 1e-9:
            raise ValueError(f"fraction must be a multiple of 1/{self.segments}, got {fraction}")
        last = 2 * round(segment)
        E = np.exp(1j * np.asarray(alpha))
        rest = fraction * self.length - self.rods[:last].sum()
        p = self.rods[:last] @ E[:last] + (rest + offset[1] + 1j * offset[0]) * E[last]
        return np.stack([p.imag, p.real], axis=-1)


@dataclass(frozen=True)
class Vibration:
    """Moment amplitude sin(2 pi frequency t + phase) on the base; N m, Hz, rad."""

    amplitude: float = 0.0
    frequency: float = 0.0
    phase: float = 0.0

    def __call__(self, t: float) -> float:
        return self.amplitude * np.sin(2 * np.pi * self.frequency * t + self.phase)


@dataclass(frozen=True)
class Base:
    """What the hinge stands on: tilted, or a spring and a damper about the hinge's axis; SI units."""

    stiffness: float = np.inf
    damping: float = 0.0
    tilt: float = 0.0
    vibration: Vibration = field(default_factory=Vibration)
