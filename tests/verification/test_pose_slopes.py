"""Derivatives of static records against differences of whole records: arm, sensors of inputs and outputs."""

import numpy as np
import pytest
from tests.helpers.arms import TUBE, beam, hinge, point

import flexarm
from flexarm import Record, Signal
from flexarm.arm.parameter import with_value
from flexarm.comparison.poses import pose_numbers, solve_poses
from flexarm.measurement import predict, predict_slopes
from flexarm.record import Frame

KEYS = (
    "links.rod.material.youngs_modulus",
    "payloads.load.mass",
    "points.tip.position.x",
    "effects.joint_compliance.hinge.stiffness",
    "effects.base_tilt.base.angle.y",
    "effects.encoder_scale.q.scale",
    "effects.encoder_offset.q.offset",
    "effects.sensor_offset.push.offset",
    "effects.sensor_offset.tilt.offset",
    "effects.frame_registration.tracker.rotation.y",
)


def arm() -> flexarm.Arm:
    """A rod on a soft hinge that stands on a tilted base, with imperfect sensors."""
    return flexarm.Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [beam("rod", [0, 0, 3.0], TUBE)],
            "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 3.0], "mass": 14.1}],
            "points": [point("tip", "rod", [0.05, 0, 3.0])],
            "effects": [
                {"name": "joint_compliance", "at": "hinge", "stiffness": 5e4},
                {"name": "base_tilt", "at": "base", "angle": [0.002, -0.003]},
                {"name": "encoder_scale", "at": "q", "scale": 1.01},
                {"name": "encoder_offset", "at": "q", "offset": 2e-3},
                {"name": "sensor_offset", "at": "push", "offset": 0.5},
                {"name": "sensor_offset", "at": "tilt", "offset": 1e-3},
                {"name": "frame_registration", "at": "tracker", "rotation": [0, 1e-3, 0]},
            ],
        }
    )


def record() -> Record:
    """Three poses with a push at the tip; what was measured does not matter here."""
    rows = np.array(["a", "b", "c"])
    three = np.zeros((3, 3))
    signals = [
        Signal(
            name="q",
            quantity="joint_angle",
            joint="hinge",
            values=np.array([[-0.4], [0.3], [0.9]]),
            pose=rows,
        ),
        Signal(
            name="push",
            quantity="force",
            point="tip",
            axes=("y", "z"),
            values=np.array([[5.0, -20.0], [0.0, 30.0], [10.0, 0.0]]),
            pose=rows,
        ),
        Signal(
            name="tip",
            quantity="position",
            point="tip",
            values=three,
            pose=rows,
            frame="tracker",
            noise_std=1e-4,
        ),
        Signal(name="turn", quantity="orientation", point="tip", values=np.zeros((3, 4)), pose=rows),
        Signal(name="feel", quantity="acceleration", point="tip", values=three, pose=rows),
        Signal(name="tilt", quantity="inclination", point="tip", axes=("z",), values=three[:, :1], pose=rows),
        Signal(name="torque", quantity="motor_torque", joint="hinge", values=three[:, :1], pose=rows),
        Signal(name="d", quantity="deflection", point="tip", axes=("x", "y"), values=three[:, :2], pose=rows),
    ]
    return Record(kind="static", drive=("q",), signals=signals, frames={"tracker": Frame()})


@pytest.fixture(scope="module")
def differentiated():
    return solve_poses(arm(), record(), sensitivities=KEYS)


@pytest.mark.parametrize("key", KEYS)
def test_slopes_of_poses_are_those_of_whole_records(differentiated, key):
    """Central differences with a step of 1e-4 of the parameter: their own error is near 1e-8 of the slope."""
    k = differentiated.sensitivities.keys.index(key)
    value = differentiated.sensitivities.parameters[k].value
    step = 1e-4 * abs(value)
    runs = [solve_poses(with_value(arm(), key, value + sign * step), record()) for sign in (1, -1)]
    stamps = pose_numbers(record())
    moved = 0.0
    for name, signal in record().signals.items():
        if name in ("q", "push"):
            continue
        up, down = (predict(run, signal, stamps=stamps[name]) for run in runs)
        expected = (up - down) / (2 * step)
        found = predict_slopes(differentiated, signal, stamps=stamps[name])[..., k]
        assert found == pytest.approx(expected, rel=1e-5, abs=1e-7 * np.abs(expected).max() + 1e-10 / step), (
            name
        )
        moved = max(moved, float(np.abs(expected).max()))
    assert moved > 0


def test_poses_with_derivatives_stand_where_they_stand_without(differentiated):
    plain = solve_poses(arm(), record())
    for name in ("position", "orientation", "joint_angle", "drive_angle", "motor_torque"):
        assert np.array_equal(getattr(plain, name), getattr(differentiated, name))


def test_the_drive_turns_by_what_its_encoder_is_wrong(differentiated):
    """reading = scale true + offset: true falls by 1/scale an offset, by true/scale a scale."""
    slopes = differentiated.sensitivities.by("effects.encoder_offset.q.offset")
    assert slopes["drive_angle"] == pytest.approx(np.full((3, 1), -1 / 1.01))
    slopes = differentiated.sensitivities.by("effects.encoder_scale.q.scale")
    assert slopes["drive_angle"][:, 0] == pytest.approx(-differentiated.drive_angle[:, 0] / 1.01)
