"""Derivatives where a law has a corner: each is exact, one-sided and says so, or refused."""

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.verification.test_sensitivities import difference, swing_arm

import flexarm
from flexarm.arm.parameter import with_value
from flexarm.simulation.prepared import prepared
from flexarm.simulation.solve import solved

GAP = "effects.backlash.hinge.gap"
SPRING = {"name": "joint_compliance", "at": "hinge", "stiffness": 8e4, "damping": 160.0}
DOWN, UP = (0.0, 0.0, -9.81), (0.0, 0.0, 9.81)  # the arm's zero angle is upright: it stands, or hangs


def closed_gap(gravity: tuple[float, float, float]) -> flexarm.Arm:
    return swing_arm(gravity=gravity, effects=[SPRING, {"name": "backlash", "at": "hinge", "gap": 0.0}])


def rise(end: float = 0.2, height: float = 0.1, from_angle: float = 0.0) -> flexarm.Drive:
    """In one direction, from rest."""
    t = np.linspace(0, end, 41)
    return flexarm.Drive.from_samples(t, {"hinge": from_angle + height * (t / end) ** 3})


# ------------------------------------------------------------------------------ a gap of zero


def test_a_closed_gap_under_torque_has_the_derivative_of_its_opening() -> None:
    """The teeth stay on their flank: half the gap, and a little more by the weight. Stated as one-sided."""
    arm = closed_gap(DOWN)
    found = flexarm.static(arm, {"hinge": 0.5}, sensitivities=[GAP])
    opened = flexarm.static(with_value(arm, GAP, 1e-6), {"hinge": 0.5})
    assert found.sensitivities is not None
    assert found.sensitivities.parameters[0].one_sided
    slope = (opened.link_angle[0] - found.link_angle[0]) / 1e-6
    assert slope == pytest.approx(0.5, rel=2e-2)
    # Of the gap a part of 1e-4 is loose stiffness; the step of 1e-6 sees curvature of that part.
    assert found.sensitivities["link_angle"][0, 0] == pytest.approx(slope, rel=1e-5)


def test_an_arm_that_hangs_rests_in_the_middle_of_an_opening_gap() -> None:
    """There it has the angle that it had: the derivative at the start is zero, and exact."""
    arm = closed_gap(UP)
    found = flexarm.static(arm, sensitivities=[GAP])
    assert found.sensitivities is not None
    assert abs(found.sensitivities["link_angle"][0, 0]) < 1e-9
    assert abs(flexarm.static(with_value(arm, GAP, 1e-6)).link_angle[0] - found.link_angle[0]) < 1e-15
    run = flexarm.simulate(arm, rise(), step=2e-3, sensitivities=[GAP])
    assert run.sensitivities is not None
    assert np.abs(run.sensitivities["position"][0]).max() < 1e-9


@pytest.mark.parametrize("angle", [0.0, 1e-9])
def test_an_arm_that_stands_upright_is_refused_the_derivative_by_a_closed_gap(angle: float) -> None:
    """It falls on a flank, half the gap away at once; which one it is, nothing decides."""
    arm = closed_gap(DOWN)
    opened = flexarm.static(with_value(arm, GAP, 1e-6), {"hinge": angle})
    assert abs(opened.link_angle[0] - angle) == pytest.approx(0.5e-6, rel=2e-2)
    why = "gap has no derivative at a gap of zero: .* falls on one of its flanks .* give the gap a width"
    with pytest.raises(flexarm.InvalidParameter, match=why):
        flexarm.static(arm, {"hinge": angle}, sensitivities=[GAP])
    with pytest.raises(flexarm.InvalidParameter, match=why):
        flexarm.simulate(arm, rise(from_angle=angle), step=2e-3, sensitivities=[GAP])
    wide = with_value(arm, GAP, 1e-6)
    found = flexarm.static(wide, {"hinge": angle}, sensitivities=[GAP]).sensitivities
    assert found is not None and abs(found["link_angle"][0, 0]) == pytest.approx(0.5, rel=2e-2)


