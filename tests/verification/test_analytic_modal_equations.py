"""Equations (1) and (2) against a beam without approximation, finite elements and closed forms."""

import math

import numpy as np
import pytest
from numpy.polynomial import legendre
from pytest import approx
from scipy.linalg import eigh

from flexarm.analytic import (
    FlexibleLink,
    LinearModal,
    NonlinearModal,
    equilibrium,
    pinned_free_basis,
    small_vibrations_hz,
    tip_position,
)
from flexarm.analytic.exact_modes import exact_modes
from flexarm.errors import InvalidParameter, NotConverged

EI, RHO_A, L, LOAD, G = 210e9 * 2.37e-7, 7850 * 5.82e-4, 3.0, 14.1, 9.81
LINK = FlexibleLink(L, EI, RHO_A, LOAD)
SPRING = 1e5


def modal_arm(n_bending=6, link=LINK, modes_only=False, **options):
    return NonlinearModal(pinned_free_basis(link, n_bending, hub_moment_shape=not modes_only), **options)


def observed_order(h, error):
    return np.polyfit(np.log(h), np.log(np.abs(error)), 1)[0]


class InextensibleBeam:
    """Energies of a beam with the same shapes whose axis keeps its length exactly: u' = sqrt(1 - w'²) - 1.

    Integrals and running integrals in x by interpolation in 48 Gauss-Legendre points. Its bending
    energy is that of the exact curvature, w''/sqrt(1 - w'²), or, if `linear_bending`, of w''.
    """

    def __init__(self, link, n_modes, linear_bending):
        self.linear_bending = linear_bending
        modes = exact_modes(link, n_modes, 0.0)
        node, weight = legendre.leggauss(48)
        x = (node + 1) * L / 2
        running = legendre.legval(np.append(node, 1.0), legendre.legint(np.eye(48), lbnd=-1)).T * L / 2
        self.running = running @ np.linalg.inv(legendre.legvander(node, 47))
        self.x, self.dm = np.append(x, L), np.append(link.mass_per_length * weight * L / 2, link.tip_mass)
        self.weight, self.slope0 = weight * L / 2, modes.shape(0.0, 1)[0, 0]
        self.shape, self.slope = modes.shape(self.x)[1:], modes.shape(x, 1)[1:]
        self.curvature = modes.shape(x, 2)[1:]

    def positions(self, q):
        """Sections along the frame and across it."""
        return self.x + self.running @ (np.sqrt(1 - (q[1:] @ self.slope) ** 2) - 1), q[1:] @ self.shape

    def kinetic(self, q, v):
        slope, slope_rate, rate = q[1:] @ self.slope, v[1:] @ self.slope, self.slope0 * v[0]
        along, across = self.positions(q)
        along_rate = -self.running @ (slope * slope_rate / np.sqrt(1 - slope**2))
        return (
            np.sum(self.dm * ((along_rate - across * rate) ** 2 + (v[1:] @ self.shape + along * rate) ** 2))
            / 2
        )

    def potential(self, q):
        along, across = self.positions(q)
        theta = self.slope0 * q[0]
        height = along * np.cos(theta) - across * np.sin(theta)
        shortening = 0 if self.linear_bending else (q[1:] @ self.slope) ** 2
        bending = (q[1:] @ self.curvature) ** 2 / (1 - shortening)
        return G * np.sum(self.dm * height) + EI * np.sum(self.weight * bending) / 2

    def residual(self, q, v, a):
        """d/dt dT/dv - dT/dq + dV/dq; first derivatives by complex steps, the second by differences."""
        force = gradient(lambda p: self.kinetic(p, v) - self.potential(p), q)
        return rate_of_change(lambda h: gradient(lambda u: self.kinetic(q + h * v, u), v + h * a)) - force


def gradient(function, at):
    steps = at + 1e-30j * np.eye(len(at))
    return np.array([function(point).imag / 1e-30 for point in steps])


def rate_of_change(function, h=1e-3):
    """Derivative at 0 at order four."""
    return (8 * (function(h) - function(-h)) - (function(2 * h) - function(-2 * h))) / (12 * h)


