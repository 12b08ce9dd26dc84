"""Thresholds of the search are checked where a user states them."""

from pathlib import Path

import pytest

import flexarm
from flexarm import InvalidParameter, SelectionPolicy


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"reach": -1.0}, r"reach: must be a positive, finite number, got -1.0"),
        ({"reach": "3"}, r"reach: must be a positive, finite number, got '3'"),
        ({"discrepancy": float("nan")}, r"discrepancy: must be a positive, finite number, got nan"),
        ({"proposals": 2.5}, r"proposals: must be a positive whole number, got 2.5"),
        ({"moves": ("forwards",)}, r"moves: must be of confounding, .*, got 'forwards'"),
    ],
)
def test_a_threshold_that_cannot_be_is_refused_by_name(changes, message):
    with pytest.raises(InvalidParameter, match=message):
        SelectionPolicy(**changes)


def test_a_policy_has_at_most_35_thresholds():
    assert len(SelectionPolicy.__dataclass_fields__) - 1 <= 35  # without the names of moves


def test_a_policy_of_another_type_is_refused_before_any_work(model_file: Path):
    arm = flexarm.Arm.from_toml(model_file)
    with pytest.raises(InvalidParameter, match=r"policy: must be a SelectionPolicy"):
        flexarm.diagnose(arm, {}, policy={"reach": 3.0})
