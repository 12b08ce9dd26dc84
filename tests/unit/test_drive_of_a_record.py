"""The drive of a record about its last sample."""

import numpy as np
import pytest
from arms import crane, drive, waist_and_elbow

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.effects import JointCompliance
from flexarm.record import Clock, Record, Signal
from flexarm.validation.sensor_check import check


def test_an_accelerometer_at_the_last_sample_reads_the_motion_and_no_stop():
    """A joint that still turns as its record ends: the last readings are no worse than those before."""
    arm = crane(effects=[]).with_effect(JointCompliance(at="hinge", stiffness=1.4e5, damping=180.0))
    swing = drive({"hinge": lambda t: 0.4 * np.sin(2 * np.pi * 0.3 * t) ** 3}, 4.0)
    run = flexarm.simulate(arm, swing, rotations=True, forces=True)
    sensors = [
        Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=250, noise_std=1e-9),
        Sensor(
            name="imu", quantity="acceleration", point="tip", axes=("x", "z"), rate_hz=100, noise_std=1e-9
        ),
    ]
    record = flexarm.measure(run, sensors, np.random.default_rng(1), drive=["hinge"])
    assert np.abs(run.drive_rate[-1]) > 0.1
    again = flexarm.simulate(arm, record, rotations=True, forces=True)
    seen = flexarm.measure(again, sensors[1:], np.random.default_rng(1)).signals["imu"]
    n = len(record.signals["imu"])
    off = np.abs(seen.values[:n] - record.signals["imu"].values)
    assert off[-1] == pytest.approx(off[:-1].max(), abs=0.05)


def on_two_clocks(t):
    waist, elbow = (
        Signal(name=joint, quantity="joint_angle", joint=joint, time=t, values=0.1 * t**2, clock=clock)
        for joint, clock in (("waist", "a"), ("elbow", "b"))
    )
    return waist, elbow


def test_a_second_drive_on_an_uncertain_clock_is_taken_as_stated_with_a_note():
    t = np.linspace(0, 2, 101)
    tip = Signal(
        name="tip", quantity="position", point="tip", time=t[::10], values=np.ones((11, 3)), clock="a"
    )
    record = Record(
        signals=[*on_two_clocks(t), tip],
        drive=["waist", "elbow"],
        clocks={"a": Clock(), "b": Clock(offset=0.0, sigma=0.02)},
    )
    notes = flexarm.compare(waist_and_elbow({"noise_std": 2e-5}), record).notes
    assert "the clock of the drive elbow is uncertain by 20.0 ms; its offset is taken as stated" in notes


def test_a_second_drive_on_an_unknown_clock_is_refused():
    """Nothing says when its joint moves."""
    waist, elbow = on_two_clocks(np.linspace(0, 2, 101))
    record = Record(
        signals=[waist, elbow], drive=["waist", "elbow"], clocks={"a": Clock(), "b": Clock(unknown=True)}
    )
    with pytest.raises(flexarm.InvalidParameter, match=r"clocks\.b: has an unknown offset to"):
        flexarm.Drive.from_record(record, waist_and_elbow({"noise_std": 2e-5}))


def test_rows_after_the_end_of_a_drive_that_moves_are_not_compared():
    """The model would stand still there, 30 mrad from the arm."""
    arm = crane(effects=[]).with_effect(JointCompliance(at="hinge", stiffness=1.4e5, damping=180.0))
    swing = drive({"hinge": lambda t: 0.4 * np.sin(2 * np.pi * 0.3 * t) ** 3}, 4.0)
    sensors = [
        Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=250, noise_std=1e-6),
        Sensor(name="torque", quantity="motor_torque", joint="hinge", rate_hz=50, noise_std=0.05),
    ]
    record = flexarm.measure(flexarm.simulate(arm, swing), sensors, np.random.default_rng(1), drive=["hinge"])
    hinge = record.signals["hinge"]
    first = hinge.time < 3.8
    cut = hinge.replace(time=hinge.time[first], values=hinge.values[first])
    found = flexarm.compare(arm, record.replace(signals={**record.signals, "hinge": cut}))
    assert "10 of 201 rows of torque lie after the drives, and are not compared" in found.notes
    assert found.signals["torque"].rms["total"] < 1.2 * found.signals["torque"].noise_rms


def test_a_drive_of_unstated_noise_is_smoothed_by_what_its_samples_show():
    t = np.arange(0, 8, 0.01)
    true = 0.5 * np.sin(2 * np.pi * 0.25 * t) ** 3
    read = true + 2e-5 * np.random.default_rng(4).standard_normal(len(t))

    def fastest(values, noise_std):
        signal = Signal(
            name="hinge", quantity="joint_angle", joint="hinge", time=t, values=values, noise_std=noise_std
        )
        drive = flexarm.Drive.from_record(Record(signals=[signal], drive=["hinge"]), crane(effects=[]))
        polynomial = drive.joints["hinge"].polynomial()
        return max(abs(polynomial(float(each))[2]) for each in t)

    assert fastest(true, None) == pytest.approx(fastest(true, 0.0), rel=1e-3)
    assert fastest(read, 0.0) > 1.5 * fastest(true, 0.0)
    assert fastest(read, None) == pytest.approx(fastest(read, 2e-5), rel=0.05)
    assert fastest(read, None) < 1.1 * fastest(true, 0.0)


def test_the_noise_that_a_drive_shows_is_told_and_counts_in_check_and_compare():
    t = np.arange(0, 8, 0.01)
    read = 0.5 * np.sin(2 * np.pi * 0.25 * t) ** 3 + 2e-5 * np.random.default_rng(4).standard_normal(len(t))
    arm = crane(effects=[])
    hinge = Signal(name="hinge", quantity="joint_angle", joint="hinge", time=t, values=read)
    tip = Signal(
        name="tip", quantity="position", point="tip", time=t[::10], values=np.ones((80, 3)), noise_std=1.0
    )
    record = Record(signals=[hinge, tip], drive=["hinge"])
    found = check(arm, {"run": record})
    assert found.records["run"].signals["hinge"].noise_std == pytest.approx(2e-5, rel=0.1)
    for said in (flexarm.compare(arm, record).notes, found.remarks):
        assert any("no noise is stated for the drive hinge: the 2" in each for each in said)
        assert not any("joined as they are" in each for each in said)