@pytest.mark.parametrize(("linear_bending", "order"), [(True, 2.0), (False, 3.0)])
def test_equation_1_keeps_all_forces_of_first_order_in_the_deflection(linear_bending, order):
    """Against the beam without approximation, at 1.1 rad, 2 rad/s and 3 rad/s².

    The error falls with the cube of the deflection in the rigid row and with its square in the bending
    rows; there the cubic force of the exact curvature, times EI, is the larger one, so that its order
    shows where it is not left out.
    """
    rng = np.random.default_rng(3)
    arm, beam = modal_arm(4, modes_only=True), InextensibleBeam(LINK, 5, linear_bending)
    rigid = np.array([1.1, 2.0, 3.0]) / arm.basis.rotation[0]
    shape = rng.normal(size=(3, 4)) / np.array([1, 3, 10, 30])
    eps, errors = np.array([0.005, 0.01, 0.02]), []
    for scale in eps:
        q, v, a = (np.append(r, scale * s) for r, s in zip(rigid, shape, strict=True))
        alpha = arm.basis.rotation
        equation = a + arm.coupling(q) * (alpha @ a) * alpha - arm.forces(q, v)
        error = equation - beam.residual(q, v, a)
        errors.append([np.abs(error[0]), np.linalg.norm(error[1:])])
    rigid_order, bending_order = (observed_order(eps, column) for column in np.array(errors).T)
    assert rigid_order == approx(3.0, abs=0.3)
    assert bending_order == approx(order, abs=0.1)


def test_gyroscopic_forces_follow_from_the_kinetic_energy():
    """M qdd + h = d/dt dT/dv - dT/dq; the printed form lacks half of its first term, (vᵀ Cw q) Ca v."""
    arm = modal_arm(4)
    printed = NonlinearModal(arm.basis, printed=True)
    q, v, a = np.random.default_rng(5).normal(size=(3, arm.basis.n_modes))

    def kinetic(q, v):
        return arm.energies(q, v)[0]

    momentum = rate_of_change(lambda h: gradient(lambda u: kinetic(q + h * v, u), v + h * a))
    lagrange = momentum - gradient(lambda p: kinetic(p, v), q)
    alpha = arm.basis.rotation
    inertia = a + arm.coupling(q) * (alpha @ a) * alpha
    assert inertia + arm.gyroscopic_forces(q, v) == approx(lagrange, rel=1e-8, abs=1e-8)
    missing = float(v @ arm.basis.Cw @ q) * arm.basis.Ca @ v
    assert arm.gyroscopic_forces(q, v) - printed.gyroscopic_forces(q, v) == approx(missing, rel=1e-12)


@pytest.mark.parametrize("hanging", [False, True])
def test_gravity_forces_follow_from_the_height(hanging):
    """Q = -dV/dq and its tangent are the derivatives of one potential."""
    arm = modal_arm(4, hanging=hanging)
    q = np.random.default_rng(6).normal(size=arm.basis.n_modes)
    force = -gradient(lambda p: arm.energies(p, np.zeros_like(p))[2], q)
    assert arm.gravity_forces(q) == approx(force, rel=1e-12)
    h = 1e-6
    steps = [
        (arm.gravity_forces(q + h * e) - arm.gravity_forces(q - h * e)) / (2 * h) for e in np.eye(len(q))
    ]
    assert arm.gravity_tangent(q) == approx(np.array(steps), rel=1e-6, abs=1e-7)


def test_equation_2_is_equation_1_without_its_matrices():
    """At rest and at the angle of expansion both have the same forces; (2) has no others."""
    arm = modal_arm(4, damping_ratio=0.01)
    linear = LinearModal(arm.basis, damping_ratio=0.01, about=0.4)
    q = np.zeros(arm.basis.n_modes)
    q[0] = 0.4 / arm.basis.rotation[0]
    v = np.random.default_rng(8).normal(size=len(q))
    v[0] = 0.0  # no rotation, no gyroscopic forces
    assert linear.forces(q, v) == approx(arm.forces(q, v), rel=1e-12)
    assert linear.coupling(q + v) == 0.0


