"""A record that says how the controllers were set in its run."""

import numpy as np
import pytest
from tests.helpers.arms import beam, hinge, point

import flexarm
from flexarm import InvalidParameter, Record, Signal


def controlled() -> flexarm.Arm:
    return flexarm.Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [beam("rod", [0, 0, 1.0], {"shape": "round", "diameter": 0.02})],
            "points": [point("tip", "rod", [0, 0, 1.0])],
            "controllers": [
                {
                    "type": "cascade",
                    "joint": "hinge",
                    "position_gain": 10.0,
                    "velocity_gain": 50.0,
                    "sample_time": 1e-3,
                }
            ],
        }
    )


def test_settings_of_a_run_replace_those_of_the_model_and_no_others(tmp_path):
    command = Signal(
        name="c", quantity="joint_command", joint="hinge", values=np.zeros((3, 1)), time=np.arange(3.0)
    )
    record = Record(signals=[command], drive=("c",), controllers={"hinge": {"position_gain": 7.5}})
    record.save(tmp_path / "record")
    for given in (record, Record.load(tmp_path / "record")):
        law = given.applied_to(controlled()).controllers[0]
        assert (law.position_gain, law.velocity_gain, law.sample_time) == (7.5, 50.0, 1e-3)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"elbow": {"position_gain": 7.5}}, r"controllers\.elbow: there is no controller 'elbow'"),
        ({"hinge": {"gain": 7.5}}, r"controllers\.hinge\.gain: there is no value 'gain'"),
        ({"hinge": {"position_gain": -7.5}}, r"position_gain: must be positive, got -7\.5 1/s"),
    ],
)
def test_settings_that_mean_nothing_are_named(settings, message):
    with pytest.raises(InvalidParameter, match=message):
        Record(signals=[], controllers=settings).applied_to(controlled())
