"""Signatures of joint effects in the tip of the paper's resting arm, against closed forms.

The arm stands upright at q = 0 on a hinge of K = 1e5 N m/rad; at q = 90 degrees it is level and its torque
about the hinge does not change with a small turn. A deflection d of the reducer lets the tip sag by d L along
the tangent, and elsewhere by a few percent more or less, because the bent arm's weight moves with it.
"""

import numpy as np
import pytest
from arms import LENGTH, arm, compliance, fixed, hinge, paper_arm, rigid

import flexarm
from flexarm.effects import (
    Backlash,
    CableTorque,
    Effect,
    GearRatio,
    JointCompliance,
    JointHysteresis,
    JointStiffening,
    TransmissionError,
)
from flexarm.errors import InvalidParameter

K = 1e5
LEVEL = np.pi / 2
LOOSE = 1e-4
"""Part of the stiffness that is left inside a gap, which makes it smaller by the same part."""


def geared(*effects: Effect, ratio: float = 120.0, spring: float | None = K) -> flexarm.Arm:
    """The paper's arm with a reducer and these effects."""
    model = paper_arm(4, spring)
    joint = model.joints[0].replace(gear_ratio=ratio)
    return model.replace(joints=(joint,), effects=(*model.effects, *effects))


def tangential(model: flexarm.Arm, angles: np.ndarray, other: flexarm.Arm | None = None) -> np.ndarray:
    """Tip of the model less that of the other (default: the arm on its spring) along the tangent [m]."""
    gaps = []
    for q in angles:
        one = flexarm.static(model, {"hinge": q}).position[0]
        two = flexarm.static(other or geared(), {"hinge": q}).position[0]
        gaps.append((one - two) @ np.array([np.cos(q), 0.0, -np.sin(q)]))
    return np.array(gaps)


def deflection(model: flexarm.Arm, q: float) -> tuple[float, float]:
    """Torque on the link [N m] and what the reducer is behind its motor [rad]."""
    found = flexarm.static(model, {"hinge": q})
    return float(found.joint_torque[0]), float(found.drive_angle[0] - found.link_angle[0])


def test_compliance_lets_the_tip_sag_by_torque_over_stiffness_times_length():
    torque, d = deflection(geared(), LEVEL)
    assert d == pytest.approx(torque / K, rel=1e-9)
    sag = tangential(geared(), np.array([LEVEL]), geared(spring=None))
    assert sag == pytest.approx(-d * LENGTH, rel=2e-3)


def test_stiffening_takes_the_cubic_part_of_the_deflection_back():
    """k e + k3 e^3 = T; to first order in k3 the tip rises by k3/k (T/k)^3 times the length."""
    k3 = 3e7
    torque, d = deflection(geared(JointStiffening(at="hinge", cubic_stiffness=k3)), LEVEL)
    assert K * d + k3 * d**3 == pytest.approx(torque, rel=1e-9)
    rise = tangential(geared(JointStiffening(at="hinge", cubic_stiffness=k3)), np.array([LEVEL]))
    assert rise == pytest.approx(LENGTH * (torque / K - d), rel=0.01)
    assert rise == pytest.approx(
        LENGTH * k3 / K * (torque / K) ** 3, rel=0.05
    )  # 3 k3 e^2/k = 0.03 is left out


def test_backlash_steps_where_the_torque_changes_sign():
    """The tip lags by half a gap times the length on either side of the vertical: a step of gap x length.

    Near the vertical the weight adds G d to every turn d of the hinge, G = 620 N m/rad of 1e5; away from it
    less: within 4 % of the gap, bending included.
    """
    gap = 4e-4
    loose = geared(Backlash(at="hinge", gap=gap))
    angles = np.array([-LEVEL, -0.3, -0.02, -1e-5, 1e-5, 0.02, 0.3, LEVEL])
    step = tangential(loose, angles)
    assert step == pytest.approx(np.sign(angles) * LENGTH * gap / 2, rel=0.04)
    assert step[[0, -1]] == pytest.approx([-LENGTH * gap / 2, LENGTH * gap / 2], rel=1e-3)
    torque, d = deflection(loose, 0.3)
    assert d == pytest.approx(torque / K - (1 - LOOSE) * gap / 2, rel=1e-9)


def test_backlash_of_a_hanging_arm_lets_it_hang_plumb_inside_the_gap():
    gap = 4e-4
    loose = geared(Backlash(at="hinge", gap=gap))
    for q, share in ((np.pi + 0.25 * gap, 0.0), (np.pi + 0.75 * gap, 0.25), (np.pi + 2 * gap, 1.5)):
        found = flexarm.static(loose, {"hinge": q})
        lean = np.arctan2(-found.position[0, 0], -found.position[0, 2])  # of the tip, from the vertical
        assert lean == pytest.approx(share * gap, abs=0.04 * gap)


