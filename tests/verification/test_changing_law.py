"""Tabulated laws that change at an instant, or have a branch for each sense of motion: closed forms."""

import numpy as np
import pytest
from arms import arm as arm_of
from arms import drive, hinge, point, rigid, smooth_step
from numpy.typing import NDArray
from tests.verification.test_sensitivities import difference
from tests.verification.test_tabulated_law import SPRING, arm, close, line, moved, turn

import flexarm
from flexarm.arm.parameter import with_value
from flexarm.effects import CoulombFriction, JointCompliance, TabulatedLaw
from flexarm.errors import InvalidParameter
from flexarm.simulation.prepared import prepared
from flexarm.simulation.solve import solved

TORQUES = (-450.0, -150.0, 0.0, 200.0, 450.0)
INSTANT = 0.61
SOFTENS = TabulatedLaw(
    at="hinge",
    quantity="windup",
    of="torque",
    x=TORQUES,
    value=(3e-3, 5e-4, 0.0, -6e-4, -2e-3),
    value_after=(1e-3, 5e-4, 2e-4, -3e-3, -5e-3),
    instant=INSTANT,
)
ANGLES = (-0.2, 0.3, 0.9, 1.7)
OTHERS = (
    ("windup", "angle", ANGLES, (1e-3, 2e-3, -5e-4, -1.5e-3), (0.0, -2e-3, 1e-3, 2e-3)),
    ("windup", "rate", (-2.0, -0.1, 0.2, 2.0), (-2e-3, -5e-4, 4e-4, 1.5e-3), (1e-3, 2e-4, -3e-4, -2e-3)),
    ("torque", "angle", ANGLES, (5.0, 20.0, -5.0, -15.0), (-5.0, 9.0, 30.0, 35.0)),
    ("torque", "motor_angle", ANGLES, (5.0, 20.0, -5.0, -15.0), (-5.0, 9.0, 30.0, 35.0)),
    ("torque", "rate", (-2.0, -0.1, 0.2, 2.0), (-40.0, -5.0, 6.0, 30.0), (-9.0, -1.0, 2.0, 50.0)),
)
CHANGES = (
    SOFTENS,
    *(
        TabulatedLaw(at="hinge", quantity=q, of=of, x=x, value=y, value_after=z, instant=INSTANT)
        for q, of, x, y, z in OTHERS
    ),
)
NAMES = [f"{law.quantity} of {law.of}" for law in CHANGES]
DRAGS = TabulatedLaw(
    at="hinge",
    quantity="torque",
    of="angle",
    x=ANGLES,
    value=(10.0, 40.0, 60.0, 45.0),
    value_falling=(-20.0, -15.0, 5.0, -5.0),
)


def one_branch(law: TabulatedLaw, name: str) -> TabulatedLaw:
    """The law whose only table is that branch."""
    return TabulatedLaw(at=law.at, quantity=law.quantity, of=law.of, x=law.x, value=getattr(law, name))


@pytest.mark.parametrize("law", CHANGES, ids=NAMES)
def test_until_the_instant_a_run_is_that_of_the_law_before(law):
    """The change begins half its duration before the instant."""
    run, before = moved(arm(SPRING, law)), moved(arm(SPRING, one_branch(law, "value")))
    early = run.time < INSTANT - law.duration / 2
    assert run.joint_angle[early] == pytest.approx(before.joint_angle[early], abs=1e-13)
    assert np.abs(run.joint_angle - before.joint_angle).max() > 1e-5


@pytest.mark.parametrize("law", CHANGES, ids=NAMES)
@pytest.mark.parametrize(("instant", "branch"), [(-1.0, "value_after"), (9.0, "value")])
def test_a_change_before_a_run_or_after_it_leaves_one_law(law, instant, branch):
    """The equilibrium at the start is of that law too."""
    alone = moved(arm(SPRING, one_branch(law, branch)))
    close(moved(arm(SPRING, law.replace(instant=instant))), alone, 1e-12)


def test_statics_take_the_law_at_time_zero():
    for instant, branch in ((1.0, "value"), (-1.0, "value_after")):
        found, expected = (
            flexarm.static(arm(SPRING, law), {"hinge": 1.2}).position
            for law in (SOFTENS.replace(instant=instant), one_branch(SOFTENS, branch))
        )
        assert found == pytest.approx(expected, abs=1e-12)


