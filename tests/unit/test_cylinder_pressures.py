"""Two pressures and areas of a cylinder are its force, which `compare` sets beside the model's."""

import numpy as np
import pytest

import flexarm

BORE, RING = 5.0e-3, 3.2e-3  # areas of the piston and of the ring about its rod [m2]
RETURN = 8.0  # pressure on the rod's side [bar]
RECORD = """format = "flexarm-record/1"
drive = "stroke"

[[signals]]
name = "stroke"
quantity = "joint_angle"
joint = "piston"
side = "output"
unit = "m"
file = "data.csv"
time = "time_s"
channels = ["stroke"]

[[signals]]
name = "lift"
quantity = "force"
joint = "piston"
areas = [5.0e-3, 3.2e-3]
file = "data.csv"
time = "time_s"
channels = ["bottom", "rod"]
unit = "bar"
noise_std = 0.1
"""


def lift() -> flexarm.Arm:
    """A load of 200 kg on a vertical cylinder."""
    return flexarm.Arm.from_dict(
        {
            "joints": [
                {"name": "piston", "type": "prismatic", "parent": "base", "child": "rod", "axis": [0, 0, 1]}
            ],
            "links": [
                {
                    "name": "rod",
                    "type": "rigid",
                    "mass": 200.0,
                    "com": [0, 0, 0.5],
                    "inertia": [1.0, 1.0, 1.0],
                }
            ],
        }
    )


def write(folder, text: str = RECORD):
    """Write a record whose pressures bear the load and its acceleration, 0.5 m/s2 at most."""
    folder.mkdir(exist_ok=True)
    t = np.linspace(0, 2, 401)
    stroke, rise = 0.125 * (1 - np.cos(2 * t)), 0.5 * np.cos(2 * t)
    bottom = (200 * (9.81 + rise) + RETURN * 1e5 * RING) / BORE / 1e5
    rows = [f"{a:.4f},{b:.9f},{c:.9f},{RETURN}" for a, b, c in zip(t, stroke, bottom, strict=True)]
    (folder / "record.toml").write_text(text)
    (folder / "data.csv").write_text("time_s,stroke,bottom,rod\n" + "\n".join(rows) + "\n")
    return folder


def test_pressures_are_read_as_the_force_along_the_joint(tmp_path):
    signal = flexarm.Record.load(write(tmp_path / "a")).signals["lift"]
    assert (signal.quantity, signal.unit, signal.side) == ("motor_torque", "N", "output")
    assert signal.values[0, 0] == pytest.approx(200 * 10.31, rel=1e-8)
    assert signal.noise_std == pytest.approx(1e4 * np.hypot(BORE, RING))


def test_a_cylinder_with_one_pressure(tmp_path):
    text = RECORD.replace("[5.0e-3, 3.2e-3]", "[5.0e-3]").replace('["bottom", "rod"]', '["bottom"]')
    signal = flexarm.Record.load(write(tmp_path / "a", text)).signals["lift"]
    assert signal.values[0, 0] == pytest.approx(200 * 10.31 + RETURN * 1e5 * RING, rel=1e-8)


def test_the_force_is_that_of_newtons_law(tmp_path):
    """The model predicts m (g + a) but for the first instant, at which its arm still rests."""
    record = flexarm.Record.load(write(tmp_path / "a"))
    gap = flexarm.compare(lift(), record).signals["lift"]
    assert np.abs(gap.parts["total"][1:]).max() < 1e-3 * record.signals["lift"].noise_std


def test_it_is_saved_as_a_force(tmp_path):
    record = flexarm.Record.load(write(tmp_path / "a"))
    record.save(tmp_path / "b")
    again = flexarm.Record.load(tmp_path / "b").signals["lift"]
    assert np.array_equal(again.values, record.signals["lift"].values)
    assert again.unit == "N"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("areas = [5.0e-3, 3.2e-3]\n", "", "areas (line 14): is missing; force at a joint needs"),
        ("[5.0e-3, 3.2e-3]", "[5.0e-3, -3.2e-3]", "must be one or two areas above 0 m2"),
        ("[5.0e-3, 3.2e-3]", "[5.0e-3]", "channels (line 21): must be 1 for"),
        ('quantity = "force"', 'quantity = "joint_rate"', "make pressures a force at a joint; joint_rate"),
        ('unit = "bar"', 'unit = "N"', "unit 'N' does not fit; allowed are Pa"),
    ],
)
def test_what_cannot_be_is_an_error(tmp_path, old, new, said):
    with pytest.raises(flexarm.InvalidFile) as error:
        flexarm.Record.load(write(tmp_path / "a", RECORD.replace(old, new)))
    assert said in str(error.value)
