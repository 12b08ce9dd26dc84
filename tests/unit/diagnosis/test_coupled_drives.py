"""Faulty drives of joints that move others through gears or in loops, and behind reducers that turn back."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from arms import TUBE, beam, hinge, point, rigid
from loop_examples import EXAMPLES_IN_MOTION

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.record import Record
from flexarm.validation.sensor_check import check

RATIO = 120.0


def swing(t: np.ndarray) -> np.ndarray:
    """An angle that starts from rest [rad]."""
    return 0.4 * np.clip(t / 2, 0, 1) ** 2 * np.sin(2 * np.pi * 0.3 * t)


def with_values(record: Record, name: str, values: np.ndarray) -> Record:
    """The record with other values of one signal."""
    signals = {**record.signals, name: record.signals[name].replace(values=values)}
    return record.replace(signals=signals)


@dataclass(frozen=True)
class Bench:
    """An arm and a record of it."""

    arm: flexarm.Arm
    record: Record

    def named(self, signal: str, values: np.ndarray) -> dict[str, str]:
        """Names of faults by signal, if a signal has other values."""
        found = check(self.arm, {"run": with_values(self.record, signal, values)}, step=8e-3)
        return {fault.at: fault.name for fault in found.faults}


@cache
def geared() -> Bench:
    """A rod that a shaft turns through a gear; encoders on both, and the place of the tip."""
    arm = flexarm.Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "joints": [hinge("shaft", "rotor"), hinge("hinge", "rod")],
            "gears": [{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": RATIO}],
            "links": [rigid("rotor", 1.0, inertia=[1e-3] * 3), beam("rod", [0, 0, 3.0], TUBE)],
            "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 3.0], "mass": 14.1}],
            "points": [point("tip", "rod", [0, 0, 3.0])],
        }
    )
    t = np.linspace(0, 8, 801)
    run = flexarm.simulate(arm, flexarm.Drive.from_samples(t, {"shaft": RATIO * swing(t)}), step=5e-3)
    sensors = [
        Sensor(name="shaft", quantity="joint_angle", rate_hz=100, noise_std=1e-4, joint="shaft"),
        Sensor(
            name="hinge_encoder",
            quantity="joint_angle",
            rate_hz=100,
            noise_std=1e-5,
            joint="hinge",
            side="output",
        ),
        Sensor(name="tip", quantity="position", rate_hz=20, noise_std=1e-4, point="tip", axes=("x", "z")),
    ]
    return Bench(arm, flexarm.measure(run, sensors, np.random.default_rng(1), drive=["shaft"]))


@cache
def excavator() -> Bench:
    """An excavator's arm on two cylinders."""
    example = EXAMPLES_IN_MOTION["excavator"]
    return Bench(example.arm, example.record(example.arm, 5, step=8e-3))


@pytest.mark.parametrize(("factor", "name"), [(-1.0, "sign_error"), (np.pi / 180, "unit_error")])
def test_a_drive_that_turns_a_joint_through_a_gear_is_named_and_not_that_joints_encoder(factor, name):
    """The hinge's encoder and the tip both contradict the shaft's."""
    shaft = geared().record.signals["shaft"].values
    assert geared().named("shaft", factor * shaft) == {"shaft": name}


def test_a_shaft_that_stops_while_the_geared_joint_moves_on_is_stuck():
    """From 3 s on."""
    shaft = geared().record.signals["shaft"].values.copy()
    shaft[300:] = shaft[300]
    assert geared().named("shaft", shaft) == {"shaft": "dead_channel"}


@pytest.mark.parametrize(("factor", "name"), [(-1.0, "sign_error"), (100.0, "unit_error")])
def test_a_cylinder_in_a_loop_that_counts_otherwise_is_named(factor, name):
    """Kinematics of the rigid tree know nothing of passive joints: it is found by simulation."""
    record = excavator().record
    for drive in record.drive:
        assert excavator().named(drive, factor * record.signals[drive].values) == {drive: name}


@pytest.mark.parametrize("factor", [1.0, 180 / np.pi])
def test_a_reducer_that_turns_back_is_no_fault_and_no_traceback(factor):
    """A negative gear ratio: its size is that of the wrong unit."""
    upright = flexarm.Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "joints": [hinge("hinge", "rod", gear_ratio=-110.0)],
            "links": [beam("rod", [0, 0, 3.0], TUBE)],
            "points": [point("tip", "rod", [0, 0, 3.0])],
        }
    )
    t = np.linspace(0, 8, 801)
    run = flexarm.simulate(upright, flexarm.Drive.from_samples(t, {"hinge": swing(t)}), step=5e-3)
    sensors = [
        Sensor(name="hinge", quantity="joint_angle", rate_hz=100, noise_std=1e-6, joint="hinge"),
        Sensor(name="tip", quantity="position", rate_hz=20, noise_std=1e-4, point="tip", axes=("x", "z")),
    ]
    bench = Bench(upright, flexarm.measure(run, sensors, np.random.default_rng(1), drive=["hinge"]))
    named = bench.named("hinge", factor * bench.record.signals["hinge"].values)
    assert named == ({} if factor == 1 else {"hinge": "unit_error"})


def test_a_drive_cut_off_at_both_ends_is_told_with_both_and_the_farther_as_its_limit():
    """Clipped at -0.1 and 0.25 rad."""
    shaft = geared().record.signals["shaft"].values
    clipped = np.clip(shaft, -0.1 * RATIO, 0.25 * RATIO)
    [fault] = check(geared().arm, {"run": with_values(geared().record, "shaft", clipped)}, step=8e-3).faults
    assert (fault.at, fault.name) == ("shaft", "saturation")
    assert abs(fault.parameters[0].value) == pytest.approx(0.25 * RATIO, rel=1e-3)
    assert "30 rad and -12 rad" in fault.evidence
