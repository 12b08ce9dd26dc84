"""What may be wrong with the drives of a record: one that counts the other way, one or all in another unit.

A hypothesis is a tuple of effects that take the fault back before the model is driven (`flexarm.drive`). One
that leaves no joint turning more often than arms do comes first; among these, fewer drives at fault do. Of
all drives together units are tried alone: who writes one angle in degrees writes all of them so.

What is told of drives at fault.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import log, pi
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.gears import coupled_joints, shaft_ratio
from flexarm.arm.sizes import LONGEST
from flexarm.measurement.torque import gear_ratio
from flexarm.record.plausibility import FARTHEST
from flexarm.record.time_unit import LIVELY, motion_of
from flexarm.validation.finding import Finding
from flexarm.validation.gain_faults import unit_named
from flexarm.wording import listed

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.arm.sensor_effect import ChannelEffect
    from flexarm.record import Record, Signal


Hypothesis = tuple["ChannelEffect", ...]

FACTORS = (180 / pi, pi / 180, 2 * pi, 0.5 / pi, 1e3, 1e-3, 100.0, 0.01, 10.0, 0.1, 2.0, 0.5, 4.0, 0.25)
"""Wrong units of angles and counts; the joint's own ratio and its inverse come on top."""
OF_ALL = (180 / pi, pi / 180, 2 * pi, 0.5 / pi, 1e3, 1e-3)
"""The same of all drives together."""
WILD = 20 * pi
"""Angle of a drive [rad], at a joint's output, beyond which no model is driven by it if it is fast, too.

It is five times as far as hardly any joint goes; such a run takes minutes and says no more.
"""
LEAST = 1e-3
"""Standard deviation of a motion that a hypothesis must leave [rad or m]."""
NEAR = 12.0
"""Ratio of factors within which one may pass for another: little is known of motions a tenth too small."""


def hypotheses(arm: Arm, record: Record, without: Sequence[Finding] | None) -> list[Hypothesis]:
    """Faults of drives that would disturb what is disturbed, and leave a motion that arms make.

    Parameters
    ----------
    without : sequence of Finding or None
        The channels along the drives as they are; None: the model cannot follow these.
    """
    from flexarm.effects import SignError

    drives = [record.signals[name] for name in record.drive]
    drives = [signal for signal in drives if signal.joint is not None and signal.valid.any()]
    moving = [
        signal
        for signal in drives
        if _spread(signal) > 3 * (signal.noise_std or 0.0)
        and (without is None or disturbed(arm, str(signal.joint), without))
    ]
    found: list[Hypothesis] = [(SignError(at=signal.name),) for signal in moving]
    found += [each for signal in moving for each in _units([signal], arm, FACTORS)]
    turning = [signal for signal in drives if signal.unit == "rad"]
    if moving and len(turning) > 1:
        found += _units(turning, arm, OF_ALL)
    beyond = wild_drives(arm, record)
    found = [each for each in found if beyond <= factors_of(each).keys()]
    wild = {signal.name for signal in drives if _over(signal, arm) > 1}
    return sorted(found, key=lambda each: not wild <= {effect.at for effect in each})


def wild_drives(arm: Arm, record: Record) -> set[str]:
    """Return the drives that turn their joint further than `WILD` and faster than joints do, as they stand.

    Drives with an effect of the model are left out: it says what their values are.
    """
    known = {effect.at for effect in arm.effects if effect.place.startswith("signal")}
    drives = [record.signals[name] for name in record.drive if name not in known]
    return {signal.name for signal in drives if is_wild(signal, arm)}


def is_wild(signal: Signal, arm: Arm) -> bool:
    """Return True if a drive of a motion turns its joint further than `WILD`, and faster than joints do."""
    turns = signal.unit == "rad" and signal.joint is not None and signal.pose is None
    if not turns or FARTHEST * _over(signal, arm) <= WILD:
        return False
    motion = motion_of(signal.name, signal.time, signal.values[:, 0], signal.unit)
    return motion.rate > LIVELY * shaft_ratio(signal.joint, arm.gears)


def _units(drives: Sequence[Signal], arm: Arm, factors: Iterable[float]) -> list[Hypothesis]:
    """Drives in one wrong unit, or not divided by their ratios, or twice."""
    from flexarm.effects import UnitError

    ratios = [gear_ratio(arm, str(signal.joint)) for signal in drives]
    alike = [[factor] * len(drives) for factor in factors]
    own = [ratios, [1 / ratio for ratio in ratios]]
    if all(is_wild(signal, arm) for signal in drives):
        own.append([180 / pi * ratio for ratio in ratios])  # degrees of the motor
    own = own if any(ratio != 1 for ratio in ratios) else []
    return [
        tuple(UnitError(at=signal.name, factor=f) for signal, f in zip(drives, each, strict=True))
        for each in [*alike, *own]
        if all(_over(signal, arm) / f < 1 for signal, f in zip(drives, each, strict=True))
        and any(_spread(signal) / f > LEAST for signal, f in zip(drives, each, strict=True))
    ]


def near(one: Hypothesis, other: Hypothesis) -> bool:
    """Whether two hypotheses put a drive in units that may pass for one another."""
    mine, its = factors_of(one), factors_of(other)
    return any(abs(log(mine[at] / its[at])) < log(NEAR) for at in mine.keys() & its.keys())


def factors_of(hypothesis: Hypothesis) -> dict[str, float]:
    """Factors of unit errors by signal."""
    return {
        effect.at: value for effect in hypothesis for key, value, _ in effect.parameters() if key == "factor"
    }


def _over(signal: Signal, arm: Arm) -> float:
    """How far a drive goes, over what arms do: a hypothesis that leaves more is not tried."""
    most = FARTHEST * shaft_ratio(signal.joint, arm.gears) if signal.unit == "rad" else LONGEST
    return float(np.nanmax(np.abs(signal.values), initial=0.0)) / most


def _spread(signal: Signal) -> float:
    return float(np.nanstd(signal.values))


def disturbed(arm: Arm, joint: str, found: Sequence[Finding]) -> bool:
    """Whether at least half of the signals that a joint moves do not follow the model."""
    odd: dict[str, bool] = {}
    for each in found:
        signal = each.channel.signal
        if moves(arm, joint, signal):
            odd[signal.name] = odd.get(signal.name, False) or bool(each.name) or each.strange
    return bool(odd) and sum(odd.values()) >= len(odd) / 2


def moves(arm: Arm, joint: str, signal: Signal) -> bool:
    """Whether a joint, with what gears move along, moves a signal's place; torques are of their own joint."""
    if signal.joint is not None:
        return signal.joint == joint
    together = coupled_joints({joint}, arm.gears)
    link = signal.link or (arm.point(signal.point).link if signal.point is not None else "")
    while link and link != "base":
        above = next(each for each in arm.joints if each.child.split(":")[0] == link.split(":")[0])
        if above.name in together:
            return True
        link = above.parent
    return False


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
