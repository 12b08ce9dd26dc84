"""What records may say: clocks with offsets, poses, drives behind the reducer, nothing that moves."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx

import flexarm
from flexarm.arm import Sensor
from flexarm.cli.run import run
from flexarm.cli.virtual_record import simulated
from flexarm.errors import InvalidParameter
from flexarm.measurement.clocks import ClockError
from flexarm.record import Clock, Frame, Record, Signal

STIFFNESS = 1e5
"""Of the hinge of the example [N m/rad]."""


@pytest.fixture(scope="module")
def arm() -> flexarm.Arm:
    return flexarm.Arm.from_toml(Path(__file__).parents[2] / "examples" / "one_link.toml")


def poses(quantity: str, values: list, **keys: object) -> Signal:
    return Signal(name=quantity, quantity=quantity, values=values, pose=["a", "b"], **keys)


def static_record(*signals: Signal, **keys: object) -> Record:
    return Record(signals=signals, kind="static", **keys)


# ------------------------------------------------------------------- clocks and frames


def test_a_simulated_record_keeps_the_offsets_that_its_record_states(arm):
    """Stamps of a clock that is 0.5 s late show the motion of 0.5 s earlier, in their own frame."""
    time = np.arange(0, 4, 0.01)
    drive = flexarm.Drive.from_samples(time, {"hinge": 0.3 * np.sin(time) ** 2})
    run_ = flexarm.simulate(arm, drive)
    encoder = Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=100, clock="controller")
    tip = Sensor(name="tip", quantity="position", point="tip", rate_hz=10, frame="hall", clock="tracker")
    record = flexarm.measure(
        run_,
        [encoder, tip],
        np.random.default_rng(0),
        drive=["hinge"],
        clocks={"controller": Clock(), "tracker": Clock(offset=0.5)},
        frames={"hall": Frame(xyz=(1, 2, 3), rpy=(0.1, 0.2, 2.0))},
        clock_errors={"tracker": ClockError(delay=0.5)},
    )
    again = simulated(record, run_, arm)
    assert again.signals["tip"].values == approx(record.signals["tip"].values, abs=1e-9)


def test_without_a_drive_the_only_joint_gives_the_directions(arm):
    """The arm stands at q = 0: tangential is x, and x was not measured."""
    tip = Signal(
        name="tip", quantity="position", point="tip", axes=("z",), time=[0.0, 0.1], values=[3.0, 3.0]
    )
    gap = flexarm.compare(arm, Record(signals=[tip])).signals["tip"]
    assert set(gap.rms) == {"tangential", "radial", "normal", "total"}
    assert gap.rms["tangential"] is None
    assert gap.rms["radial"] == approx(gap.rms["total"])


# ------------------------------------------------------------------------------- poses


def test_an_encoder_behind_the_reducer_places_the_link(arm):
    """Motor's side: the link turns on by T/k beyond the drive; link's side: it stands where it was seen."""
    angle = [0.5, 1.0]
    found = {}
    for side in ("motor", "output"):
        drive = poses("joint_angle", angle, joint="hinge", side=side)
        torque = poses("motor_torque", [0.0, 0.0], joint="hinge", side="output")
        tip = poses("position", np.zeros((2, 3)), point="tip")
        gaps = flexarm.compare(arm, static_record(drive, torque, tip, drive=["joint_angle"])).signals
        found[side] = gaps
    torque_gap = found["motor"]["motor_torque"].parts["total"]
    turn = torque_gap / STIFFNESS  # gap: measured 0 minus the drive's torque, which holds the arm back
    sag = found["motor"]["position"].parts["tangential"] - found["output"]["position"].parts["tangential"]
    assert sag == approx(-3.0 * turn, rel=0.02)


def test_inclinations_and_accelerations_of_poses_are_compared(arm):
    """A section at the tip that leans by b reads the inclination pi/2 - b and g (-sin b, 0, cos b)."""
    drive = poses("joint_angle", [0.0, 0.7], joint="hinge", side="motor")
    leaning = flexarm.static(arm, joints={"hinge": 0.7}).rotation[0]
    b = np.arctan2(leaning[0, 2], leaning[2, 2])
    tilt = poses("inclination", [np.pi / 2, np.pi / 2 - b], point="tip", axes=("z",))
    at_rest = 9.81 * np.array([[0, 0, 1], [-np.sin(b), 0, np.cos(b)]])
    rest = poses("acceleration", at_rest, point="tip")
    gaps = flexarm.compare(arm, static_record(drive, tilt, rest, drive=["joint_angle"])).signals
    assert 0.7 < b < 0.75
    assert gaps["inclination"].max["total"] < 1e-7
    assert gaps["acceleration"].max["total"] < 1e-9


def test_a_pose_without_its_drive_is_refused(arm):
    drive = poses("joint_angle", [0.0, np.nan], joint="hinge", side="motor")
    tip = poses("position", np.zeros((2, 3)), point="tip")
    with pytest.raises(InvalidParameter, match="no value for the pose 'b'"):
        flexarm.compare(arm, static_record(drive, tip, drive=["joint_angle"]))


def test_poses_cannot_drive_a_simulation(arm, tmp_path, capsys):
    drive = poses("joint_angle", [0.0, 0.5], joint="hinge", side="motor")
    static_record(drive, drive=["joint_angle"]).save(tmp_path / "poses")
    model = Path(__file__).parents[2] / "examples" / "one_link.toml"
    code = run(["simulate", str(model), "--drive", str(tmp_path / "poses"), "--out", str(tmp_path / "out")])
    assert code == 2
    assert f'error: {tmp_path / "poses"}: kind: is "static"' in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_inputs_of_poses_need_no_noise_and_angles_without_drive_are_doubted():
    force = poses("force", np.zeros((2, 3)), point="tip")
    angle = poses("joint_angle", [0.0, 0.1], joint="hinge", noise_std=1e-6)
    told = {problem.where: problem.what for problem in static_record(force, angle).check()}
    assert set(told) == {"drive"}
    assert "place no joint" in told["drive"]


# ------------------------------------------------------------------------------- units


def test_values_that_contradict_their_unit_are_reported_in_any_frame(arm):
    """The tip goes 2.5 m; a thousandth of that, in a frame that may stand anywhere, is a wrong unit."""
    time = np.linspace(0, 2, 41)
    drive = flexarm.Drive.from_samples(time, {"hinge": 0.5 * time**2 / 2})
    encoder = Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=20)
    tip = Sensor(name="tip", quantity="position", point="tip", rate_hz=20, frame="hall")
    record = flexarm.measure(
        flexarm.simulate(arm, drive),
        [encoder, tip],
        np.random.default_rng(0),
        drive=["hinge"],
        frames={"hall": Frame(xyz=(1, 2, 3), rpy=(0.1, 0.2, 2.0))},
    )
    assert record.check_against(arm) == []
    small = record.signals["tip"].replace(values=1e-3 * record.signals["tip"].values)
    (told,) = record.replace(signals={**record.signals, "tip": small}).check_against(arm)
    assert told.where == "signals.tip"
    assert "is the unit right?" in told.what


def test_a_column_in_metres_with_another_unit_is_doubted(tmp_path):
    times = {"time": [0.0, 0.1], "noise_std": 1e-4}
    tip = Signal(name="tip", quantity="position", point="tip", values=np.ones((2, 3)), **times)
    torque = Signal(
        name="T", quantity="motor_torque", joint="hinge", values=[1, 1], channels=("T_N_m",), **times
    )
    Record(signals=[tip, torque.replace(side="output")]).save(tmp_path / "record")
    file = tmp_path / "record" / "record.toml"
    assert Record.load(file).notes == ()
    file.write_text(file.read_text().replace('unit = "m"', 'unit = "mm"'))
    assert {problem.where for problem in Record.load(file).notes} == {"signals.tip"}


def test_a_run_by_command_writes_the_angle_that_its_motor_took(arm):
    """The drive of the arm is always there as a joint_angle, whatever the controller was asked for."""
    table = arm.to_dict()
    table["controllers"] = [
        {
            "type": "cascade",
            "joint": "hinge",
            "position_gain": 5.0,
            "velocity_gain": 5000.0,
            "sample_time": 4e-3,
        }
    ]
    controlled = flexarm.Arm.from_dict(table)
    time = np.linspace(0, 1, 11)
    command = Signal(
        name="hinge", quantity="joint_command", joint="hinge", time=time, values=0.1 * time, clock="plc"
    )
    record = Record(signals=[command], drive=["hinge"], clocks={"plc": Clock()})
    swing = flexarm.simulate(controlled, record)
    written = simulated(record, swing, controlled)
    assert written.drive == ("hinge",)
    motor = written.signals["hinge_drive"]
    assert (motor.quantity, motor.side, motor.clock) == ("joint_angle", "motor", "plc")
    assert motor.values[:, 0] == approx(swing.drive_angle[:, 0])
    assert 0 < motor.values[-1, 0] < 0.1
