"""A gear couples two joints: angle of its input = ratio x angle of its output, whichever of them is told."""

import numpy as np
import pytest
from pytest import approx

import flexarm
from flexarm.errors import InvalidParameter

RATIO = 120.0
STEEL = {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 7850.0}
TUBE = {"shape": "tube", "outer_diameter": 0.06024, "thickness": 3.25e-3}


@pytest.fixture(scope="module")
def arm() -> flexarm.Arm:
    """A motor's shaft beside the hinge of a 3 m tube."""
    axis = [0.0, 1.0, 0.0]
    return flexarm.Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "joints": [
                {"name": "shaft", "type": "revolute", "parent": "base", "child": "rotor", "axis": axis},
                {"name": "hinge", "type": "revolute", "parent": "base", "child": "rod", "axis": axis},
            ],
            "gears": [{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": RATIO}],
            "links": [
                {"name": "rotor", "type": "rigid", "mass": 1.0, "inertia": [1e-3, 1e-3, 1e-3]},
                {"name": "rod", "type": "beam", "end": [0.0, 0.0, 3.0], "section": TUBE, "material": STEEL},
            ],
            "payloads": [{"name": "load", "link": "rod", "position": [0.0, 0.0, 3.0], "mass": 14.1}],
            "points": [{"name": "tip", "link": "rod", "position": [0.0, 0.0, 3.0]}],
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
        "links": [
            {
                "name": "rod",
                "type": "beam",
                "end": [0, 0, 3.0],
                "section": {"shape": "tube", "outer_diameter": 0.06024, "thickness": 3.25e-3},
                "material": {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 7850},
            }
        ],
        "joints": [
            {"name": "hinge", "type": "revolute", "parent": "base", "child": "rod", "axis": [0, 1, 0]}
        ],
        "effects": [{"name": "joint_compliance", "at": "hinge", "stiffness": 1e5}],
    }
    shaft = {"name": "shaft", "type": "revolute", "parent": "base", "child": "wheel", "axis": [0, 1, 0]}
    geared = {
        **one,
        "links": [
            *one["links"],
            {"name": "wheel", "type": "rigid", "mass": 0.1, "inertia": [1e-4, 1e-4, 1e-4]},
        ],
        "joints": [*one["joints"], shaft],
        "gears": [{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": 120}],
    }
    direct = flexarm.modes(flexarm.Arm.from_dict(one), count=2).frequency_hz
    behind = flexarm.modes(flexarm.Arm.from_dict(geared), count=2).frequency_hz
    stiff = flexarm.modes(flexarm.Arm.from_dict(one).without_effect("joint_compliance", "hinge"), count=1)
    assert behind == pytest.approx(direct, rel=1e-9)
    assert behind[0] < 0.95 * stiff.frequency_hz[0]
