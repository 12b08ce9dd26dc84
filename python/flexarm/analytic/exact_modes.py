r"""Exact modes of a beam with a hub spring and a tip load.

With ξ = x/L, λ⁴ = ρA ω² L⁴/EI and a prime for d/dξ, the shape solves

    φ'''' = λ⁴ φ                                                                           (A1)
    φ(0) = 0,    φ''(0) = (κ - j_h λ⁴) φ'(0)                                               (A2)
    φ''(1) = j_e λ⁴ φ'(1),    φ'''(1) = -n λ⁴ φ(1)                                         (A3)

    κ = k_r L/EI,  n = M_e/(ρA L),  j_e = J_e/(ρA L^3),  j_h = J_h/(ρA L^3).

κ = inf is the clamped hub, κ = 0 the pinned one, whose first mode is the rigid rotation. With

    φ = a sin(λ ξ) + b cos(λ ξ) + c exp(-λ ξ) + d exp(-λ (1 - ξ))                          (A4)

instead of hyperbolic functions the 4 x 4 matrix of (A2), (A3) is well conditioned at every λ; the
frequency equation is its determinant. No root is missed or found twice, because the number of
frequencies below a trial value is known beforehand [WittrickWilliams1971]:

    N(λ) = N_cc(λ) + s(D(λ))                                                               (A5)

N_cc counts the frequencies of the beam clamped at both ends, s the negative eigenvalues of the
dynamic stiffness D of the free ends. Derivation: docs/theory.md, "Beam with hub spring and tip
mass". SI units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.analytic.flexible_link import FlexibleLink
from flexarm.errors import InvalidParameter

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EndConditions:
    """Dimensionless numbers κ, n, j_e, j_h of (A2) and (A3)."""

    hub_stiffness: float
    tip_mass: float
    tip_inertia: float
    hub_inertia: float

    @classmethod
    def of(cls, link: FlexibleLink, hub_stiffness: float) -> EndConditions:
        """Scale a link's data; `hub_stiffness` k_r in N m/rad, inf for a clamped hub."""
        if math.isnan(hub_stiffness) or hub_stiffness < 0:
            what = f"hub stiffness must be zero or positive (inf: clamped), got {hub_stiffness} N m/rad"
            raise InvalidParameter(what)
        inertia = link.beam_mass * link.length**2
        return cls(
            hub_stiffness=hub_stiffness * link.length / link.bending_stiffness,
            tip_mass=link.tip_mass / link.beam_mass,
            tip_inertia=link.tip_inertia / inertia,
            hub_inertia=link.hub_inertia / inertia,
        )


@dataclass(frozen=True)
class ExactModes:
    """Modes of one link, normalised to unit modal mass, load and hub included."""

    link: FlexibleLink
    """The link the modes belong to."""
    hub_stiffness: float
    """Rotational spring between hub and ground [N m/rad]."""
    wavenumbers: Array
    """λ [-], zero for a rigid rotation, shape (n_modes,)."""
    coefficients: Array
    """a, b, c, d of (A4) [kg^-½]; for a rigid rotation its slope in ξ stands first, shape (n_modes, 4)."""

    @property
    def omega(self) -> Array:
        """Circular frequencies [rad/s]."""
        beam = self.link
        scale = math.sqrt(beam.bending_stiffness / (beam.mass_per_length * beam.length**4))
        return self.wavenumbers**2 * scale

    @property
    def frequency_hz(self) -> Array:
        """Frequencies [Hz]."""
        return self.omega / (2 * math.pi)

    def shape(self, x: Array | float, derivative: int = 0) -> Array:
        """Return derivatives dᵏφ_i/dxᵏ at `x` [m], in kg^-½ m^-k; shape (n_modes, len(x))."""
        xi = np.atleast_1d(np.asarray(x, dtype=float)) / self.link.length
        rows = [
            row[0] * _rigid(xi, derivative) if lam == 0 else row @ trial_functions(lam, xi, derivative)
            for lam, row in zip(self.wavenumbers, self.coefficients, strict=True)
        ]
        return np.array(rows) / self.link.length**derivative


