"""Linear models of arms with closures: poles are the modes, gains those of statics, motions those of runs."""

from __future__ import annotations

import loops
import numpy as np
import pytest
from arms import drive
from pytest import approx
from scipy.signal import lsim

import flexarm
from flexarm.errors import InvalidParameter
from flexarm.linear.free_motion import free_motion

POSE = {"piston": 0.4}
DAMPED = {"effects": [{"name": "joint_compliance", "at": "piston", "stiffness": 4e6, "damping": 2e4}]}


def crane(**more) -> flexarm.Arm:
    """A crane with a flexible boom, which a soft and damped cylinder holds."""
    return flexarm.Arm.from_dict(
        {**loops.crane(loops.beam("boom", 3.0, side=0.15)).to_dict(), **DAMPED, **more}
    )


def positive(poles: np.ndarray) -> np.ndarray:
    return poles[poles.imag > 1e-3]


@pytest.mark.parametrize("inputs", [None, {"piston": "angle"}, {"tip": "force"}])
def test_poles_are_the_modes_of_the_crane(inputs):
    """-zeta omega +- i omega sqrt(1 - zeta^2) with the piston held; its pins follow."""
    found = flexarm.linearise(crane(), POSE, inputs=inputs, outputs=["tip"])
    modes = flexarm.modes(crane(), POSE, count=5)
    poles = positive(found.poles)[:5]
    assert poles.imag / (2 * np.pi) == approx(modes.damped_frequency_hz, rel=1e-7)
    assert -poles.real / np.abs(poles) == approx(modes.damping_ratio, rel=1e-5, abs=1e-9)


def test_friction_of_a_closure_damps_the_linear_model():
    """The damper at the rod's eye is one of C: modes and poles agree with it, and differ without."""
    plain = flexarm.modes(crane(), POSE, count=1).damping_ratio[0]
    arm = crane(
        effects=[*DAMPED["effects"], {"name": "viscous_friction", "at": "rod_eye", "coefficient": 3e4}]
    )
    pole = positive(flexarm.linearise(arm, POSE, inputs={"piston": "angle"}).poles)[0]
    assert -pole.real / abs(pole) == approx(flexarm.modes(arm, POSE, count=1).damping_ratio[0], rel=1e-5)
    assert -pole.real / abs(pole) > 1.2 * plain


def test_static_gains_are_the_differences_of_statics():
    """Central differences: 1e-6 of the gain."""
    model = flexarm.linearise(crane(), POSE, inputs={"piston": "angle"}, outputs=["tip", "boom_pin"])
    gain = model.D - model.C @ np.linalg.solve(model.A, model.B)
    h, seen = 1e-4, []
    for sign in (1, -1):
        at = flexarm.static(crane(), {"piston": 0.4 + sign * h})
        seen.append([*at.position[0], at.link_angle[0]])
    assert gain[:, 0] == approx((np.array(seen[0]) - seen[1]) / (2 * h), rel=1e-5, abs=1e-6)
    at = flexarm.static(crane(), POSE)
    assert model.joint_values == approx(at.drive_angle, abs=1e-12)
    assert model.output_at_rest == approx([*at.position[0], at.link_angle[0]], abs=1e-10)


def test_a_small_motion_of_the_piston_moves_the_tip_as_the_linear_model_says():
    """What differs is of second order in the motion: a hundredth of it at a tenth of the size."""
    end, step, left = 1.0, 1e-3, []
    t = step * np.arange(round(end / step) + 1)
    model = flexarm.linearise(crane(), POSE, inputs={"piston": "acceleration"}, outputs=["tip"])

    def stroke(s: np.ndarray) -> np.ndarray:
        return np.sin(np.pi * s) ** 4

    def acceleration(s: np.ndarray) -> np.ndarray:
        sine, cosine = np.sin(np.pi * s), np.cos(np.pi * s)
        return np.pi**2 * (12 * sine**2 * cosine**2 - 4 * sine**4)

    for size in (1e-3, 1e-4):
        moves = drive({"piston": lambda s, size=size: 0.4 + size * stroke(s)}, end, 2001)
        run = flexarm.simulate(crane(), moves, step=step, alpha=0.0)
        _, y, _ = lsim(model.to_scipy(), size * acceleration(t), t)
        moved = run.position[:, 0] - run.position[0, 0]
        assert np.abs(moved).max() > size
        left.append(np.abs(moved - y).max() / np.abs(moved).max())
    assert left[0] < 1e-2
    assert left[1] < 1e-3


def test_a_frequency_response_is_the_amplitude_of_a_small_steady_swing():
    """A force of 1 N at 3 Hz on the tip after the boom's own swing has died out; the step misses 1e-3."""
    damped = {**loops.beam("boom", 3.0, side=0.15), "damping_ratio": 0.3}
    spring = {**DAMPED["effects"][0], "damping": 2e5}
    arm = flexarm.Arm.from_dict({**loops.crane(damped).to_dict(), "effects": [spring]})
    model = flexarm.linearise(arm, POSE, inputs={"tip": "force"}, outputs=["tip"])
    omega = 2 * np.pi * 3.0
    response = model.C @ np.linalg.solve(1j * omega * np.eye(len(model.A)) - model.A, model.B) + model.D
    sim = flexarm.Stepper(arm, {"piston": "motor"}, forces=["tip"], step=1e-3, alpha=0.0)
    state, seen = sim.start(joints=POSE), []
    for k in range(3000):
        state = sim.step(state, {"piston": 0.4}, {"tip": [0, 0, 100 * np.sin(omega * 1e-3 * (k + 1))]})
        seen.append(sim.point(state, "tip").position)
    late = np.array(seen[2000:])
    t = 1e-3 * np.arange(2001, 3001)
    basis = np.stack([np.sin(omega * t), np.cos(omega * t), np.ones_like(t)], axis=1)
    a, b, _ = np.linalg.lstsq(basis, late, rcond=None)[0]
    assert (a + 1j * b) / 100 == approx(response[:, 2], rel=5e-3, abs=1e-2 * np.abs(response[2, 2]))


def test_a_crank_let_go_swings_by_its_minimal_equation():
    """A crank on a torque: J q'' + V'' q = T about the lowest pose; cuts of the loop agree."""
    poles = []
    for cut in "BCD":
        arm = loops.four_bar(cut, assembly=loops.assembled(cut, 0.9))
        found = flexarm.linearise(arm, {"A": 0.9}, inputs={"A": "torque"}, outputs=["A"])
        poles.append(np.sort(found.poles**2))
        assert found.input_at_rest[0] == approx(flexarm.static(arm, {"A": 0.9}).joint_torque[0], rel=1e-9)
    assert poles[0] == approx(poles[2], rel=1e-7)
    assert poles[1] == approx(poles[2], rel=1e-7)


def test_more_inputs_than_the_loop_has_freedoms_are_refused():
    """The crane has one, and its loop does not close at any two angles."""
    with pytest.raises(InvalidParameter, match="'rod_eye' cannot be closed with boom_pin"):
        flexarm.linearise(crane(), POSE, inputs={"piston": "angle", "boom_pin": "angle"})


def test_a_free_vibration_of_the_crane_has_its_modes():
    """As many states as two modes have."""
    found = free_motion(crane(), POSE, 2)
    modes = flexarm.modes(crane(), POSE, count=2)
    assert np.sort(positive(np.linalg.eigvals(found.A)).imag) / (2 * np.pi) == approx(
        modes.damped_frequency_hz, rel=1e-3
    )
