"""Thresholds of the search are checked where a user states them."""

from dataclasses import replace
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


@pytest.mark.parametrize(
    ("field", "message"),
    [
        ("families", "half as many families as `proposals`"),
        ("rounds", "at the latest after `most_effects` rounds"),
        ("family_places", "at least three places"),
        ("doubtful", "one half at most"),
    ],
)
def test_a_removed_threshold_is_refused_with_what_replaced_it(field, message):
    with pytest.raises(InvalidParameter, match=f"{field}: is no field any more: .*{message}"):
        SelectionPolicy(**{field: 3})


def test_a_renamed_threshold_is_taken_and_read_with_a_warning():
    with pytest.warns(DeprecationWarning, match="most_of_gap is now SelectionPolicy.halfway"):
        policy = SelectionPolicy(most_of_gap=0.4, reach=2.0)
    assert (policy.halfway, policy.reach) == (0.4, 2.0)
    with pytest.warns(DeprecationWarning, match="most_of_gap"):
        assert policy.most_of_gap == 0.4
    with pytest.raises(InvalidParameter, match="most_of_gap: is now halfway, which is given too"):
        SelectionPolicy(most_of_gap=0.4, halfway=0.5)


def test_a_policy_with_one_other_value_keeps_all_else():
    assert replace(SelectionPolicy(halfway=0.4), reach=2.0) == SelectionPolicy(halfway=0.4, reach=2.0)


def test_a_policy_has_at_most_35_thresholds():
    assert len(SelectionPolicy.__dataclass_fields__) - 1 <= 35  # without the names of moves


def test_a_policy_of_another_type_is_refused_before_any_work(model_file: Path):
    arm = flexarm.Arm.from_toml(model_file)
    with pytest.raises(InvalidParameter, match=r"policy: must be a SelectionPolicy"):
        flexarm.diagnose(arm, {}, policy={"reach": 3.0})