def hermite_frequencies(tension, spin, count, load=LOAD, n_elements=30):
    """Clamped cubic elements under an axial tension N(x), in a frame that turns with `spin` [rad/s]."""
    h, size = L / n_elements, 2 * (n_elements + 1)
    stiffness, mass = np.zeros((size, size)), np.zeros((size, size))
    node, weight = legendre.leggauss(5)
    for e in range(n_elements):
        dofs = slice(2 * e, 2 * e + 4)
        for s, w in zip((node + 1) / 2, weight * h / 2, strict=True):
            shape = np.array(
                [1 - 3 * s**2 + 2 * s**3, h * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, h * (s**3 - s**2)]
            )
            slope = (
                np.array(
                    [6 * s**2 - 6 * s, h * (1 - 4 * s + 3 * s**2), 6 * s - 6 * s**2, h * (3 * s**2 - 2 * s)]
                )
                / h
            )
            curvature = np.array([12 * s - 6, h * (6 * s - 4), 6 - 12 * s, h * (6 * s - 2)]) / h**2
            axial = tension((e + s) * h)
            stiffness[dofs, dofs] += w * (
                EI * np.outer(curvature, curvature) + axial * np.outer(slope, slope)
            )
            mass[dofs, dofs] += w * RHO_A * np.outer(shape, shape)
    mass[-2, -2] += load
    free = slice(2, None)
    squares = eigh(stiffness[free, free] - spin**2 * mass[free, free], mass[free, free])[0]
    return np.sqrt(squares[:count]) / (2 * math.pi)


@pytest.mark.parametrize(("hanging", "published"), [(True, 2.85999), (False, 2.82291)])
def test_gravity_stiffens_a_hanging_arm_and_softens_an_upright_one(hanging, published):
    """Against cubic finite elements under the weight's tension, and against known values."""
    frequencies = small_vibrations_hz(modal_arm(8, hanging=hanging), 0.0)[:2]
    sign = 1 if hanging else -1
    elements = hermite_frequencies(lambda x: sign * G * (LOAD + RHO_A * (L - x)), 0.0, 2)
    assert frequencies == approx(elements, rel=1e-6)
    assert frequencies[0] == approx(published, abs=1.5e-4)


def spinning_frequencies(link, rate, n_bending=10):
    """Frequencies of eq. (1) about steady rotation: hub prescribed, det(Tᵀ (Ω - rate² Cw) T - w²) = 0."""
    basis = pinned_free_basis(link, n_bending)
    free = np.linalg.svd(basis.hub_slope[None, :])[2][1:].T
    squares = np.linalg.eigvalsh(free.T @ (np.diag(basis.omega**2) - rate**2 * basis.Cw) @ free)
    return np.sqrt(squares) / (2 * math.pi)


def test_rotation_stiffens_the_arm():
    """Cw holds the centrifugal tension: at 4 rad/s cubic elements under it have the same frequencies."""
    rate = 4.0
    elements = hermite_frequencies(
        lambda x: rate**2 * (LOAD * L + RHO_A * (L**2 - x**2) / 2), rate, 2, n_elements=40
    )
    frequencies = spinning_frequencies(LINK, rate)[:2]
    assert frequencies == approx(elements, rel=2e-6)
    assert np.all(frequencies > spinning_frequencies(LINK, 0.0)[:2])


@pytest.mark.parametrize(("spin", "published"), [(1.0, 3.6817), (2.0, 4.1373), (3.0, 4.7973)])
def test_a_rotating_uniform_beam_has_its_published_frequency(spin, published):
    """[Wright1982], out of plane, Ω and ω in units of sqrt(EI/ρA L⁴); in the plane ω² is smaller by Ω²."""
    unit = math.sqrt(EI / (RHO_A * L**4))
    in_plane = spinning_frequencies(FlexibleLink(L, EI, RHO_A), spin * unit, 30)[0] * 2 * math.pi / unit
    assert math.hypot(in_plane, spin) == approx(published, abs=5e-5)


def test_without_foreshortening_rotation_would_soften_the_arm():
    """The reason why u belongs in (B1): -rate² alone lowers the clamped frequency."""
    with_u, without = (pinned_free_basis(LINK, 4, foreshortening=on).Cw[1, 1] for on in (True, False))
    assert with_u < 0 < without


