"""Derivatives of predicted signals against differences of whole predictions: arm, sensors, clocks, frames."""

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.helpers.arms import TUBE, beam, hinge, point, smooth_step

import flexarm
from flexarm.arm.parameter import with_value
from flexarm.measurement import predict, predict_slopes

KEYS = (
    "links.rod.material.youngs_modulus",
    "payloads.load.mass",
    "points.tip.position.x",
    "effects.joint_compliance.hinge.stiffness",
    "effects.encoder_scale.hinge.scale",
    "effects.encoder_offset.hinge.offset",
    "effects.encoder_eccentricity.hinge.amplitude",
    "effects.encoder_harmonics.hinge.amplitude",
    "effects.time_delay.controller.delay",
    "effects.time_delay.tip.delay",
    "effects.clock_drift.tracker.rate",
    "effects.frame_registration.tracker.translation.x",
    "effects.frame_registration.tracker.rotation.y",
    "effects.frame_drift.tracker.velocity.z",
    "effects.frame_scale.tracker.scale",
    "effects.sensor_offset.tilt.offset",
)


def seen_arm() -> flexarm.Arm:
    """An arm with a sensor of most kinds, and imperfect ones."""
    return flexarm.Arm.from_dict(
        {
            "joints": [{**hinge("hinge", "rod"), "gear_ratio": 120}],
            "links": [beam("rod", [0, 0, 3.0], TUBE, damping_ratio=0.01)],
            "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 3.0], "mass": 14.1}],
            "points": [point("tip", "rod", [0.05, 0, 3.0]), point("mid", "rod", [0, 0, 1.4])],
            "sensors": [
                {
                    "name": "hinge",
                    "quantity": "joint_angle",
                    "joint": "hinge",
                    "side": "motor",
                    "rate_hz": 100,
                },
                {
                    "name": "tip",
                    "quantity": "position",
                    "point": "tip",
                    "axes": ["x", "z"],
                    "frame": "tracker",
                    "clock": "tracker",
                    "rate_hz": 20,
                },
                {
                    "name": "torque",
                    "quantity": "motor_torque",
                    "joint": "hinge",
                    "side": "output",
                    "rate_hz": 50,
                },
                {"name": "tilt", "quantity": "inclination", "point": "mid", "axes": ["x"], "rate_hz": 20},
                {"name": "imu", "quantity": "angular_rate", "point": "tip", "axes": ["y"], "rate_hz": 50},
                {
                    "name": "gauge",
                    "quantity": "strain",
                    "link": "rod",
                    "position": 0.5,
                    "fibre": [0.0, 0.03],
                    "rate_hz": 20,
                },
            ],
            "effects": [
                {"name": "joint_compliance", "at": "hinge", "stiffness": 8e4, "damping": 160.0},
                {"name": "encoder_scale", "at": "hinge", "scale": 1.002},
                {"name": "encoder_offset", "at": "hinge", "offset": 1e-3},
                {"name": "encoder_eccentricity", "at": "hinge", "amplitude": 5e-4, "phase": 0.4},
                {"name": "encoder_harmonics", "at": "hinge", "order": 3, "amplitude": 2e-4, "phase": 1.0},
                {"name": "time_delay", "at": "controller", "delay": 2e-3},
                {"name": "time_delay", "at": "tip", "delay": 4e-3},
                {"name": "clock_drift", "at": "tracker", "rate": 1e-4},
                {
                    "name": "frame_registration",
                    "at": "tracker",
                    "translation": [1e-3, 2e-3, 3e-3],
                    "rotation": [1e-3, 2e-3, 0.0],
                },
                {"name": "frame_drift", "at": "tracker", "velocity": [1e-4, 0.0, 2e-4]},
                {"name": "frame_scale", "at": "tracker", "scale": 1.001},
                {"name": "sensor_offset", "at": "tilt", "offset": 1e-3},
            ],
        }
    )


@pytest.fixture(scope="module")
def record() -> flexarm.Record:
    """A virtual, noiseless measurement of a smooth swing."""
    arm = seen_arm()
    t = np.linspace(0, 1.5, 76)
    drive = flexarm.Drive.from_samples(t, {"hinge": 0.6 * smooth_step(t / 1.5)})
    run = flexarm.simulate(arm, drive, rotations=True, forces=True)
    clocks = {"controller": flexarm.record.Clock(), "tracker": flexarm.record.Clock()}
    return flexarm.measure(run, arm.sensors, np.random.default_rng(1), drive=["hinge"], clocks=clocks)


def test_signals_have_the_derivatives_of_differences(record: flexarm.Record) -> None:
    """All signals, by parameters of the arm, of its encoder, of clocks and frames, to 1e-5 of the largest."""
    arm = seen_arm()
    run = flexarm.simulate(arm, record, step=4e-3, rotations=True, forces=True, sensitivities=KEYS)
    assert run.sensitivities is not None
    for k, parameter in enumerate(run.sensitivities.parameters):
        step = 1e-3 * (abs(parameter.value) or 1e-2)
        runs = {}
        for amount in (step, -step, step / 2, -step / 2):
            there = with_value(arm, parameter.key, parameter.value + amount)
            runs[amount] = there, flexarm.simulate(there, record, step=4e-3, rotations=True, forces=True)
        for signal in record.signals.values():

            def at(amount: float, signal: object = signal) -> NDArray:
                other, seen = runs[amount]  # noqa: B023
                return predict(seen, signal, arm=other, rounded=False)

            coarse = (at(step) - at(-step)) / (2 * step)
            fine = (at(step / 2) - at(-step / 2)) / step
            # Where the drive ends its rate jumps, and with it the derivative by the time of the jump.
            inside = np.isfinite(fine).all(axis=1) & (signal.time < 1.45)
            expected, doubt = ((4 * fine - coarse) / 3)[inside], np.abs(fine - coarse)[inside].max()
            error = np.abs(predict_slopes(run, signal)[inside, :, k] - expected).max()
            largest = np.abs(expected).max()
            # Ordinary runs here: Newton leaves 1e-10 of the reach, 2e-5 N m here; differences magnify it.
            noise = 2e-7 * np.abs(predict(run, signal)[inside]).max() / step
            assert error <= 2e-5 * largest + doubt + noise, (parameter.key, signal.name)


def test_a_run_without_derivatives_says_so(record: flexarm.Record) -> None:
    run = flexarm.simulate(seen_arm(), record, step=4e-3)
    with pytest.raises(flexarm.InvalidParameter, match="sensitivities="):
        predict_slopes(run, record.signals["tip"])
