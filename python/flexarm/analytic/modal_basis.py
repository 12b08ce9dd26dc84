r"""Shapes φ_0..φ_n of the pinned-free beam with load, and the integrals that eqs. (1) and (2) need.

The section at x stands at (x + u) e_r(θ) + w e_t(θ) in a frame that turns with the rigid mode,

    θ = φ_0' q_0,    w = Σ_{i >= 1} φ_i q_i,    u = -½ ∫_0^x w'² dx                        (B1)

u being the foreshortening of an inextensible beam. All modes are mass-orthonormal, load and hub
included. Then

    α_i = δ_i0 φ_0'           θ_dot = αᵀ q_dot,    Ca = α αᵀ                               (B2)
    Cw = W - G                          zero in row and column 0                           (B3)
    W_ij = ∫ φ_i φ_j dm,   G_ij = ∫ s φ_i' φ_j' dx,   s = ∫_x^L x dm                       (B4)
    B_i = ∫ φ_i dm,   N_ij = ∫ μ φ_i' φ_j' dx,         μ = ∫_x^L dm                        (B5)
    U_ij = ∫_0^L φ_i' φ_j' dx                                                              (B6)

s θ_dot² is the centrifugal tension in the beam, μ g its tension when it hangs at rest. Derivation:
docs/theory.md, "Equation (1)". SI units; shapes are in kg^-½.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from flexarm.analytic.exact_modes import ExactModes, beam_points, exact_modes
from flexarm.analytic.flexible_link import FlexibleLink
from flexarm.errors import InvalidParameter

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ModalBasis:
    """One rigid and n bending shapes, mass-orthonormal, with their integrals; arrays are read-only."""

    link: FlexibleLink
    omega: Array
    """Circular frequencies of the pinned link [rad/s]; the first is zero, shape (n + 1,)."""
    rotation: Array
    """α of (B2): the frame's rotation by each coordinate [kg^-½ m^-1], shape (n + 1,)."""
    hub_slope: Array
    tip_shape: Array
    """φ_i'(0) [kg^-½ m^-1], through which the joint torque acts, and φ_i(L) [kg^-½], both with the rigid
    shape, shape (n + 1,)."""
    Cw: Array
    """Deflection inertia less centrifugal stiffness (B3) [-], shape (n + 1, n + 1)."""
    gravity_load: Array
    """B of (B5), rigid shape included [kg^½], shape (n + 1,)."""
    gravity_stiffness: Array
    """N of (B5) [m^-1], shape (n + 1, n + 1)."""
    foreshortening: Array
    """U of (B6): the tip comes nearer by qᵀ U q / 2 [kg^-1 m^-1], shape (n + 1, n + 1)."""

    @property
    def n_modes(self) -> int:
        """Number of coordinates, n + 1."""
        return len(self.omega)

    @property
    def Ca(self) -> Array:
        """α αᵀ of (B2) [kg^-1 m^-2]."""
        return np.outer(self.rotation, self.rotation)


def pinned_free_basis(
    link: FlexibleLink, n_bending: int, *, hub_moment_shape: bool = True, foreshortening: bool = True
) -> ModalBasis:
    """Return modes of the pinned link as assumed shapes, integrated by Gauss-Legendre quadrature.

    Parameters
    ----------
    link : FlexibleLink
        Beam, hub and load.
    n_bending : int
        Number n of bending shapes beside the rigid one, 1 to 60.
    hub_moment_shape : bool
        Let one of the n shapes be the static bending by a torque at the hub instead of the n-th mode.
        No mode of a pinned beam bends at the pin, so a driven hub is represented at order 1/n by modes
        alone (False, the paper's choice) and at order 1/n⁵ with this shape.
    foreshortening : bool
        Keep u of (B1). False sets G = N = U = 0; for comparison only, it makes rotation soften the beam.

    Raises
    ------
    InvalidParameter
        If `n_bending` is out of range.
    """
    if not 1 <= n_bending <= 60:
        raise InvalidParameter(f"number of bending shapes must lie in 1 to 60, got {n_bending}")
    n_exact = n_bending if hub_moment_shape else n_bending + 1
    modes = exact_modes(link, n_exact, hub_stiffness=0.0)
    x, weight = beam_points(link, n_bending + 1)
    samples = _Samples.of_modes(modes, x, weight)
    if hub_moment_shape:
        samples = samples.with_shape(*_hub_moment_shape(link, x))
    return _integrate(samples, float(foreshortening))