def exact_modes(link: FlexibleLink, count: int, hub_stiffness: float = math.inf) -> ExactModes:
    """Return the first `count` modes of a link whose hub is held by a rotational spring.

    Parameters
    ----------
    link : FlexibleLink
        Beam, hub and load.
    count : int
        Number of modes, 1 to 150; a pinned hub's rigid rotation is the first of them.
    hub_stiffness : float
        k_r [N m/rad]; inf (default) clamps the hub, 0 pins it.

    Returns
    -------
    ExactModes
        In rising order of frequency, tip deflection positive.

    Raises
    ------
    InvalidParameter
        If a value is out of its range.
    """
    max_modes = 150  # hyperbolic functions in (A5) overflow beyond λ of about 700, some 220 modes
    if not 1 <= count <= max_modes:
        raise InvalidParameter(f"number of exact modes must lie in 1 to {max_modes}, got {count}")
    ends = EndConditions.of(link, hub_stiffness)
    wavenumbers = np.array([wavenumber(ends, k) for k in range(count)])
    coefficients = np.array([_null_vector(ends, lam) for lam in wavenumbers])
    raw = ExactModes(link, hub_stiffness, wavenumbers, coefficients)
    scale = np.sqrt(modal_masses(raw)) * np.sign(raw.shape(link.length)[:, 0])
    coefficients = coefficients / scale[:, None]
    wavenumbers.setflags(write=False)
    coefficients.setflags(write=False)
    return ExactModes(link, hub_stiffness, wavenumbers, coefficients)


def wavenumber(ends: EndConditions, index: int) -> float:
    """Return the root λ of the frequency equation with `index` roots below it."""
    from scipy.optimize import brentq

    # Below it the trial functions (A4) are too alike: 1 - cos cosh loses eight of its sixteen digits.
    smallest_wavenumber = 0.02
    if ends.hub_stiffness == 0 and index == 0:
        return 0.0
    low, high = smallest_wavenumber, math.pi
    if frequencies_below(ends, low) > index:
        raise InvalidParameter(
            f"hub spring is too soft for a frequency of its own: k_r L/EI = {ends.hub_stiffness:.3g}, "
            f"lambda below {smallest_wavenumber}; use a pinned hub (0)"
        )
    while frequencies_below(ends, high) <= index:
        low, high = high, high + math.pi
    while frequencies_below(ends, high) - frequencies_below(ends, low) > 1:
        middle = (low + high) / 2
        if frequencies_below(ends, middle) <= index:
            low = middle
        else:
            high = middle
    return float(
        brentq(lambda lam: float(np.linalg.det(end_matrix(ends, lam))), low, high, xtol=1e-15, rtol=1e-15)
    )


def end_matrix(ends: EndConditions, lam: float) -> Array:
    """Return the rows (A2) and (A3) for the functions (A4), each divided by its largest entry."""
    at_hub = [trial_functions(lam, np.zeros(1), k)[:, 0] / lam**k for k in range(4)]
    at_tip = [trial_functions(lam, np.ones(1), k)[:, 0] / lam**k for k in range(4)]
    if math.isinf(ends.hub_stiffness):
        hub_moment = at_hub[1]
    else:
        spring = ends.hub_stiffness / lam - ends.hub_inertia * lam**3
        hub_moment = (at_hub[2] - spring * at_hub[1]) / (1 + ends.hub_stiffness / lam)  # eq. (A2)
    tip_moment = at_tip[2] - ends.tip_inertia * lam**3 * at_tip[1]  # eq. (A3)
    tip_shear = at_tip[3] + ends.tip_mass * lam * at_tip[0]  # eq. (A3)
    rows = np.array([at_hub[0], hub_moment, tip_moment, tip_shear])
    scaled: Array = rows / np.abs(rows).max(axis=1, keepdims=True)
    return scaled


