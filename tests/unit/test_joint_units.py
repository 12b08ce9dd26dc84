"""Along a joint that slides, effects are told in metres and newtons."""

import numpy as np
import pytest
from arms import hinge

import flexarm
from flexarm.arm.joint_units import parameters_in, priors_in
from flexarm.arm.parameter import parameters
from flexarm.arm.sensor import Sensor
from flexarm.effects import (
    Backlash,
    CableTorque,
    CoulombFriction,
    EncoderOffset,
    JointCompliance,
    JointHysteresis,
    JointStiffening,
    TransmissionError,
    ViscousFriction,
)
from flexarm.residual_analysis.motion_states import JointStates

UNITS = [
    (JointCompliance, {"stiffness": 2e5, "damping": 10.0}, "stiffness", "N m/rad", "N/m"),
    (JointCompliance, {"stiffness": 2e5, "damping": 10.0}, "damping", "N m s/rad", "N s/m"),
    (JointStiffening, {"cubic_stiffness": 1e9}, "cubic_stiffness", "N m/rad3", "N/m3"),
    (Backlash, {"gap": 1e-3}, "gap", "rad", "m"),
    (JointHysteresis, {"torque": 5.0, "width": 1e-3}, "torque", "N m", "N"),
    (CoulombFriction, {"torque": 5.0}, "torque", "N m", "N"),
    (ViscousFriction, {"coefficient": 5.0}, "coefficient", "N m s/rad", "N s/m"),
    (CableTorque, {"stiffness": 5.0, "rest_angle": 0.1}, "rest_angle", "rad", "m"),
    (TransmissionError, {"amplitude": 1e-4, "multiple": 1.0, "phase": 0.3}, "amplitude", "rad", "m"),
    (TransmissionError, {"amplitude": 1e-4, "multiple": 1.0, "phase": 0.3}, "phase", "rad", "rad"),
]


@pytest.fixture(scope="module")
def lift():
    """A mast that slides, and an arm on it that turns; an encoder of the lift."""
    arm = flexarm.Arm.from_dict(
        {
            "joints": [
                {"name": "lift", "type": "prismatic", "parent": "base", "child": "mast", "axis": [0, 0, 1]},
                hinge("slew", "boom", "mast"),
            ],
            "links": [
                {"name": "mast", "type": "rigid", "mass": 20.0},
                {"name": "boom", "type": "rigid", "mass": 5.0},
            ],
        }
    )
    return arm.replace(sensors=(Sensor(name="height", quantity="joint_angle", joint="lift", rate_hz=100),))


@pytest.mark.parametrize(("effect", "values", "parameter", "turning", "sliding"), UNITS)
def test_a_parameter_has_the_unit_of_its_joint(lift, effect, values, parameter, turning, sliding):
    for joint, unit in (("slew", turning), ("lift", sliding)):
        here = effect(at=joint, **values)
        assert {name: told for name, _, told in parameters_in(here, lift)}[parameter] == unit
        if parameter in priors_in(here, lift):
            assert priors_in(here, lift)[parameter].unit == unit


def test_so_have_an_encoder_and_a_key_of_the_model(lift):
    [(_, _, unit)] = parameters_in(EncoderOffset(at="height", offset=1e-3), lift)
    assert unit == "m"
    soft = lift.with_effect(JointCompliance(at="lift", stiffness=2e5, damping=10.0))
    [found] = parameters(soft, ["effects.joint_compliance.lift.stiffness"])
    assert (found.value, found.unit) == (2e5, "N/m")
    assert "joint_compliance at lift: stiffness = 200000 N/m, damping = 10 N s/m" in str(soft.summary())


@pytest.mark.parametrize(("slides", "label"), [(True, "force of lift [N]"), (False, "torque of lift [N m]")])
def test_axes_of_its_states_are_of_position_and_force(slides, label):
    none = np.zeros(2)
    states = JointStates(
        "lift", none, none, none, none, none, none, np.zeros(2, dtype=np.intp), slides=slides
    )
    assert states.label("torque") == label


def test_results_tell_the_unit_of_each_joint(lift):
    """In files of runs, equilibria and modes, and beside the curves of a run."""
    values = {"lift": 0.1, "slew": 0.2}
    at_rest = flexarm.static(lift, values)
    drive = flexarm.Drive.from_samples([0.0, 0.01], {name: [v, v] for name, v in values.items()})
    run = flexarm.simulate(lift, drive)
    soft = lift.with_effect(JointCompliance(at="lift", stiffness=2e5, damping=10.0))
    for result in (at_rest, run, flexarm.modes(soft, values)):
        assert result.dataset["drive_angle"].attrs["units"] == "m, rad"
    assert run.dataset["joint_rate"].attrs["units"] == "m/s, rad/s"
    assert (
        run.dataset["motor_torque"].attrs["units"]
        == at_rest.dataset["joint_torque"].attrs["units"]
        == "N, N m"
    )
    assert run.plot().get_ylabel() == "joint angle [m, rad]"


def test_a_record_without_units_takes_those_of_the_model_it_meets(lift, tmp_path):
    """The numbers stay; a unit that is stated and does not fit stays too, and is told."""
    rows = np.arange(30)
    columns = np.column_stack([0.01 * rows, 0.001 * rows, 0.002 * rows])
    np.savetxt(tmp_path / "log.csv", columns, delimiter=",", header="time_s,way,turn", comments="")
    signal = (
        '[[signals]]\nname = "{0}"\nquantity = "joint_angle"\njoint = "{0}"\nside = "output"\n'
        'file = "log.csv"\ntime = "time_s"\nchannels = ["{1}"]\n'
    )
    text = 'format = "flexarm-record/1"\n' + signal.format("lift", "way") + signal.format("slew", "turn")
    (tmp_path / "record.toml").write_text(text)
    record = flexarm.Record.load(tmp_path)
    assert record.check_against(lift) == []
    known = record.with_units_of(lift)
    assert (known.signals["lift"].unit, known.signals["slew"].unit) == ("m", "rad")
    assert known.signals["lift"].values == pytest.approx(record.signals["lift"].values)
    (tmp_path / "record.toml").write_text(text.replace('["way"]', '["way"]\nunit = "rad"'))
    [problem] = flexarm.Record.load(tmp_path).with_units_of(lift).check_against(lift)
    assert str(problem) == "signals.lift.unit: is rad, but joint 'lift' is prismatic and needs a unit like m"
    assert flexarm.compare(lift, record.replace(drive=("slew",))).signals["lift"].unit == "m"
