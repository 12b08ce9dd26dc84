"""A motor's current with a torque constant is its torque, of records, sensors and import maps."""

import numpy as np
import pytest
from arms import TUBE, beam, hinge

import flexarm

KT, RATIO = 0.12, 120.0
RECORD = """format = "flexarm-record/1"
drive = "hinge"

[[signals]]
name = "hinge"
quantity = "joint_angle"
joint = "hinge"
side = "motor"
file = "data.csv"
time = "time_s"
channels = ["hinge_rad"]

[[signals]]
name = "drive"
quantity = "motor_current"
joint = "hinge"
side = "motor"
torque_constant = 0.12
file = "data.csv"
time = "time_s"
channels = ["current"]
unit = "mA"
noise_std = 20.0
"""


def arm(**sensor: object) -> flexarm.Arm:
    sensors = [{"name": "drive", "joint": "hinge", "rate_hz": 50, **sensor}] if sensor else []
    return flexarm.Arm.from_dict(
        {
            "joints": [{**hinge("hinge", "rod"), "gear_ratio": RATIO}],
            "links": [beam("rod", [0, 0, 3.0], TUBE, damping_ratio=0.01)],
            "sensors": sensors,
        }
    )


def write(folder, text: str):
    folder.mkdir(exist_ok=True)
    (folder / "record.toml").write_text(text)
    rows = "\n".join(f"{t},{0.1 + 0.01 * t},{1000 + 100 * t}" for t in range(10))
    (folder / "data.csv").write_text(f"time_s,hinge_rad,current\n{rows}\n")
    return folder


def test_a_current_is_read_as_the_torque_at_the_shaft(tmp_path):
    signal = flexarm.Record.load(write(tmp_path / "a", RECORD)).signals["drive"]
    assert (signal.quantity, signal.unit, signal.side) == ("motor_torque", "N m", "motor")
    assert signal.values[:, 0] == pytest.approx(KT * (1.0 + 0.1 * np.arange(10)))
    assert signal.noise_std == pytest.approx(KT * 0.02)


def test_a_record_of_currents_is_saved_as_torques(tmp_path):
    record = flexarm.Record.load(write(tmp_path / "a", RECORD))
    record.save(tmp_path / "b")
    again = flexarm.Record.load(tmp_path / "b").signals["drive"]
    assert np.array_equal(again.values, record.signals["drive"].values)
    assert again.noise_std == record.signals["drive"].noise_std


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("torque_constant = 0.12\n", "", "torque_constant (line 13): is missing; motor_current needs"),
        ("torque_constant = 0.12", "torque_constant = 0.0", "torque_constant (line 18): must be positive"),
        ('"motor_current"', '"joint_rate"', "torque_constant (line 18): makes a current a torque"),
        ('unit = "mA"', 'unit = "V"', "unit 'V' does not fit; allowed are A, mA"),
    ],
)
def test_what_cannot_be_is_an_error(tmp_path, old, new, said):
    with pytest.raises(flexarm.InvalidFile) as error:
        flexarm.Record.load(write(tmp_path / "a", RECORD.replace(old, new)))
    assert said in str(error.value)


@pytest.mark.parametrize(("side", "constant"), [("motor", KT), ("output", KT * RATIO)])
def test_a_sensor_of_currents_writes_torques(side, constant):
    """On the output side the torque constant is that of the output: the ratio is in it."""
    seen = arm(quantity="motor_current", torque_constant=constant, side=side, unit="A", step=0.01)
    t = np.linspace(0, 2, 101)
    run = flexarm.simulate(seen, flexarm.Drive.from_samples(t, {"hinge": 0.3 + 0.1 * t}))
    signal = flexarm.measure(run, seen.sensors, np.random.default_rng(1)).signals["drive"]
    assert (signal.quantity, signal.side) == ("motor_torque", side)
    torque = np.interp(signal.time, run.time, run.motor_torque[:, 0])
    expected = torque if side == "output" else torque / RATIO
    assert signal.values[:, 0] == pytest.approx(expected, abs=0.006 * constant)


def test_a_model_with_a_sensor_of_currents_is_written_and_read(tmp_path):
    seen = arm(quantity="motor_current", torque_constant=KT, unit="mA", noise_std=5.0)
    seen.to_toml(tmp_path / "arm.toml")
    assert flexarm.Arm.from_toml(tmp_path / "arm.toml") == seen
    assert seen.sensors[0].si == ("N m", pytest.approx(KT * 1e-3))
