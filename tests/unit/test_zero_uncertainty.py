"""A nominal value of zero has an absolute uncertainty only: its key ends in the unit."""

import numpy as np
import pytest
from arms import rod_arm, smooth_step

import flexarm
from flexarm.arm.effect import read_effect

SENSORS = [
    {
        "name": "hinge",
        "quantity": "joint_angle",
        "joint": "hinge",
        "side": "motor",
        "rate_hz": 100,
        "noise_std": 5e-6,
    },
    {
        "name": "se1",
        "quantity": "joint_angle",
        "joint": "hinge",
        "side": "output",
        "rate_hz": 50,
        "noise_std": 1e-5,
    },
    {"name": "tip", "quantity": "position", "point": "tip", "rate_hz": 20, "noise_std": 5e-5},
]
EFFECTS = [
    {"name": "sensor_offset", "at": "se1", "offset": 0.0},
    {"name": "sensor_offset", "at": "other", "offset": 0.0},
    {"name": "encoder_offset", "at": "hinge"},
    {"name": "time_delay", "at": "tracker"},
    {"name": "clock_drift", "at": "tracker"},
    {"name": "frame_drift", "at": "tracker"},
    {"name": "link_damping", "at": "rod", "damping_ratio": 0.0},
    {"name": "base_tilt", "at": "base"},
]


def arm(**uncertainty: float) -> flexarm.Arm:
    stated = {f"effects.{key}": sigma for key, sigma in uncertainty.items()}
    return rod_arm(SENSORS, effects=EFFECTS, uncertainty=stated)


@pytest.mark.parametrize(
    "key",
    [
        "sensor_offset.se1.offset_rad",
        "sensor_offset.other.offset_N",
        "encoder_offset.hinge.offset_rad",
        "time_delay.tracker.delay_s",
        "clock_drift.tracker.rate_s_s",
        "frame_drift.tracker.velocity_m_s",
        "link_damping.rod.damping_ratio_1",
        "base_tilt.base.angle_rad",
    ],
)
def test_the_unit_at_the_end_gives_an_absolute_sigma(key):
    assert arm(**{key: 5e-3}).sigma(f"effects.{key}")[1] == 5e-3


@pytest.mark.parametrize(
    ("key", "write"),
    [
        ("sensor_offset.se1.offset", "offset_m or offset_rad"),
        ("time_delay.tracker.delay", "delay_s"),
        ("frame_drift.tracker.velocity", "velocity_m_s"),
        ("link_damping.rod.damping_ratio", "damping_ratio_1"),
    ],
)
def test_a_relative_sigma_of_zero_is_an_error_that_says_what_to_write(key, write):
    with pytest.raises(flexarm.InvalidParameter) as error:
        arm(**{key: 5e-3})
    assert f"uncertainty.effects.{key}" in str(error.value)
    assert "is 0, and 1 sigma relative to it is nothing; add the unit" in str(error.value)
    assert f"write {write}" in str(error.value)


def test_the_unit_must_be_that_of_the_sensor():
    with pytest.raises(flexarm.InvalidParameter, match="there is no value 'offset_N'"):
        arm(**{"sensor_offset.se1.offset_N": 5e-3})


def test_an_uncertain_zero_of_a_second_encoder_is_refined():
    nominal = arm(**{"sensor_offset.se1.offset_rad": 5e-3})
    truth = nominal.with_effect(read_effect({"name": "sensor_offset", "at": "se1", "offset": 4e-3}))
    t = np.linspace(0, 4, 201)
    drive = flexarm.Drive.from_samples(t, {"hinge": 0.5 * smooth_step(t / 4)})
    run = flexarm.simulate(truth, drive)
    record = flexarm.measure(run, nominal.sensors, np.random.default_rng(1), drive=["hinge"])
    found = flexarm.diagnose(nominal, record)
    assert found.verdict == "adequate"
    [offset] = [each for each in found.refined if "sensor_offset.se1" in each.parameter]
    assert offset.value == pytest.approx(4e-3, abs=max(4 * offset.std, 1e-6))