def trial_functions(lam: float, xi: Array, derivative: int = 0) -> Array:
    """Return the four functions of (A4), differentiated `derivative` times in ξ; shape (4, len(ξ))."""
    s, c = np.sin(lam * xi), np.cos(lam * xi)
    sine, cosine = ((s, c), (c, -s), (-s, -c), (-c, s))[derivative % 4]
    decay, growth = np.exp(-lam * xi), np.exp(-lam * (1 - xi))
    return lam**derivative * np.array([sine, cosine, (-1) ** derivative * decay, growth])


def frequencies_below(ends: EndConditions, lam: float) -> int:
    """Return the number of frequencies below λ, eq. (A5); a rigid rotation counts."""
    c, s, ch, sh = math.cos(lam), math.sin(lam), math.cosh(lam), math.sinh(lam)
    delta = 1 - c * ch
    tip_force = lam**3 * (s * ch + c * sh) / delta - ends.tip_mass * lam**4
    moment = lam * (s * ch - c * sh) / delta
    couple = -(lam**2) * s * sh / delta
    tip = np.array([[tip_force, couple], [couple, moment - ends.tip_inertia * lam**4]])
    stiffness = tip
    if math.isfinite(ends.hub_stiffness):
        hub = moment + ends.hub_stiffness - ends.hub_inertia * lam**4
        across = np.array([-(lam**2) * (ch - c), lam * (sh - s)]) / delta
        stiffness = np.block([[np.array([[hub]]), across[None, :]], [across[:, None], tip]])
    scale = 1 / np.sqrt(np.abs(np.diag(stiffness)))
    negative = np.linalg.eigvalsh(stiffness * np.outer(scale, scale)) < 0
    return _clamped_clamped_below(lam) + int(negative.sum())


def _clamped_clamped_below(lam: float) -> int:
    """Return the roots of 1 = cos(λ) cosh(λ) below λ: one near each (k + ½) π, k = 1, 2, ..."""
    half_waves = int(lam / math.pi)
    sign = 1 if math.cos(lam) * math.cosh(lam) < 1 else -1
    return half_waves - int((-1) ** half_waves * sign < 0)


def _null_vector(ends: EndConditions, lam: float) -> Array:
    """Return the coefficients of (A4) that satisfy the end conditions at a root."""
    if lam == 0:
        return np.array([1.0, 0.0, 0.0, 0.0])
    vector: Array = np.linalg.svd(end_matrix(ends, lam))[2][-1]
    return vector


def _rigid(xi: Array, derivative: int) -> Array:
    """Return the rigid rotation ξ and its derivatives."""
    return xi if derivative == 0 else np.full_like(xi, float(derivative == 1))


def modal_masses(modes: ExactModes) -> Array:
    """Return ∫ ρA φ² dx + M_e φ(L)² + J_e φ_x(L)² + J_h φ_x(0)², shape (n_modes,)."""
    link = modes.link
    x, dm = mass_points(link, len(modes.wavenumbers))
    tip_slope = modes.shape(link.length, 1)[:, 0]
    hub_slope = modes.shape(0.0, 1)[:, 0]
    turning = link.tip_inertia * tip_slope**2 + link.hub_inertia * hub_slope**2
    return modes.shape(x) ** 2 @ dm + turning


def mass_points(link: FlexibleLink, n_modes: int) -> tuple[Array, Array]:
    """Return points x [m] and masses dm [kg] for integrals of two shapes' product; the last is the load."""
    x, weight = beam_points(link, n_modes)
    return np.append(x, link.length), np.append(link.mass_per_length * weight, link.tip_mass)


def beam_points(link: FlexibleLink, n_modes: int) -> tuple[Array, Array]:
    """Return Gauss-Legendre points and weights [m], twelve on every half-wave of the highest mode."""
    node, weight = np.polynomial.legendre.leggauss(12)
    n_panels = n_modes + 3
    start = np.arange(n_panels)[:, None] / n_panels
    x = start + (node + 1) / (2 * n_panels)
    return x.ravel() * link.length, np.tile(weight * link.length / (2 * n_panels), n_panels)
