"""What models may say: parameters left out, relative uncertainties of vectors, sensors like signals."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx

import flexarm
from flexarm.arm import Sensor
from flexarm.cli.run import run
from flexarm.effects import JointCompliance

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def arm() -> flexarm.Arm:
    return flexarm.Arm.from_toml(EXAMPLES / "one_link.toml")


def test_a_compliance_without_a_stiffness_is_without_effect(arm, tmp_path):
    """Effect parameters left out are zero or without effect: damping alone cannot turn a rigid joint."""
    text = (EXAMPLES / "one_link.toml").read_text().replace("stiffness = 1.0e5", "# stiffness = 1.0e5")
    (tmp_path / "arm.toml").write_text(text)
    rigid = flexarm.Arm.from_toml(tmp_path / "arm.toml")
    effect = rigid.effects[0]
    assert isinstance(effect, JointCompliance)
    assert effect.parameters() == [("damping", 200.0, "N m s/rad")]
    bent = flexarm.static(rigid, joints={"hinge": 0.5})
    assert bent.link_angle == approx([0.5], abs=1e-12)
    plain = flexarm.static(arm.without_effect("joint_compliance", "hinge"), joints={"hinge": 0.5})
    assert bent.position == approx(plain.position, abs=1e-12)


def test_a_relative_sigma_of_a_vector_holds_for_each_component(arm):
    """One number or [Iy, Iz] may stand for a second moment, and 2 % is 2 % of either."""
    table = arm.to_dict()
    table["links"][0] |= {"up": [1.0, 0.0, 0.0]}
    for given in (5e-7, [5e-7, 4e-7]):
        table["links"][0]["section"] = {
            "shape": "general",
            "area": 6e-4,
            "second_moment": given,
            "torsion_constant": 1e-6,
        }
        table["uncertainty"] = {"links.rod.section.second_moment": 0.02}
        nominal, sigma = flexarm.Arm.from_dict(table).sigma("links.rod.section.second_moment")
        assert nominal == approx(np.broadcast_to(given, 2))
        assert sigma == approx(0.02 * np.broadcast_to(given, 2))


def test_a_sensor_names_its_column_of_stamps_as_a_signal_does(arm, tmp_path):
    table = arm.to_dict()
    table["sensors"] = [
        {"name": "tip", "quantity": "position", "point": "tip", "rate_hz": 10.0, "time": "tracker_s"}
    ]
    sensing = flexarm.Arm.from_dict(table)
    swing = flexarm.simulate(sensing, flexarm.Drive.from_samples([0, 1], {"hinge": [0, 0]}))
    flexarm.measure(swing, sensing.sensors, np.random.default_rng(0)).save(tmp_path / "record")
    assert (tmp_path / "record" / "tip.csv").read_text().startswith("tracker_s,tip_x_m,tip_y_m,tip_z_m\n")


# ---------------------------------------------------------------------- joints that slide


@pytest.fixture
def slider(arm) -> flexarm.Arm:
    """The example's tube on a slide along x instead of a hinge."""
    table = arm.to_dict() | {"effects": []}
    table["joints"] = [
        {"name": "slide", "type": "prismatic", "parent": "base", "child": "rod", "axis": [1.0, 0.0, 0.0]}
    ]
    table["sensors"] = [
        {"name": "ruler", "quantity": "joint_angle", "joint": "slide", "rate_hz": 10.0, "noise_std": 1e-5},
        {"name": "thrust", "quantity": "motor_torque", "joint": "slide", "rate_hz": 10.0, "noise_std": 0.1},
    ]
    return flexarm.Arm.from_dict(table)


def test_drives_and_sensors_of_a_slide_are_in_metres_and_newtons(slider, tmp_path, capsys):
    """A record of a slide can be compared as it is, without a doubt about its units."""
    slider.to_toml(tmp_path / "arm.toml")
    (tmp_path / "drive.csv").write_text("time_s,slide\n0,0\n0.5,0.1\n1,0.2\n")
    command = [
        "simulate",
        tmp_path / "arm.toml",
        "--drive",
        tmp_path / "drive.csv",
        "--out",
        tmp_path / "out",
    ]
    assert run([str(word) for word in command]) == 0
    record = flexarm.Record.load(tmp_path / "out")
    assert {name: signal.unit for name, signal in record.signals.items()} == {
        "slide": "m",
        "ruler": "m",
        "thrust": "N",
    }
    assert record.check_against(slider) == []
    assert capsys.readouterr().err == ""


def test_a_message_names_no_unit_where_the_signal_has_its_own():
    """The noise of a signal is in the signal's unit, not in a unit called "unit"."""
    with pytest.raises(flexarm.InvalidParameter) as caught:
        Sensor(name="tip", quantity="position", point="tip", rate_hz=10.0, noise_std=-1.0, unit="mm")
    assert str(caught.value).endswith("must be at least 0, got -1")
