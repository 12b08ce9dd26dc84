"""Two axes at one place are one joint of the machine, if nothing drives them and nothing lies between."""

from types import SimpleNamespace

import pytest
from tests.helpers.arms import hinge, point

from flexarm import Arm
from flexarm.diagnosis.candidates import cardan_joints, effect_count


def guide(mass: float = 0.0, shift: float = 0.0) -> Arm:
    """A mast on two crossed hinges, and a driven arm on it."""
    rigid = {"type": "rigid", "mass": mass} | ({"com": [0, 0, 0]} if mass else {})
    return Arm.from_dict(
        {
            "joints": [
                hinge("roll", "cross") | {"axis": [1, 0, 0]},
                hinge("pitch", "mast", parent="cross") | {"origin": {"xyz": [0, 0, shift]}},
                hinge("elbow", "arm", parent="mast"),
            ],
            "links": [
                {"name": "cross"} | rigid,
                {"name": "mast", "type": "rigid", "mass": 1.0},
                {"name": "arm", "type": "rigid", "mass": 1.0, "com": [0, 0, 0.5]},
            ],
            "points": [point("tip", "arm", [0, 0, 1])],
        }
    )


def test_crossed_hinges_without_anything_between_are_one_place():
    assert cardan_joints(guide(), {"elbow"}) == {"roll": "pitch"}


@pytest.mark.parametrize(
    "arm, driven",
    [(guide(mass=2.0), {"elbow"}), (guide(shift=0.1), {"elbow"}), (guide(), {"elbow", "pitch"})],
    ids=["mass between", "apart", "driven"],
)
def test_others_are_places_of_their_own(arm, driven):
    assert cardan_joints(arm, driven) == {}


def test_both_axes_of_a_place_count_once():
    soft = [
        SimpleNamespace(
            name="joint_compliance", place=("joint_compliance", at), effect=SimpleNamespace(at=at)
        )
        for at in ("roll", "pitch", "elbow")
    ]
    assert effect_count(soft, {"roll": "pitch"}) == 2
    assert effect_count(soft[1:], {"roll": "pitch"}) == 2
