"""Equations (1) and (2) beside the finite-element model: where they agree, and where they stop."""

import math

import numpy as np
import pytest
from pytest import approx

import flexarm
from flexarm.analytic import (
    FlexibleLink,
    LinearModal,
    MotorAngle,
    NonlinearModal,
    OneLinkArm,
    RampedSine,
    equilibrium,
    exact_modes,
    pinned_free_basis,
    simulate,
    small_vibrations_hz,
    tip_position,
)
from flexarm.errors import InvalidParameter

AREA, INERTIA, L, LOAD, SPRING = 5.82e-4, 2.37e-7, 3.0, 14.1, 1e5
LINK = FlexibleLink(L, 210e9 * INERTIA, 7850 * AREA, LOAD)


def finite_elements(elements=8, spring=SPRING, hanging=False, load=LOAD, gravity=9.81, damping=(0.0, 0.0)):
    """The same arm for the finite-element model; a hanging one has its joint's frame turned upside down."""
    section = {"shape": "general", "area": AREA, "second_moment": INERTIA, "torsion_constant": 2 * INERTIA}
    rod = {
        "name": "rod", "type": "beam", "end": [0, 0, L], "section": section, "theory": "euler-bernoulli",
        "material": {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 7850}, "elements": elements,
        "damping_ratio": damping[1],
    }  # fmt: skip
    hinge = {
        "name": "hinge", "type": "revolute", "parent": "base", "child": "rod", "axis": [0, 1, 0],
        "origin": {"xyz": [0, 0, 0], "rpy": [0, math.pi if hanging else 0, 0]},
    }  # fmt: skip
    compliance = {"name": "joint_compliance", "at": "hinge", "stiffness": spring, "damping": damping[0]}
    return flexarm.Arm.model_validate(
        {
            "format": "flexarm-arm/1", "name": "one link", "gravity": [0, 0, -gravity],
            "joints": [hinge], "links": [rod],
            "payloads": [{"name": "load", "link": "rod", "position": [0, 0, L], "mass": load}],
            "points": [{"name": "tip", "link": "rod", "position": [0, 0, L]}],
            "effects": [compliance] if math.isfinite(spring) else [],
        }
    )  # fmt: skip


def in_plane_hz(modes, count):
    """Frequencies whose tip moves in the plane of the joint rather than along its axis."""
    in_plane = np.hypot(modes.shape[:, 0, 0], modes.shape[:, 0, 2]) > np.abs(modes.shape[:, 0, 1])
    return modes.frequency_hz[in_plane][:count]


def fem_swing(swing, end, hanging, gravity=9.81):
    """Time and tangential and radial offset of the tip by 8 elements, steps of 1 ms, no damping."""
    time = np.linspace(0, end, 1501)
    drive = flexarm.Drive.from_samples(time, {"hinge": swing(time)})
    arm = finite_elements(hanging=hanging, gravity=gravity)
    run = flexarm.simulate(arm, drive, step=1e-3, alpha=0.0)
    angle = swing(run.time) + (math.pi if hanging else 0.0)
    radial, tangential = np.array([np.sin(angle), np.cos(angle)]), np.array([np.cos(angle), -np.sin(angle)])
    offset = run.position[:, 0, [0, 2]].T - L * radial
    return run.time, np.sum(offset * tangential, axis=0), np.sum(offset * radial, axis=0)


@pytest.mark.parametrize("spring", [SPRING, math.inf])
def test_finite_elements_tend_to_the_exact_frequencies(spring):
    """Fourth order in the number of elements; three modes, no gravity."""
    exact = exact_modes(LINK, 3, spring).frequency_hz
    n = np.array([4, 8, 16])
    error = [
        in_plane_hz(flexarm.modes(finite_elements(int(k), spring), count=8, gravity=False), 3) / exact - 1
        for k in n
    ]
    order = np.polyfit(np.log(1 / n), np.log(np.abs(error)), 1)[0]
    assert order == approx(np.full(3, 4.0), abs=0.3)
    assert error[-1] == approx(np.zeros(3), abs=4e-5)


@pytest.mark.parametrize(("angle", "hanging"), [(0.0, False), (0.0, True), (0.9, False), (1.2, True)])
@pytest.mark.parametrize("spring", [SPRING, math.inf])
def test_small_vibrations_under_gravity_have_the_same_frequencies(angle, hanging, spring):
    """About the loaded equilibrium. A straight arm leaves the axial stretch of the finite elements, 3e-6,
    an arm bent by w the second order (w/L)² = 3e-4.
    """
    arm = NonlinearModal(pinned_free_basis(LINK, 8), hanging=hanging)
    elements = flexarm.modes(finite_elements(32, spring, hanging), {"hinge": angle}, count=6)
    tolerance = 2e-5 if angle == 0 else 1.5e-4
    assert small_vibrations_hz(arm, angle, spring)[:2] == approx(in_plane_hz(elements, 2), rel=tolerance)


@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_small_motions_have_the_same_response(gravity):
    """A swing of 0.02 rad at 0.5 Hz that sets the arm ringing: (1) follows the finite elements within 0.1 %.

    So does (2) without gravity. With it, (L1) lacks gravity's stiffness, its ringing is 0.9 % too slow
    and after three seconds 17 % of the largest offset away.
    """
    swing = RampedSine(0.02, 0.5, 0.8)
    time, tangential, _ = fem_swing(swing, 3.0, hanging=True, gravity=gravity)
    every, largest = slice(None, None, 20), np.abs(tangential).max()

    def difference(kind):
        equation = kind(pinned_free_basis(LINK, 4), gravity=gravity, hanging=True)
        motion = simulate(equation, MotorAngle(swing, SPRING), time[every], step=5e-3)
        return np.abs(motion.tangential - tangential[every]).max() / largest

    assert difference(NonlinearModal) < 1e-3
    if gravity:
        assert difference(LinearModal) == approx(0.173, abs=0.01)
    else:
        assert difference(LinearModal) < 1e-3


