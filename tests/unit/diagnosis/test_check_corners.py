"""Checks of records where a reading is zero, hardly moves, or is on a clock that is late."""

from functools import cache

import loops
import numpy as np
import pytest
from arms import crane, drive, smooth_step, waist_and_elbow

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.comparison.aligned_record import simulate_record
from flexarm.comparison.alignment_parameters import stated_placement
from flexarm.measurement.frames import Registration
from flexarm.record import Clock, Frame, Record, Signal
from flexarm.validation.record_remarks import remarks_on_poses
from flexarm.validation.sensor_check import check


def swing(t):
    """An angle that starts from rest [rad]."""
    return 0.5 * np.sin(2 * np.pi * t / 8) * smooth_step(t / 2.0) + 0.2 * smooth_step(t / 4)


@cache
def swung() -> flexarm.Simulation:
    return flexarm.simulate(crane(), drive({"hinge": swing}, 12.0), step=5e-3)


@pytest.mark.parametrize("yaw", [0.0, np.pi / 2])
def test_a_flipped_encoder_is_named_however_the_tracker_stands(yaw):
    """Turned by 90 degrees the tracker sees nothing along its x, whose regressors are rounding."""
    sensors = [
        Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=100, noise_std=1e-6),
        Sensor(name="tip", quantity="position", point="tip", rate_hz=10, noise_std=1e-4, frame="tracker"),
    ]
    record = flexarm.measure(
        swung(),
        sensors,
        np.random.default_rng(0),
        drive=["hinge"],
        frames={"tracker": Frame(rpy=(0, 0, yaw), translation=0.02)},
        registrations={"tracker": Registration(rpy=(0, 0, yaw), translation=(0.0, 0.03, 0.0))},
    )
    assert check(crane(), {"run": record}, step=5e-3).faults == ()
    hinge = record.signals["hinge"]
    flipped = record.replace(signals={**record.signals, "hinge": hinge.replace(values=-hinge.values)})
    [fault] = check(crane(), {"run": flipped}, step=5e-3).faults
    assert fault.name == "sign_error"  # of the places, or of the encoder: mirrors
    assert fault.at in ("tip", "hinge")


@pytest.mark.parametrize("late", [8.0, 100.0])
def test_a_drive_on_a_late_clock_moves_the_arm_to_its_end(late):
    """The run is in the time of the drive's stamps."""
    t = np.linspace(0, 12, 601)
    instants = np.arange(0.1, 11.9, 0.1)
    hinge = Signal(
        name="hinge", quantity="joint_angle", joint="hinge", time=t + late, values=swing(t), clock="c"
    )
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        time=instants,
        values=swung().at(instants, "tip"),
        noise_std=1e-4,
        clock="t",
    )
    clocks = {"t": Clock(), "c": Clock(offset=late)}
    record = Record(signals=[hinge, tip], drive=["hinge"], clocks=clocks)
    run = flexarm.simulate(crane(), record, step=5e-3)
    assert run.time[[0, -1]] == pytest.approx([late, late + 12.0], abs=0.1)
    assert check(crane(), {"run": record}, step=5e-3).faults == ()


def test_the_encoder_of_a_pin_that_follows_its_loop_is_no_idle_motor():
    """The piston drives it, whichever side the encoder is said to be on."""
    arm = loops.crane()
    run = flexarm.simulate(arm, drive({"piston": lambda t: 0.25 * smooth_step(t / 3)}, 4.0), step=1e-2)
    sensors = [
        Sensor(name="piston", quantity="joint_angle", joint="piston", rate_hz=100, noise_std=1e-6),
        Sensor(
            name="pin", quantity="joint_angle", joint="boom_pin", side="motor", rate_hz=20, noise_std=1e-5
        ),
    ]
    record = flexarm.measure(run, sensors, np.random.default_rng(0), drive=["piston"])
    assert "holds 'boom_pin' still" not in check(arm, {"run": record}, step=1e-2).summary()


