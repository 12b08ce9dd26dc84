"""The deflection that a controller reads is the one that a record would hold."""

import numpy as np
import pytest
from tests.helpers.arms import beam, hinge, point

import flexarm
from flexarm import Record, Signal
from flexarm.arm.sensor import Sensor
from flexarm.comparison.poses import pose_numbers, solve_poses
from flexarm.control.deflection_sensor import DeflectionSensor
from flexarm.measurement import predict

TUBE = {"shape": "tube", "outer_diameter": 0.03, "thickness": 2e-3}


def crane() -> flexarm.Arm:
    """A slewing post on a tilted base, a slide along it, and a jib that bends in two planes."""
    slide = {
        "name": "slide",
        "type": "prismatic",
        "parent": "post",
        "child": "carriage",
        "axis": [0, 0.6, 0.8],
        "origin": {"xyz": [0.1, 0.2, 0.3], "rpy": [0.4, -0.3, 0.2]},
    }
    return flexarm.Arm.from_dict(
        {
            "joints": [
                {**hinge("slew", "post"), "axis": [0, 0.1, 1.0], "origin": {"xyz": [0.3, 0, 0.1]}},
                slide,
                {
                    **hinge("luff", "jib"),
                    "parent": "carriage",
                    "origin": {"xyz": [0, 0.1, 0.5], "rpy": [0, 0, 1]},
                },
            ],
            "links": [
                {"name": "post", "type": "rigid", "mass": 5.0},
                {"name": "carriage", "type": "rigid", "mass": 2.0},
                beam("jib", [1.0, 0, 1.5], TUBE),
            ],
            "payloads": [{"name": "load", "link": "jib", "position": [1.0, 0, 1.5], "mass": 4.0}],
            "points": [point("tip", "jib", [1.0, 0.1, 1.5])],
            "effects": [
                {"name": "base_tilt", "at": "base", "angle": [0.02, -0.05]},
                {"name": "link_length", "at": "jib", "error": 0.01},
            ],
        }
    )


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_gauge_and_record_agree_in_any_pose(axis):
    """Both are exact but for rounding: products of rotations on one side, of exponentials on the other."""
    rng = np.random.default_rng(7)
    arm, rows = crane(), np.array(list("abcd"))
    angles = {name: rng.uniform(-1, 1, (4, 1)) for name in ("slew", "slide", "luff")}
    drives = [
        Signal(name=name, quantity="joint_angle", joint=name, values=values, pose=rows, unit=unit)
        for (name, values), unit in zip(angles.items(), ("rad", "m", "rad"), strict=True)
    ]
    bent = Signal(
        name="bent", quantity="deflection", point="tip", axes=(axis,), values=np.zeros((4, 1)), pose=rows
    )
    record = Record(kind="static", drive=tuple(angles), signals=[*drives, bent])
    run = solve_poses(arm, record)
    expected = predict(run, bent, stamps=pose_numbers(record)["bent"])[:, 0]
    sensor = DeflectionSensor(
        arm, Sensor(name="bent", quantity="deflection", point="tip", axes=(axis,), rate_hz=10)
    )
    found = [sensor.read(run.position[i, sensor.point], run.joint_angle[i]) for i in range(4)]
    assert found == pytest.approx(expected, abs=1e-13)
    assert np.ptp(expected) > 1e-4


def test_a_gauge_has_the_derivatives_of_differences():
    """By the point's position and by every joint, the slide among them."""
    sensor = DeflectionSensor(
        crane(), Sensor(name="bent", quantity="deflection", point="tip", axes=("x",), rate_hz=10)
    )
    position, angles = np.array([1.2, 0.3, 2.1]), np.array([0.4, -0.2, 0.7])
    by_position, by_angle = sensor.slopes(position, angles)
    h = 1e-4
    for k, e in enumerate(h * np.eye(3)):
        along = (sensor.read(position + e, angles) - sensor.read(position - e, angles)) / (2 * h)
        turning = (sensor.read(position, angles + e) - sensor.read(position, angles - e)) / (2 * h)
        assert by_position[k] == pytest.approx(along, abs=1e-10)
        assert by_angle[k] == pytest.approx(turning, abs=1e-7)
    assert sensor == DeflectionSensor(
        crane(), Sensor(name="again", quantity="deflection", point="tip", axes=("x",), rate_hz=20)
    )
    assert sensor != DeflectionSensor(
        crane(), Sensor(name="bent", quantity="deflection", point="tip", axes=("y",), rate_hz=10)
    )