def ringing(before: float, after: float, instant: float, step: float) -> tuple[flexarm.Simulation, float]:
    """A rigid link without gravity that rings on a spring whose stiffness changes, and its inertia."""
    k, inertia = 8e4, 120.0
    windup = [line("windup", "torque", 1 / k - 1 / each).value for each in (before, after)]
    law = line("windup", "torque", 0.0).replace(value=windup[0])
    law = law.replace(value_after=windup[1], instant=instant, duration=2e-3)
    model = arm_of(
        name="bar",
        gravity=[0, 0, 0],
        joints=[hinge("hinge", "bar")],
        links=[rigid("bar", 30.0, [0, 0, 0], [inertia, inertia, 1.0])],
        points=[point("tip", "bar", [0, 0, 2.0])],
    ).replace(effects=(JointCompliance(at="hinge", stiffness=k), law))
    kick = drive({"hinge": lambda t: 0.02 * smooth_step(t / 0.1)}, 6.0, 6001)
    return flexarm.simulate(model, kick, step=step, alpha=0.0), inertia


def frequency(time: NDArray, angle: NDArray) -> float:
    """The angular frequency of a harmonic about zero, from its rises through it, by lines between samples."""
    rises = np.flatnonzero((angle[:-1] < 0) & (angle[1:] >= 0))
    at = time[rises] - angle[rises] * (time[rises + 1] - time[rises]) / (angle[rises + 1] - angle[rises])
    return float(2 * np.pi * (len(at) - 1) / (at[-1] - at[0]))


def test_a_spring_that_softens_rings_slower_from_the_instant_on():
    """omega = sqrt(k/I); steps of 1 ms make it (omega h)^2/12 = 6e-5 less, a crossing errs by 1e-6 s."""
    before, after, instant = 8e4, 4e4, 3.0
    run, inertia = ringing(before, after, instant, 1e-3)
    d = run.joint_angle[:, 0] - 0.02
    for k, part in ((before, (run.time > 0.2) & (run.time < 2.9)), (after, run.time > 3.1)):
        assert frequency(run.time[part], d[part]) == pytest.approx(np.sqrt(k / inertia), rel=1e-4)


def test_where_a_spring_softens_angle_and_rate_are_continued():
    """After it A^2 = d^2 + (d'/omega)^2 of the instant; a ramp of two steps, omega h = 0.03, leaves 2e-3."""
    before, after, instant = 8e4, 4e4, 3.0
    run, inertia = ringing(before, after, instant, 1e-3)
    d, rate = run.joint_angle[:, 0] - 0.02, run.joint_rate[:, 0]
    alone, _ = ringing(before, before, instant, 1e-3)
    at = round(instant / 1e-3)
    omega = np.sqrt(after / inertia)
    there = np.hypot(alone.joint_angle[at, 0] - 0.02, alone.joint_rate[at, 0] / omega)
    amplitude = np.hypot(d, rate / omega)[run.time > 3.1]
    assert amplitude == pytest.approx(there, rel=2e-3)


@pytest.mark.parametrize("law", CHANGES, ids=NAMES)
def test_energy_is_accounted_for_across_a_change(law):
    """Kinetic + elastic + gravity + damped - work stays: sums over steps of 0.5 ms leave 2e-4 of it."""
    run = flexarm.simulate(arm(SPRING, law), turn(), step=5e-4)
    total = run.kinetic + run.elastic + run.gravity + run.damped - run.work
    assert np.ptp(total) <= 2e-4 * np.ptp(run.gravity)


@pytest.mark.parametrize("law", CHANGES, ids=NAMES)
@pytest.mark.parametrize("parameter", ["value.1", "value_after.2", "instant"])
def test_derivatives_of_a_change_are_those_of_differences(law, parameter):
    """Within 1e-6 of the greatest and the doubt of differences; instants are no multiple of the step.

    The instant moves the line of the change over no step, so that both are of the same smooth function.
    """
    key = f"effects.tabulated_law.hinge.{parameter}"
    law = law.replace(instant=INSTANT + 7e-4)
    model = arm(SPRING, law)
    motion = turn(2.0)
    found = flexarm.simulate(model, motion, step=2e-3, sensitivities=[key]).sensitivities
    assert found is not None
    size = 1e-4 if parameter == "instant" else 1e-3 * np.linalg.norm(law.value)

    def run(value: float, name: str) -> NDArray:
        one = prepared(with_value(model, key, value), motion, 2e-3, -0.05, None, False, False)
        one.options.tolerance = 1e-14
        return np.asarray(getattr(solved(one, None), name))

    for name in ("position", "joint_angle", "joint_torque", "motor_torque"):
        at = law.value_of(parameter)
        expected, doubt = difference(lambda p, name=name: run(p, name), at, size)
        error = np.abs(found.by(key)[name] - expected).max()
        assert error <= 1e-6 * np.abs(expected).max() + 10 * doubt, name