@dataclass(frozen=True)
class _Samples:
    """Shapes at the quadrature points of the beam and at its ends; one row a shape."""

    link: FlexibleLink
    omega: Array
    x: Array
    weight: Array
    shape: Array
    slope: Array
    curvature: Array
    hub_slope: Array
    tip_shape: Array
    tip_slope: Array

    @classmethod
    def of_modes(cls, modes: ExactModes, x: Array, weight: Array) -> _Samples:
        length = modes.link.length
        return cls(
            modes.link, modes.omega, x, weight, modes.shape(x), modes.shape(x, 1), modes.shape(x, 2),
            modes.shape(0.0, 1)[:, 0], modes.shape(length)[:, 0], modes.shape(length, 1)[:, 0],
        )  # fmt: skip

    def mass(self) -> Array:
        """Return ∫ φ_i φ_j dm with hub and rotary inertia; the identity for exact modes."""
        link = self.link
        beam = link.mass_per_length * (self.shape * self.weight) @ self.shape.T
        load = link.tip_mass * np.outer(self.tip_shape, self.tip_shape)
        turning = link.tip_inertia * np.outer(self.tip_slope, self.tip_slope)
        hub = link.hub_inertia * np.outer(self.hub_slope, self.hub_slope)
        return beam + load + turning + hub

    def with_shape(
        self, shape: Array, slope: Array, curvature: Array, ends: tuple[float, float, float]
    ) -> _Samples:
        """Add one more shape and take the Ritz vectors of all: mass-orthonormal, stiffness diagonal."""
        rows = zip((self.shape, self.slope, self.curvature), (shape, slope, curvature), strict=True)
        at_ends = zip((self.hub_slope, self.tip_shape, self.tip_slope), ends, strict=True)
        wide = _Samples(
            self.link, np.append(self.omega, 0.0), self.x, self.weight,
            *(np.vstack(pair) for pair in rows), *(np.append(*pair) for pair in at_ends),
        )  # fmt: skip
        return wide._ritz()

    def _ritz(self) -> _Samples:
        from scipy.linalg import eigh

        stiffness = self.link.bending_stiffness * (self.curvature * self.weight) @ self.curvature.T
        mass = self.mass()
        squares, vectors = eigh(stiffness[1:, 1:], mass[1:, 1:] - np.outer(mass[1:, 0], mass[0, 1:]))
        vectors = vectors * np.sign(self.tip_shape[1:] @ vectors)
        turn = np.eye(len(self.omega))
        turn[0, 1:] = -self.mass()[0, 1:] @ vectors
        turn[1:, 1:] = vectors
        rows = [turn.T @ old for old in (self.shape, self.slope, self.curvature)]
        ends = [turn.T @ old for old in (self.hub_slope, self.tip_shape, self.tip_slope)]
        omega = np.append(0.0, np.sqrt(squares))
        return _Samples(self.link, omega, self.x, self.weight, *rows, *ends)


def _hub_moment_shape(link: FlexibleLink, x: Array) -> tuple[Array, Array, Array, tuple[float, float, float]]:
    """Return the shape of a clamped beam with tip load: its moment falls from the hub to zero at the tip."""
    L = link.length
    shape, slope, curvature = x**2 * (3 * L - x) / 6, x * (2 * L - x) / 2, L - x
    return shape, slope, curvature, (0.0, L**3 / 3, L**2 / 2)


def _integrate(samples: _Samples, foreshortening: float) -> ModalBasis:
    link, x, weight = samples.link, samples.x, samples.weight
    bending = np.ones(len(samples.omega))
    bending[0] = 0.0  # w and u of (B1) leave the rigid shape out
    slope = bending[:, None] * samples.slope

    def slopes_weighted_by(tension: Array) -> Array:
        return foreshortening * (slope * (weight * tension)) @ slope.T

    still_to_come = link.mass_per_length * (link.length - x) + link.tip_mass  # μ of (B5)
    moment = link.mass_per_length * (link.length**2 - x**2) / 2 + link.tip_mass * link.length  # s of (B4)
    deflection = np.hstack([samples.shape, samples.tip_shape[:, None]]) * bending[:, None]
    dm = np.append(link.mass_per_length * weight, link.tip_mass)
    arrays = {
        "omega": samples.omega,
        "rotation": (1 - bending) * samples.hub_slope,  # eq. (B2)
        "hub_slope": samples.hub_slope,
        "tip_shape": samples.tip_shape,
        "Cw": (deflection * dm) @ deflection.T - slopes_weighted_by(moment),  # eqs. (B3), (B4)
        "gravity_load": np.hstack([samples.shape, samples.tip_shape[:, None]]) @ dm,  # eq. (B5)
        "gravity_stiffness": slopes_weighted_by(still_to_come),  # eq. (B5)
        "foreshortening": slopes_weighted_by(np.ones_like(x)),  # eq. (B6)
    }
    basis = ModalBasis(link, **arrays)
    for item in fields(basis)[1:]:
        getattr(basis, item.name).setflags(write=False)
    return basis
