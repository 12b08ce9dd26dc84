"""Drives at fault: a joint's encoder that counts the other way, in another unit, or stands still.

A wrong drive moves the model wrongly everywhere, so each hypothesis is simulated: the fault is put on the
drive's signal as an effect, which takes it back before the model is driven (`flexarm.drive`). It wins if all
channels together, each under its best hypothesis, then cost less (`checks.finding`). Drives
that stand cannot be taken back; see `checks.standing`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.diagnosis.checks.finding import PRIOR, Finding
from flexarm.diagnosis.checks.findings import findings
from flexarm.diagnosis.checks.runs import run
from flexarm.diagnosis.checks.slopes import unit_named
from flexarm.measurement.torque import gear_ratio

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.arm.sensor_effect import ChannelEffect
    from flexarm.record import Record, Signal

COARSE = 1e-2
"""Step of hypotheses' runs [s]: enough to tell a factor of 57 or a sign."""
FACTORS = (180 / pi, pi / 180, 2 * pi, 0.5 / pi, 1e3, 1e-3, 100.0, 0.01, 10.0, 0.1, 2.0, 0.5, 4.0, 0.25)
"""Wrong units of angles and counts; the joint's own ratio and its inverse come on top."""
FARTHEST = 4 * pi
"""Angles of a revolute joint beyond which a hypothesis is not tried [rad]; lengths likewise [m]."""
CLEAR = 5.0
"""Difference of costs from which a drive is at fault."""
PLAIN = 15.0
"""The same from which on, all channels being in order, no other hypothesis is tried."""
REPAIRED = 0.7
"""Share of the channels that must be in order then; the others must have been at fault before, alike."""


@dataclass(frozen=True, eq=False)
class DriveFinding:
    """A fault of a drive of one record.

    Attributes
    ----------
    signal : Signal
        The drive.
    name : str
        Of the fault.
    log_bayes : float
        Against the best explanation without it.
    values : dict of str to (value, std, unit)
        Its parameters.
    sentence : str
        For a person.
    rest : list of Finding
        The channels, driven by what the drive really was; empty where that is lost.
    """

    signal: Signal
    name: str
    log_bayes: float
    values: dict[str, tuple[float, float, str]]
    sentence: str
    rest: Sequence[Finding] = ()


def drive_fault(
    arm: Arm, name: str, record: Record, without: Sequence[Finding] | None, step: float, alpha: float
) -> DriveFinding | None:
    """The best hypothesis on the drives of a record, if it is worth considering beside `without`.

    Parameters
    ----------
    without : sequence of Finding or None
        The channels along the drives as they are; None: the model cannot follow these.
    """
    best: tuple[float, ChannelEffect] | None = None
    for effect in _hypotheses(arm, record, without):
        trial = _tried(arm, name, record, effect, without, COARSE, alpha)
        if trial is not None and (best is None or trial.log_bayes > best[0]):
            best = trial.log_bayes, effect
        if trial is not None and trial.log_bayes > PLAIN and not any(e.name or e.strange for e in trial.rest):
            break
    if best is None:
        return None
    found = _tried(arm, name, record, best[1], without, step, alpha)
    return found if found is not None and found.log_bayes > -CLEAR else None


def same_fault(
    arm: Arm,
    name: str,
    record: Record,
    fault: DriveFinding,
    without: Sequence[Finding],
    step: float,
    alpha: float,
) -> DriveFinding | None:
    """A drive's fault that another record shows, if it explains this one as well or better."""
    from flexarm.arm.effect import read_effect

    table = {key: value for key, (value, _, _) in fault.values.items()}
    effect: Any = read_effect({"name": fault.name, "at": fault.signal.name, **table})
    if fault.signal.name not in record.drive:
        return None
    found = _tried(arm, name, record, effect, without, step, alpha)
    return found if found is not None and found.log_bayes > 0 else None


def _hypotheses(arm: Arm, record: Record, without: Sequence[Finding] | None) -> list[ChannelEffect]:
    """Effects on drives that would disturb what is disturbed, and leave a motion that arms make."""
    from flexarm.effects import SignError, UnitError

    signs: list[ChannelEffect] = []
    units: list[ChannelEffect] = []
    for name in record.drive:
        signal = record.signals[name]
        farthest = float(np.nanmax(np.abs(signal.values), initial=0.0))
        spread = float(np.nanstd(signal.values))
        if signal.joint is None or spread <= 3 * (signal.noise_std or 0.0):
            continue
        if without is not None and not disturbed(arm, signal.joint, without):
            continue
        signs.append(SignError(at=name))
        ratio = gear_ratio(arm, signal.joint)
        own = (ratio, 1 / ratio) if ratio != 1 else ()
        units += [
            UnitError(at=name, factor=factor)
            for factor in (*FACTORS, *own)
            if farthest / factor < FARTHEST and spread / factor > 1e-3
        ]
    return signs + units


def disturbed(arm: Arm, joint: str, found: Sequence[Finding]) -> bool:
    """Whether at least half of the signals that a joint moves do not follow the model."""
    odd: dict[str, bool] = {}
    for each in found:
        signal = each.channel.signal
        if moves(arm, joint, signal):
            odd[signal.name] = odd.get(signal.name, False) or bool(each.name) or each.strange
    return bool(odd) and sum(odd.values()) >= len(odd) / 2


def moves(arm: Arm, joint: str, signal: Signal) -> bool:
    """Whether a joint moves the place of a signal; torques are left to their own joint."""
    if signal.joint is not None:
        return signal.joint == joint
    link = signal.link or (arm.point(signal.point).link if signal.point is not None else "")
    while link and link != "base":
        above = next(each for each in arm.joints if each.child.split(":")[0] == link.split(":")[0])
        if above.name == joint:
            return True
        link = above.parent
    return False


def _tried(
    arm: Arm,
    name: str,
    record: Record,
    effect: ChannelEffect,
    without: Sequence[Finding] | None,
    step: float,
    alpha: float,
) -> DriveFinding | None:
    """One hypothesis, simulated; None if the model cannot follow it, or it repairs too little."""
    subjects, _, _ = run(arm.with_effect(effect), {name: record}, step, alpha)
    if name not in subjects:
        return None
    rest = findings(name, subjects[name])
    known = {each.key for each in without or () if each.name}
    new = any(each.name and each.key not in known for each in rest)
    if not rest or new or np.mean([not (each.name or each.strange) for each in rest]) < REPAIRED:
        return None
    before = sum(each.cost for each in without) if without is not None else np.inf
    bayes = before - sum(each.cost for each in rest) + PRIOR
    values = {key: (value, 0.01 * value, unit) for key, value, unit in effect.parameters()}
    return DriveFinding(
        record.signals[effect.at], effect.name, float(min(bayes, 1e3)), values, _said(effect, record), rest
    )


def _said(effect: ChannelEffect, record: Record) -> str:
    others = ", ".join(name for name in record.signals if name not in record.drive)
    if effect.name == "sign_error":
        return (
            f"the drive {effect.at} counts the other way: driven by its negative the model follows {others}"
        )
    factor = dict((key, value) for key, value, _ in effect.parameters())["factor"]
    return (
        f"the drive {effect.at} shows {factor:.5g} times the angle{unit_named(factor, 0.0)}: "
        f"driven by 1/{factor:.5g} of it the model follows {others}"
    )