def test_transmission_error_ripples_with_the_motor():
    """The tip moves by A sin(m n q + beta) times the length: amplitude and phase by least squares."""
    ripple = TransmissionError(at="hinge", amplitude=1e-4, multiple=2, phase=0.9)
    angles = LEVEL + np.linspace(0, 3 * 2 * np.pi / 240, 24, endpoint=False)
    gap = tangential(geared(ripple), angles)
    cos, sin = np.linalg.lstsq(
        np.column_stack([np.cos(240 * angles), np.sin(240 * angles), np.ones(24)]), gap, rcond=None
    )[0][:2]
    assert np.hypot(cos, sin) == pytest.approx(1e-4 * LENGTH, rel=5e-3)
    assert np.arctan2(cos, sin) == pytest.approx(0.9, abs=1e-3)


def test_transmission_error_counts_turns_of_the_motor_through_gears_too():
    """A shaft joint and [[gears]] of 120 instead of gear_ratio = 120: the same tip."""
    ripple = TransmissionError(at="hinge", amplitude=1e-4, multiple=2, phase=0.9)
    direct = geared(ripple, spring=None)
    shaft = hinge("shaft", "rotor", axis=[1, 0, 0])
    plain = geared(ripple, ratio=1.0, spring=None)
    coupled = plain.replace(
        joints=(*plain.joints, type(plain.joints[0])(**shaft)),
        links=(*plain.links, *arm(joints=[fixed("f", "rotor")], links=[rigid("rotor", 1.0)]).links),
        gears=({"name": "reducer", "input": "shaft", "output": "hinge", "ratio": 120},),
    )
    for q in (0.3, 0.311, 1.2):
        one, other = (flexarm.static(model, {"hinge": q}) for model in (direct, coupled))
        assert other.position[0] == pytest.approx(one.position[0], abs=1e-9)


def test_gear_ratio_grows_with_the_angle():
    """psi = q/s: tangential (1/s - 1) q L, with 3 % more or less where the weight moves with the tip."""
    angles = np.array([-1.2, -0.5, 0.5, 1.2, LEVEL])
    gap = tangential(geared(GearRatio(at="hinge", scale=1.001)), angles)
    assert gap == pytest.approx((1 / 1.001 - 1) * angles * LENGTH, rel=0.03)
    assert gap[-1] == pytest.approx((1 / 1.001 - 1) * LEVEL * LENGTH, rel=2e-3)


def test_cables_pull_by_the_angle_from_their_rest():
    stiffness = 40.0
    for rest in (-0.5, 0.2):
        cables = CableTorque(at="hinge", stiffness=stiffness, rest_angle=rest)
        gap = tangential(geared(cables), np.array([LEVEL]))
        assert gap == pytest.approx(-stiffness * (LEVEL - rest) / K * LENGTH, rel=0.02)  # d itself is 0.02
        free, d = deflection(geared(cables), LEVEL)
        theta = LEVEL - d
        assert free + stiffness * (theta - rest) == pytest.approx(K * d, rel=1e-9)


def test_hysteresis_has_no_part_at_rest():
    """z = 0 at the equilibrium from which a motion starts."""
    with_it = geared(JointHysteresis(at="hinge", torque=80.0, width=3e-4))
    assert tangential(with_it, np.array([0.7])) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("effect", [JointStiffening, JointHysteresis, Backlash], ids=lambda e: e.name)
def test_what_acts_in_the_reducers_deflection_needs_a_compliance(effect):
    with pytest.raises(InvalidParameter, match=rf"{effect.name} needs a joint_compliance with a stiffness"):
        geared(effect(at="hinge"), spring=None)
    with pytest.raises(InvalidParameter, match="stiffness at the same joint, and 'hinge' is rigid"):
        geared(effect(at="hinge"), JointCompliance(at="hinge", damping=3.0), spring=None)
    geared(effect(at="hinge"))


def test_a_transmission_error_that_turns_the_output_back_is_refused():
    with pytest.raises(InvalidParameter, match=r"0.005 rad x 2 x 120 = 1.2: the output would turn back"):
        geared(TransmissionError(at="hinge", amplitude=5e-3, multiple=2))


def test_joint_effects_are_refused_at_joints_that_do_not_move():
    model = paper_arm(2)
    stiff = model.replace(joints=(fixed("hinge", "rod"),))
    with pytest.raises(InvalidParameter, match=r"no (moving )?joint"):
        stiff.with_effect(GearRatio(at="hinge", scale=1.1))
    with pytest.raises(InvalidParameter, match="'elbow'"):
        model.with_effect(GearRatio(at="elbow", scale=1.1))


def test_a_slide_reads_metres_for_radians():
    """A mass on a vertical slide: sags by m g/k and half a gap of 1 mm."""
    slide = arm(
        joints=[hinge("slide", "load", type="prismatic", axis=[0, 0, 1])],
        links=[rigid("load", 20.0)],
        points=[{"name": "load", "link": "load", "position": [0, 0, 0]}],
        effects=[compliance("slide", 5e4), {"name": "backlash", "at": "slide", "gap": 1e-3}],
    )
    z = flexarm.static(slide, {"slide": 0.2}).position[0, 2]
    assert 0.2 - z == pytest.approx(20 * 9.81 / 5e4 + 0.5e-3 * (1 - LOOSE), rel=1e-6)
