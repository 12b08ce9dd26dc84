"""A place that is off by the same wherever the arm stands counts from elsewhere, which is said."""

import re

import diagnoses
import numpy as np
import pytest
from arms import crane

from flexarm.effects import LinkLength
from flexarm.record import Record
from flexarm.validation.sensor_check import check

UP = np.array([0.0, 0.06])
"""Of what a tracker stands above the base [m], and does not say."""


def swing(off: np.ndarray | float = 0.0, frame: str = "base", part: slice = slice(None)) -> Record:
    """A tip that swings by 0.7 rad on a spring which the model lacks."""
    record = diagnoses.record(1)
    tip = record.signals["tip"]
    moved = tip.replace(values=tip.values[part] + off, time=tip.time[part], frame=frame)
    return record.replace(signals={**record.signals, "tip": moved})


def said(record: Record, arm=None) -> list[str]:
    remarks = check(arm or diagnoses.nominal(), {"run": record}).remarks
    return [remark for remark in remarks if "is off by" in remark]


@pytest.mark.parametrize(("off", "axis"), [(UP, "z"), (-UP, "z"), (UP[::-1], "x")])
def test_a_shift_without_a_frame_is_told(off, axis):
    """The spring that the model lacks takes some millimetres of it."""
    [remark] = said(swing(off))
    told = re.search(rf"(-?[0-9.]+) mm along {axis}", remark)
    assert told and float(told[1]) == pytest.approx(1e3 * off.sum(), abs=6.0)
    assert "wherever the arm stands" in remark and "give it one in [frames]" in remark


def test_a_stated_frame_and_what_an_arm_does_are_not():
    assert said(swing(UP, "tracker")) == []
    assert said(swing()) == []


def test_a_longer_link_turns_with_the_arm():
    assert said(swing(), crane().with_effect(LinkLength(at="rod", error=0.06))) == []


def test_an_arm_that_hardly_moves_says_nothing_of_its_frame():
    assert said(swing(UP, part=slice(0, 12))) == []
