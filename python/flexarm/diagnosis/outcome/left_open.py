"""Nominal values that the data leave open go back to where the model had them.

A fit within stated uncertainties moves everything a little: what the data do not determine moves along with
what they do. The repaired model shall not claim that. So such values are put back, all together, unless the
gap on the training would grow by it: five lengths of which only the sum shows are each left open, and yet
must not all go back.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from flexarm.arm.parameter import with_value
from flexarm.diagnosis.outcome.refinement import Refinement, stated_sigma

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.comparison.comparison import Comparison
    from flexarm.diagnosis.named import Refined

GROWTH = 0.01
"""Growth of the rms gap of a signal, over the larger of gap and noise, that counts as none."""


def left_open(
    arm: Arm,
    updated: Arm,
    refined: tuple[Refined, ...],
    gaps: Callable[[Arm], Mapping[str, Comparison]],
) -> tuple[Arm, tuple[Refined, ...]]:
    """The repaired model and its refined values, with those that the data leave open as they were.

    Parameters
    ----------
    arm, updated : Arm
        The nominal and the repaired model.
    refined : tuple of Refined
        What moved.
    gaps : callable
        The gap of a model by record of the training.
    """
    open_ones = [
        each for each in refined if not Refinement(each, stated_sigma(arm, each.parameter)).determined
    ]
    if updated is arm or not open_ones:
        return updated, refined
    back = updated
    for each in open_ones:
        back = with_value(back, each.parameter, each.nominal)
    if _grows(gaps(updated), gaps(back)):
        return updated, refined
    return back, tuple(replace(each, value=each.nominal) if each in open_ones else each for each in refined)


def _grows(before: Mapping[str, Comparison], after: Mapping[str, Comparison]) -> bool:
    """Whether any signal of any record is missed by more."""
    for name, comparison in before.items():
        for signal, gap in comparison.evidence.items():
            other = after[name].evidence.get(signal)
            old, new = gap.rms["total"], None if other is None else other.rms["total"]
            if old is not None and (new is None or new - old > GROWTH * max(old, gap.noise_rms or 0.0)):
                return True
    return False