@pytest.mark.parametrize("gravity", [DOWN, UP])
def test_frequencies_jump_when_a_gap_without_torque_opens(gravity: tuple[float, float, float]) -> None:
    with pytest.raises(flexarm.InvalidParameter, match="gap has no derivative at a gap of zero"):
        flexarm.modes(closed_gap(gravity), sensitivities=[GAP])


def test_frequencies_under_torque_have_the_derivative_of_the_opening_gap() -> None:
    arm = closed_gap(DOWN)
    found = flexarm.modes(arm, {"hinge": 0.5}, count=2, sensitivities=[GAP])
    opened = flexarm.modes(with_value(arm, GAP, 1e-5), {"hinge": 0.5}, count=2)
    assert found.sensitivities is not None
    slope = (opened.frequency_hz - found.frequency_hz) / 1e-5
    # Both are near 0.005 Hz/rad; the models differ by 1e-8 rad, over which rounding leaves some 1e-4 Hz/rad.
    assert found.sensitivities["frequency"][:, 0] == pytest.approx(slope, abs=2e-4)


# --------------------------------------------------------------------------------------- LuGre


def lugre(**changes: float) -> dict[str, object]:
    values = {
        "coulomb": 20.0,
        "breakaway": 28.0,
        "bristle_stiffness": 2e5,
        "bristle_damping": 400.0,
        "viscous": 30.0,
        "stribeck_rate": 0.05,
    }
    return {"name": "lugre_friction", "at": "hinge", **values, **changes}


LUGRE = [key for key in lugre() if key not in ("name", "at")]


def exact(arm: flexarm.Arm, drive: flexarm.Drive, key: str, value: float, name: str) -> NDArray:
    run = prepared(with_value(arm, key, value), drive, 1e-3, -0.05, None, False, False)
    run.options.tolerance = 1e-14
    return np.asarray(getattr(solved(run, None), name))


@pytest.mark.parametrize("key", LUGRE)
@pytest.mark.parametrize("back", [False, True], ids=["from rest", "and back"])
def test_lugre_friction_has_the_derivatives_of_differences(key: str, back: bool) -> None:
    """From rest, where |v| has its corner and the bristles stand straight, and through a reversal."""
    arm, key = swing_arm(effects=[SPRING, lugre()]), f"effects.lugre_friction.hinge.{key}"
    t = np.linspace(0, 0.4, 41)
    angle = 0.02 * np.sin(np.pi * t / 0.4) ** 3 if back else 0.3 * t**3 * (1 + t)
    drive = flexarm.Drive.from_samples(t, {"hinge": angle})
    found = flexarm.simulate(arm, drive, step=1e-3, sensitivities=[key]).sensitivities
    assert found is not None and not found.parameters[0].one_sided
    value = found.parameters[0].value
    for name in ("position", "joint_angle", "motor_torque"):
        expected, doubt = difference(
            lambda p, name=name: exact(arm, drive, key, p, name), value, 1e-4 * value
        )
        error = np.abs(found.by(key)[name] - expected).max()
        assert error <= 1e-4 * np.abs(expected).max() + doubt, name


@pytest.mark.parametrize(
    ("key", "value"), [("breakaway", 20.0), ("coulomb", 28.0), ("bristle_damping", 0.0), ("viscous", 0.0)]
)
def test_lugre_friction_at_its_limits_has_the_derivative_of_the_side_that_is_allowed(
    key: str, value: float
) -> None:
    """No torque more to start than to slip, no damping: allowed is one side, where the law is smooth."""
    arm = swing_arm(effects=[SPRING, lugre(**{key: value})])
    drive, key = rise(0.4, 0.03), f"effects.lugre_friction.hinge.{key}"
    found = flexarm.simulate(arm, drive, step=1e-3, sensitivities=[key]).sensitivities
    assert found is not None
    side = -1.0 if key.endswith("coulomb") else 1.0
    h = side * (1e-3 * value if value else 1e-2)
    for name in ("position", "motor_torque"):
        at = [exact(arm, drive, key, value + k * h, name) for k in range(3)]
        expected = (4 * at[1] - at[2] - 3 * at[0]) / (2 * h)  # of second order, from one side
        error = np.abs(found.by(key)[name] - expected).max()
        assert error <= 1e-3 * np.abs(expected).max(), name
