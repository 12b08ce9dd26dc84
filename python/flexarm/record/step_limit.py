"""Limit of the number of steps of a run."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from flexarm.errors import InvalidParameter, Problem

if TYPE_CHECKING:
    from flexarm.record import Record

MOST_STEPS = 20_000_000
"""More would fill the memory of a workstation: a step keeps about a kilobyte."""


def check_step_count(start: float, end: float, step: float) -> None:
    """Refuse a run from `start` to `end` [s] at a time step [s] that is too long.

    Raise InvalidParameter with the duration and the number of steps.
    """
    for problem in _too_many(end - start, step):
        raise InvalidParameter(problem.what, where=problem.where)


def endless(record: Record, step: float) -> Iterable[Problem]:
    """Yield the problem of a record that is too long for a run at a time step [s]."""
    spans = [
        float(signal.time[-1] - signal.time[0]) for signal in record.signals.values() if len(signal.time)
    ]
    return _too_many(max(spans, default=0.0), step)


def _too_many(seconds: float, step: float) -> Iterable[Problem]:
    steps = seconds / step if step > 0 else 0.0  # `_core.check_step` refuses a step that is none
    if steps > MOST_STEPS:
        what = f"lasts {seconds:.6g} s, {steps:.3g} steps of {step:g} s; allowed are {MOST_STEPS:.3g}"
        yield Problem("drive", what)
