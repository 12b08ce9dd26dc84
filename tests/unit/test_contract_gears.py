"""A gear couples two joints: angle of its input = ratio x angle of its output, whichever of them is told."""

import numpy as np
import pytest
from arms import TUBE, beam, hinge, point, rigid
from pytest import approx

import flexarm
from flexarm.errors import InvalidParameter

RATIO = 120.0
ROD = beam("rod", [0, 0, 3.0], TUBE, theory="timoshenko")


@pytest.fixture(scope="module")
def arm() -> flexarm.Arm:
    """A motor's shaft beside the hinge of a 3 m tube."""
    return flexarm.Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "joints": [hinge("shaft", "rotor"), hinge("hinge", "rod")],
            "gears": [{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": RATIO}],
            "links": [rigid("rotor", 1.0, inertia=[1e-3, 1e-3, 1e-3]), ROD],
            "payloads": [{"name": "load", "link": "rod", "position": [0.0, 0.0, 3.0], "mass": 14.1}],
            "points": [point("tip", "rod", [0, 0, 3.0])],
        }
    )


def test_output_told_stands_where_the_input_would_put_it(arm):
    by_output = flexarm.static(arm, joints={"hinge": 0.5})
    by_input = flexarm.static(arm, joints={"shaft": 0.5 * RATIO})
    assert by_output.link_angle == approx([0.5 * RATIO, 0.5])
    assert by_output.position == approx(by_input.position, abs=1e-9)
    assert np.abs(by_output.displacement).max() < 0.02  # 15 mm of sag, no turn


def test_angles_that_contradict_their_gear_are_refused(arm):
    with pytest.raises(InvalidParameter, match="contradicts gear 'reducer'"):
        flexarm.static(arm, joints={"hinge": 0.5, "shaft": 3.0})


@pytest.mark.parametrize("side", ["motor", "output"])
def test_a_run_follows_a_drive_on_the_output_as_one_on_the_input(arm, side):
    """Both sides of a rigid hinge are one angle."""
    time = np.linspace(0, 1, 51)
    angle = 0.2 * np.sin(time) ** 2
    on_input = flexarm.simulate(arm, flexarm.Drive.from_samples(time, {"shaft": RATIO * angle}))
    on_output = flexarm.simulate(arm, flexarm.Drive.from_samples(time, {"hinge": angle}, side))
    assert on_output.joint_angle[-1] == approx([RATIO * angle[-1], angle[-1]])
    assert on_output.position == approx(on_input.position, abs=1e-9)


def test_a_compliance_behind_a_gear_softens_the_arm():
    """The gear turns the output's motor side; the spring behind it lowers f1 as it does without a gear."""
    one = {
        "links": [ROD],
        "joints": [hinge("hinge", "rod")],
        "effects": [{"name": "joint_compliance", "at": "hinge", "stiffness": 1e5}],
    }
    geared = {
        **one,
        "links": [ROD, rigid("wheel", 0.1, inertia=[1e-4, 1e-4, 1e-4])],
        "joints": [*one["joints"], hinge("shaft", "wheel")],
        "gears": [{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": 120}],
    }
    direct = flexarm.modes(flexarm.Arm.from_dict(one), count=2).frequency_hz
    behind = flexarm.modes(flexarm.Arm.from_dict(geared), count=2).frequency_hz
    stiff = flexarm.modes(flexarm.Arm.from_dict(one).without_effect("joint_compliance", "hinge"), count=1)
    assert behind == pytest.approx(direct, rel=1e-9)
    assert behind[0] < 0.95 * stiff.frequency_hz[0]
