"""What is told of drives at fault."""

from __future__ import annotations

from collections.abc import Mapping
from math import log
from typing import TYPE_CHECKING

from flexarm.diagnosis.checks.drive_hypotheses import Hypothesis, factors_of
from flexarm.diagnosis.checks.slopes import unit_named
from flexarm.diagnosis.wording import listed
from flexarm.measurement.torque import gear_ratio

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record

OFF_RATIO = 0.01
"""Logarithm to which a factor is told from a gear's ratio."""


def said_of(arm: Arm, hypothesis: Hypothesis, record: Record) -> str:
    """What the drives do, and what follows the model once that is taken back."""
    others = ", ".join(name for name in record.signals if name not in record.drive)
    factors = factors_of(hypothesis)
    if not factors:
        [effect] = hypothesis
        return (
            f"the drive {effect.at} counts the other way: driven by its negative the model follows {others}"
        )
    drives = (
        f"the drive {next(iter(factors))} shows"
        if len(factors) == 1
        else f"the drives {listed(list(factors))} show"
    )
    times = listed(list(dict.fromkeys(f"{factor:.5g}" for factor in factors.values())))
    parts = listed(list(dict.fromkeys(f"1/{factor:.5g}" for factor in factors.values())))
    at, factor = next(iter(factors.items()))
    what = "angle" if all(record.signals[each].unit == "rad" for each in factors) else "length"
    why = _of_ratios(arm, record, factors) or unit_named(factor, 0.0, record.signals[at].unit)
    return f"{drives} {times} times the {what}{why}: driven by {parts} of it the model follows {others}"


def _of_ratios(arm: Arm, record: Record, factors: Mapping[str, float]) -> str:
    """That factors are those of gears, if they are; for a sentence."""
    ratios = {at: gear_ratio(arm, str(record.signals[at].joint)) for at in factors}
    if all(ratio == 1 for ratio in ratios.values()):
        return ""
    if all(abs(log(factors[at] / ratio)) < OFF_RATIO for at, ratio in ratios.items()):
        return ", the motor's own angle, not divided by the gear ratio"
    if all(abs(log(factors[at] * ratio)) < OFF_RATIO for at, ratio in ratios.items()):
        return ", the angle divided by the gear ratio twice"
    return ""
