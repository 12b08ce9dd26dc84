"""Signatures of joint effects in the tip of the paper's moving arm, against closed forms.

The arm moves slowly about the level position, where its torque about the hinge stays what it is, or swings
about the vertical through its whole range.
"""

import numpy as np
import pytest
from arms import LENGTH, drive, paper_arm, smooth_step

import flexarm
from flexarm.effects import (
    CoulombFriction,
    Effect,
    JointCompliance,
    JointHysteresis,
    LugreFriction,
    MotorFriction,
    ViscousFriction,
)

K = 1e5
LEVEL = np.pi / 2
PERIOD, SWING = 24.0, 0.3
TURNS = (6.0, 18.0)


def slow(t: np.ndarray) -> np.ndarray:
    """About the level position, from rest [rad]; turns at 6 and 18 s."""
    return LEVEL + SWING * np.sin(2 * np.pi * t / PERIOD) * smooth_step(t / 3)


def damped(*effects: Effect, damping: float = 4000.0) -> flexarm.Arm:
    """The paper's arm on a spring whose damper takes the ringing away."""
    model = paper_arm(2, damping_ratio=0.05)
    return model.replace(effects=(JointCompliance(at="hinge", stiffness=K, damping=damping), *effects))


def along_the_path(*effects: Effect, end: float = 24.0) -> tuple[np.ndarray, np.ndarray]:
    """Instants, and what the effects move the tip along the tangent [m]."""
    turn = drive({"hinge": slow}, end, 1501)
    one = flexarm.simulate(damped(*effects), turn, step=4e-3)
    two = flexarm.simulate(damped(), turn, step=4e-3)
    q = two.drive_angle[:, 0]
    gap = one.position[:, 0] - two.position[:, 0]
    return one.time, gap[:, 0] * np.cos(q) - gap[:, 2] * np.sin(q)


def settled(t: np.ndarray) -> np.ndarray:
    """Instants from which the last turn is 2.5 s or more away, when the arm no longer rings from it."""
    since = np.min([np.where(t < turn, np.inf, t - turn) for turn in (0.0, *TURNS)], axis=0)
    before = np.min([np.where(t > turn, np.inf, turn - t) for turn in TURNS], axis=0)
    return (since > 2.5) & (before > 0.2)


@pytest.mark.parametrize(
    "friction",
    [
        CoulombFriction(at="hinge", torque=20.0),
        LugreFriction(at="hinge", coulomb=20.0, breakaway=20.0, bristle_stiffness=1e6),
    ],
    ids=lambda effect: effect.name,
)
def test_friction_of_the_bearing_steps_where_the_velocity_changes_sign(friction):
    """The spring carries T_c more or less: steps of 2 T_c/k L, at the turns of the motor."""
    t, gap = along_the_path(friction)
    sign = np.sign(np.cos(2 * np.pi * t / PERIOD))
    height = 20.0 / K * LENGTH
    assert gap[settled(t)] == pytest.approx(-sign[settled(t)] * height, abs=0.04 * height)
    for turn in TURNS:
        before, after = (t > turn - 2) & (t < turn - 0.2), (t > turn + 2.5) & (t < turn + 4)
        assert abs(gap[before].mean() - gap[after].mean()) == pytest.approx(2 * height, rel=0.02)


def test_viscous_friction_follows_the_velocity():
    """-c theta'/k L."""
    c = 300.0
    t, gap = along_the_path(ViscousFriction(at="hinge", coefficient=c))
    rate = 2 * np.pi / PERIOD * SWING * np.cos(2 * np.pi * t / PERIOD)
    late = t > 4
    assert gap[late] == pytest.approx(-c * rate[late] / K * LENGTH, abs=0.03 * c * np.max(rate) / K * LENGTH)


def test_motor_friction_moves_no_tip_where_the_motors_angle_is_given():
    _, gap = along_the_path(MotorFriction(at="hinge", coulomb=15.0, viscous=8.0), end=4.0)
    assert np.abs(gap).max() < 1e-8  # of Newton's tolerance, 3e-10 of the reach


def swinging(t: np.ndarray) -> np.ndarray:
    """Through the vertical, 1.2 rad to either side; turns at 5, 15, 25 s."""
    return 1.2 * np.sin(2 * np.pi * t / 20) * smooth_step(t / 4)


def test_hysteresis_takes_4_t_times_amplitude_less_width_a_cycle():
    """Dahl's loop between -a and a, a >> w, encloses 4 T (a - w); here d is that of the arm's own weight.

    The damper of the reducer takes some 0.3 % of it, which the run without hysteresis tells.
    """
    torque, width = 60.0, 3e-4
    turn = drive({"hinge": swinging}, 35.0, 3501)
    taken = []
    for effects in ((JointHysteresis(at="hinge", torque=torque, width=width),), ()):
        run = flexarm.simulate(damped(*effects, damping=400.0), turn, step=4e-3)
        cycle = (run.time > 15 - 1e-9) & (run.time < 35 + 1e-9)
        taken.append(np.ptp(run.damped[cycle]))
        if effects:
            a = 0.5 * np.ptp((run.drive_angle - run.joint_angle)[cycle, 0])
    assert a > 10 * width
    assert taken[0] - taken[1] == pytest.approx(4 * torque * (a - width), rel=0.01)


def test_hysteresis_lags_in_the_tip_by_its_torque_over_the_stiffness():
    """T_h helps the spring while the deflection grows and hinders it on the way back: T_h/k L on the tip."""
    torque, width = 30.0, 1e-5
    turn = drive({"hinge": swinging}, 20.0, 2001)
    with_it = damped(JointHysteresis(at="hinge", torque=torque, width=width))
    one, two = (flexarm.simulate(model, turn, step=5e-3) for model in (with_it, damped()))
    q, gap = two.drive_angle[:, 0], one.position[:, 0] - two.position[:, 0]
    tangential = gap[:, 0] * np.cos(q) - gap[:, 2] * np.sin(q)
    growing = np.gradient((two.drive_angle - two.joint_angle)[:, 0], two.time)
    steady = ((two.time > 8) & (two.time < 14)) | (two.time > 18)
    expected = np.sign(growing[steady]) * torque / K * LENGTH
    assert tangential[steady] == pytest.approx(expected, abs=0.06 * torque / K * LENGTH)