def test_branches_of_opposite_constants_are_coulomb_friction():
    law = DRAGS.replace(value=(30.0,) * 4, value_falling=(-30.0,) * 4)
    close(moved(arm(SPRING, law)), moved(arm(SPRING, CoulombFriction(at="hinge", torque=30.0))))


def test_equal_branches_are_one_table():
    law = DRAGS.replace(value_falling=DRAGS.value)
    close(moved(arm(SPRING, law)), moved(arm(SPRING, one_branch(DRAGS, "value"))))


def test_the_link_loses_the_torque_of_the_branch_of_its_sense_of_motion():
    """After a turn by ten widths the sense is known to exp(-10); the mean of monotone cubics is theirs
    where slopes have one sign, so values at knots are compared.
    """
    model = arm(SPRING.replace(damping=0.0), DRAGS, rotor_inertia=0.0)
    run = moved(model)
    lost = SPRING.stiffness * (run.drive_angle - run.joint_angle) - run.joint_torque
    lost, theta, rate = lost[:, 0], run.joint_angle[:, 0], run.joint_rate[:, 0]
    seen = 0
    for sign, branch in ((1, DRAGS.value), (-1, DRAGS.value_falling)):
        for knot, value in zip(DRAGS.x[1:3], branch[1:3], strict=True):
            crossing = np.flatnonzero((np.diff(np.sign(theta - knot)) != 0) & (sign * rate[1:] > 0.1))
            for k in crossing:
                there = np.interp(knot, *(each[k : k + 2][::sign] for each in (theta, lost)))
                assert there == pytest.approx(value, abs=0.1)
                seen += 1
    assert seen >= 3


@pytest.mark.parametrize("parameter", ["value.1", "value_falling.2"])
def test_derivatives_of_branches_are_those_of_differences(parameter):
    """Friction that sticks is continued over steps: its differences agree to 1e-3."""
    key = f"effects.tabulated_law.hinge.{parameter}"
    model = arm(SPRING, DRAGS.replace(width=2e-3))
    run = flexarm.simulate(model, turn(2.0), step=2e-3, sensitivities=[key])
    assert run.sensitivities is not None
    size = 1e-2
    ends = [
        flexarm.simulate(with_value(model, key, DRAGS.value_of(parameter) + h), turn(2.0), step=2e-3)
        for h in (size, -size)
    ]
    expected = (ends[0].joint_angle - ends[1].joint_angle) / (2 * size)
    error = np.abs(run.sensitivities.by(key)["joint_angle"] - expected).max()
    assert error <= 1e-3 * np.abs(expected).max()


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"instant": None}, "instant: is missing: a law that changes has value_after and an instant"),
        ({"value_after": ()}, "value_after: is missing: a law that changes"),
        ({"value_after": (0.0, 1.0)}, "value_after: must have as many numbers as x, 5, got 2"),
        ({"duration": 0.0}, "duration: must be positive, got 0 s"),
        ({"of": "motor_angle"}, "value_after: must be left out of a windup of the motor's angle"),
        ({"value_falling": (0.0,) * 5}, "a torque of the angle alone may have two branches"),
        ({"value_after": (0.0, 0.0, 0.0, 0.0, 6e-3)}, "must not rise with the torque by 1/stiffness"),
    ],
)
def test_what_is_wrong_with_a_change_is_named(changes, what):
    with pytest.raises(InvalidParameter, match=what):
        arm(SPRING, SOFTENS.replace(**changes))


def test_a_law_with_branches_does_not_change_too():
    with pytest.raises(InvalidParameter, match="value_falling: must be left out of a law that changes"):
        DRAGS.replace(value_after=DRAGS.value, instant=1.0)


@pytest.mark.parametrize("law", [SOFTENS, DRAGS], ids=["change", "memory"])
def test_a_law_with_two_tables_is_written_as_it_is_read(law, tmp_path):
    arm(SPRING, law).to_toml(tmp_path / "arm.toml")
    assert flexarm.Arm.from_toml(tmp_path / "arm.toml").effect("tabulated_law", "hinge") == law