def test_both_reach_the_swing_benchmark():
    """Converged offsets at 2, 5, 10, 15 s; 2 µm is what steps of 1 ms leave of the finite elements."""
    swing, instants = RampedSine(1.2, 0.05, 4.0), np.array([0.0, 2.0, 5.0, 10.0, 15.0])
    converged = np.array([-21.45680, -47.96946, 0.85701, 46.34499]) * 1e-3
    time, tangential, radial = fem_swing(swing, 15.0, hanging=True)
    at = np.searchsorted(time, instants - 1e-9)
    motion = simulate(
        NonlinearModal(pinned_free_basis(LINK, 4), hanging=True),
        MotorAngle(swing, SPRING),
        instants,
        step=5e-3,
    )
    assert tangential[at][1:] == approx(converged, abs=3e-6)
    assert motion.tangential[1:] == approx(converged, abs=0.5e-6)
    assert motion.radial == approx(radial[at], abs=6e-6)  # the finite elements stretch by S g/EA


@pytest.mark.parametrize("spring", [SPRING, math.inf])
def test_equation_1_sags_right_up_to_a_third_of_the_length(spring):
    """Horizontal arm under heavier loads: the error is 0.04 (w/L)² of the sag at most, 0.4 % at w = L/3."""
    for load in (100.0, 300.0, 600.0):
        drop = -flexarm.static(
            finite_elements(16, spring, load=load), joints={"hinge": math.pi / 2}
        ).position[0, 2]
        basis = pinned_free_basis(FlexibleLink(L, LINK.bending_stiffness, LINK.mass_per_length, load), 8)
        ours = NonlinearModal(basis)
        error = -tip_position(ours, equilibrium(ours, math.pi / 2, spring))[1] / drop - 1
        assert abs(error) < 0.045 * (drop / L) ** 2
        assert abs(error) > 0.005 * (drop / L) ** 2  # beyond the second order the theories do differ


@pytest.mark.parametrize(
    ("frequency", "deflection", "error", "error_of_2"),
    [(0.2, 0.051, (0.0, 0.004), 0.26), (0.3, 0.20, (0.006, 0.014), 0.23), (0.5, 0.55, (0.04, 0.08), 0.014)],
)
def test_equation_1_stops_agreeing_beyond_a_fifth_of_the_length(frequency, deflection, error, error_of_2):
    """Upright swings of 1.2 rad, faster and faster: the largest difference of the tangential offsets over the
    largest offset is 0.2 % at w = L/20, 1 % at L/5, 6 % at L/2.

    That of (2) is 26 % at L/20 already; at L/2 errors of phase and of size happen to cancel.
    """
    swing, end = RampedSine(1.2, frequency, 0.2 / frequency), 1.5 / frequency
    time, tangential, _ = fem_swing(swing, end, hanging=False)
    every, largest = slice(None, None, 25), np.abs(tangential).max()
    assert largest / L == approx(deflection, rel=0.03)

    def difference(kind):
        equation = kind(pinned_free_basis(LINK, 2))
        motion = simulate(equation, MotorAngle(swing, SPRING), time[every], step=2.5e-3)
        return np.abs(motion.tangential - tangential[every]).max() / largest

    assert error[0] < difference(NonlinearModal) < error[1]
    assert difference(LinearModal) == approx(error_of_2, rel=0.05)


def test_a_models_own_data_give_the_same_damped_motion():
    """`OneLinkArm.of`: beam and joint damping included, the ringing after a brisk start agrees within 0.1
    %.
    """
    model = finite_elements(hanging=True, damping=(300.0, 0.02))
    swing, time = RampedSine(0.02, 0.5, 0.8), np.linspace(0, 2, 101)
    fine = np.linspace(0, 2, 1001)
    run = flexarm.simulate(
        model, flexarm.Drive.from_samples(fine, {"hinge": swing(fine)}), step=1e-3, alpha=0.0
    )
    ours = OneLinkArm.of(model)
    motion = simulate(ours.nonlinear(), ours.drive(swing), time, step=5e-3)
    gap = np.linalg.norm(run.at(time, "tip")[:, [0, 2]] - motion.tip, axis=1)
    assert gap.max() < 1e-3 * np.abs(motion.tangential).max()
    undamped = simulate(
        NonlinearModal(ours.nonlinear().basis, hanging=True), ours.drive(swing), time, step=5e-3
    )
    assert np.abs(undamped.tangential - motion.tangential).max() > 1e-2 * np.abs(motion.tangential).max()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"payloads": [{"name": "load", "link": "rod", "position": [0, 0, 1], "mass": 1}]}, "far end"),
        ({"gravity": [0, 1, -9.81]}, "gravity along z"),
    ],
)
def test_a_model_beyond_the_modal_equations_is_refused(change, message):
    model = flexarm.Arm.from_dict({**finite_elements().to_dict(), **change})
    with pytest.raises(InvalidParameter, match=message):
        OneLinkArm.of(model)