def poses(**signals: Signal) -> tuple[flexarm.Arm, Record]:
    """Poses of two joints, with more signals as the model predicts them."""
    arm = waist_and_elbow({"noise_std": 1e-4}).replace(sensors=())
    rng, names = np.random.default_rng(0), np.array([f"p{i}" for i in range(12)])
    told = [
        Signal(name=joint, quantity="joint_angle", joint=joint, pose=names, values=rng.uniform(-0.8, 0.8, 12))
        for joint in ("waist", "elbow")
    ]
    places = {"tip": {"quantity": "position", "point": "tip", "noise_std": 1e-4}, **signals}
    shown = [Signal(name=n, pose=names, values=np.zeros((12, 3)), **given) for n, given in places.items()]
    record = Record(signals=[*told, *shown], drive=["waist", "elbow"], kind="static")
    simulated = simulate_record(arm, record, align=False).simulated
    placement = stated_placement(record)
    predicted = {
        name: signal.replace(values=simulated.predicted(signal, placement))
        for name, signal in simulated.evidence.items()
    }
    return arm, record.replace(signals={**record.signals, **predicted})


def test_a_gyro_in_poses_is_predicted_zero_and_checked():
    arm, record = poses(gyro={"quantity": "angular_rate", "point": "tip", "noise_std": 1e-4})
    assert check(arm, {"run": record}).faults == ()


def test_an_accelerometer_in_another_unit_is_checked_in_poses():
    """All its rows are out of range: the ends of the others are unknown."""
    given = {"quantity": "acceleration", "point": "tip", "noise_std": 1e-2}
    arm, record = poses(accelerometer=given)
    wrong = record.signals["accelerometer"]
    scaled = record.replace(
        signals={**record.signals, "accelerometer": wrong.replace(values=1e3 * wrong.values)}
    )
    assert "accelerometer" in check(arm, {"run": scaled}).summary()


def test_a_quaternion_and_its_negative_do_not_scatter():
    attitude = np.array([0.0, 0.0, np.sin(0.2), np.cos(0.2)])
    rows = np.outer([1.0, -1.0, 1.0, -1.0], attitude)
    signal = Signal(
        name="flange", quantity="orientation", point="tip", pose=["a"] * 4, values=rows, noise_std=1e-4
    )
    record = Record(signals=[signal], kind="static", drive=[])
    assert list(remarks_on_poses({"run": record})) == []


def test_a_channel_that_reads_exactly_zero_without_noise_has_a_value():
    """The fault's parameter is zero, no NaN, so that it can be saved."""
    t = np.linspace(0, 12, 601)
    hinge = Signal(
        name="hinge", quantity="joint_angle", joint="hinge", time=t, values=swing(t), noise_std=0.0
    )
    dead = Signal(
        name="dead", quantity="joint_angle", joint="hinge", side="output", time=t, values=0 * t, noise_std=0.0
    )
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        time=t[::5],
        values=swung().at(t[::5], "tip"),
        noise_std=1e-4,
    )
    record = Record(signals=[hinge, dead, tip], drive=["hinge"])
    [fault] = check(crane(), {"run": record}, step=5e-3).faults
    assert (fault.at, fault.name, fault.parameters[0].value) == ("dead", "dead_channel", 0.0)
    assert fault.effect().at == "dead"


@pytest.mark.parametrize(("values", "named"), [((0.2, -0.3), 2), ((0.2, 0.2), 1)])
def test_channels_that_stop_at_other_values_are_faults_of_their_own(values, named):
    tip = flexarm.measure(
        swung(),
        [
            Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=100, noise_std=1e-6),
            Sensor(name="tip", quantity="position", point="tip", rate_hz=10, noise_std=1e-4, frame="tracker"),
            Sensor(name="rate", quantity="joint_rate", joint="hinge", rate_hz=10, noise_std=1e-5),
        ],
        np.random.default_rng(0),
        drive=["hinge"],
        frames={"tracker": Frame()},
    )
    old = tip.signals["tip"]
    new = old.values.copy()
    new[:, 0], new[:, 2] = values
    record = tip.replace(signals={**tip.signals, "tip": old.replace(values=new)})
    found = check(crane(), {"run": record}, step=5e-3).faults
    assert [fault.name for fault in found] == ["dead_channel"] * named
    told = {channel: fault.parameters[0].value for fault in found for channel in fault.channels}
    assert told == pytest.approx({"x": values[0], "z": values[1]})