@pytest.mark.parametrize("stiffness", [math.inf, SPRING])
def test_light_gravity_bends_the_horizontal_arm_by_beam_theory(stiffness):
    """M g L³/3EI + ρA g L⁴/8EI, and the hub's rotation by its torque S g times L, for g -> 0 at order two."""
    per_g = (LOAD * L**3 / 3 + RHO_A * L**4 / 8) / EI + LINK.static_moment * L / stiffness

    def error(g):
        arm = modal_arm(14, gravity=g)
        return -tip_position(arm, equilibrium(arm, math.pi / 2, stiffness))[1] / (g * per_g) - 1

    levels = np.array([0.25, 0.5, 1.0]) * G
    assert abs(error(1e-3 * G)) < 2e-8  # what fourteen shapes leave
    assert observed_order(levels, [error(g) for g in levels]) == approx(2.0, abs=0.05)


@pytest.mark.parametrize(
    ("area", "stiffness", "tangential", "radial"),
    [
        (5.82e-4, math.inf, -34.12642e-3, -0.22961e-3),
        (5.82e-4, SPRING, -52.61750e-3, -0.49696e-3),
        (5.92e-5, math.inf, -25.93831e-3, -0.13430e-3),
    ],
)
def test_the_horizontal_arm_sags_as_known(area, stiffness, tangential, radial):
    """Large-deflection values; equation (1) leaves out terms of relative size (w/L)² = 3e-4."""
    link = FlexibleLink(L, EI, 7850 * area, LOAD)
    arm = modal_arm(8, link)
    tip = tip_position(arm, equilibrium(arm, math.pi / 2, stiffness))
    assert tip[1] == approx(tangential, abs=0.25e-6)
    assert tip[0] - L == approx(radial, abs=0.02e-6)


def test_a_driven_hub_needs_the_shape_that_bends_at_the_hub():
    """First frequency on the hub spring: error of order 1/n with modes alone, above 1/n⁴ with the shape."""
    exact = exact_modes(LINK, 1, SPRING).frequency_hz[0]
    n = np.array([2, 4, 8])

    def error(modes_only):
        arms = [modal_arm(int(k), modes_only=modes_only, gravity=0.0) for k in n]
        return np.array([small_vibrations_hz(arm, 0.0, SPRING)[0] - exact for arm in arms])

    assert np.all(error(True) > 0)  # Rayleigh-Ritz bounds from above
    assert np.all(error(False) > 0)
    assert observed_order(1 / n, error(True)) == approx(1.0, abs=0.15)
    assert observed_order(1 / n, error(False)) > 4
    assert error(True)[0] / exact > 0.05
    assert error(False)[0] / exact < 1e-4


def test_the_extra_shape_leaves_the_basis_orthonormal():
    """Inertia about the joint and the static hub compliance come out of the modal numbers."""
    basis = pinned_free_basis(LINK, 6)
    assert 1 / basis.rotation[0] ** 2 == approx(LINK.joint_inertia, rel=1e-12)
    assert basis.gravity_load[0] == approx(LINK.static_moment * basis.rotation[0], rel=1e-12)
    assert not basis.Cw[0].any()
    assert np.linalg.norm(basis.Cw - basis.Cw.T) < 1e-12 * np.linalg.norm(basis.Cw)


def test_an_arm_that_buckles_has_no_equilibrium():
    """Upright, a spring of less than S g cannot hold the arm: the straight position is unstable."""
    weak = 0.9 * LINK.static_moment * G
    with pytest.raises(NotConverged, match="unstable"):
        small_vibrations_hz(modal_arm(4), 0.0, weak)
    assert small_vibrations_hz(modal_arm(4), 0.0, 1.1 * weak / 0.9)[0] < 0.2


@pytest.mark.parametrize(
    "make",
    [
        lambda: pinned_free_basis(LINK, 0),
        lambda: modal_arm(3, damping_ratio=(0.1, 0.1)),
        lambda: modal_arm(3, damping_ratio=-0.1),
        lambda: modal_arm(3, gravity=math.nan),
        lambda: equilibrium(modal_arm(3), 0.0, -1.0),
    ],
)
def test_values_out_of_range_are_refused(make):
    with pytest.raises(InvalidParameter, match="got"):
        make()
