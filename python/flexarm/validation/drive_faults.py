"""Drives at fault: encoders that count the other way, or in another unit.

A wrong drive moves the model wrongly everywhere, so each hypothesis (`validation.drive_hypotheses`) is
simulated: the fault is put on the drive's signal as an effect, which takes it back before the model is driven
(`flexarm.drive`). It wins if all channels together, each under its best hypothesis, then cost less
(`validation.finding`). Factors that are near one another leave all channels in order, so that the first one
that does is compared with the others, and its own factor f corrected by the slopes s of what the drive moves,

    f / s,   ln s = sum w ln s_i / sum w,   w = (s_i/std_i)^2                                          (1)

where these are off by more than a missing effect lets them be. Drives that stand cannot be taken back; see
`validation.stuck_drives`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp, log
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.effects import UnitError
from flexarm.validation.drive_hypotheses import Hypothesis, factors_of, hypotheses, moves, near, said_of
from flexarm.validation.finding import PRIOR, Finding, cost_of_all
from flexarm.validation.gain_faults import CERTAIN, findings
from flexarm.validation.initial_alignment import run

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record


COARSE = 1e-2
"""Step of hypotheses' runs [s]: enough to tell a factor of 57 or a sign."""
CLEAR = 5.0
"""Difference of costs from which a drive is at fault."""
PLAIN = 15.0
"""The same from which on, all channels being in order, only hypotheses near to this one are tried."""
REPAIRED = 0.7
"""Share of the channels that must be in order then; the others must have been at fault before, alike."""
MOST = 1e3
"""Logarithm of odds beyond which none are told apart, nor where the model cannot follow the drives at all."""
OFF = 0.1
"""Logarithm of (1) that needs another factor."""
EXACT = 0.01
"""Relative standard deviation of a factor at least; else what (1) is off by."""
ROUNDS = 3
"""Corrections (1) of a factor at most: where it is off by much the slopes shrink."""
Values = Mapping[str, tuple[float, float, str]]


@dataclass(frozen=True, eq=False)
class DriveFinding:
    """A fault of one drive of a record, or of all alike.

    Attributes
    ----------
    values : dict of str to dict of str to (value, std, unit)
        By the names of the drives at fault the parameters of their faults.
    name : str
        Of the fault.
    log_bayes : float
        Against the best explanation without it.
    sentence : str
        For a person.
    rest : list of Finding
        The channels, driven by what the drive really was; empty where that is lost.
    """

    values: Mapping[str, Values]
    name: str
    log_bayes: float
    sentence: str
    rest: Sequence[Finding] = ()

    @property
    def key(self) -> tuple[str, tuple[str, ...]]:
        """Fault and drives."""
        return self.name, tuple(self.values)


@dataclass(frozen=True, eq=False)
class _Trial:
    """A hypothesis, simulated.

    Attributes
    ----------
    rest : list of Finding
        The channels then.
    price : float
        What they cost, with the hypothesis itself; of several drives at fault the others cost `CLEAR` each.
    repairs : bool
        Whether it leaves enough of them in order, and none at fault that was not before.
    """

    hypothesis: Hypothesis
    rest: Sequence[Finding]
    price: float
    repairs: bool

    @property
    def whole(self) -> bool:
        """Whether all channels are in order."""
        return self.repairs and not any(each.name or each.strange for each in self.rest)


@dataclass(frozen=True, eq=False)
class _Case:
    """What hypotheses are tried on; `without` are the channels along the drives as they are, if any."""

    arm: Arm
    name: str
    record: Record
    without: Sequence[Finding] | None
    alpha: float

    def tried(self, hypothesis: Hypothesis, step: float) -> _Trial | None:
        """One hypothesis; None if the model cannot follow it."""
        repaired = self.arm.replace(effects=(*self.arm.effects, *hypothesis))
        simulations, _, _ = run(repaired, {self.name: self.record}, step, self.alpha)
        rest = findings(self.name, simulations[self.name]) if self.name in simulations else []
        if not rest:
            return None
        known = {each.key for each in self.without or () if each.name}
        new = any(each.name and each.key not in known for each in rest)
        repairs = not new and np.mean([not (each.name or each.strange) for each in rest]) >= REPAIRED
        price = cost_of_all(rest) - PRIOR + CLEAR * (len(hypothesis) - 1)
        return _Trial(hypothesis, rest, price, bool(repairs))

    def log_bayes(self, trial: _Trial) -> float:
        """Of a hypothesis against the best explanation without it."""
        before = cost_of_all(self.without) if self.without is not None else np.inf
        return float(min(before - trial.price, MOST))

    def finding(self, trial: _Trial | None) -> DriveFinding | None:
        """What a hypothesis says, if it repairs."""
        if trial is None or not trial.repairs:
            return None
        values = {}
        for effect in trial.hypothesis:
            slope = _slope(self.arm, str(self.record.signals[effect.at].joint), trial.rest)
            relative = max(EXACT, abs(log(slope)))
            values[effect.at] = {
                key: (value, relative * value, unit) for key, value, unit in effect.parameters()
            }
        said = said_of(self.arm, trial.hypothesis, self.record)
        return DriveFinding(values, trial.hypothesis[0].name, self.log_bayes(trial), said, trial.rest)


def drive_fault(
    arm: Arm, name: str, record: Record, without: Sequence[Finding] | None, step: float, alpha: float
) -> DriveFinding | None:
    """The best hypothesis on the drives of a record, if it is worth considering beside `without`.

    Parameters
    ----------
    without : sequence of Finding or None
        The channels along the drives as they are; None: the model cannot follow these.
    """
    case = _Case(arm, name, record, without, alpha)
    best: _Trial | None = None
    for hypothesis in hypotheses(arm, record, without):
        plain = best is not None and best.whole and case.log_bayes(best) > PLAIN
        if plain and best is not None and not near(hypothesis, best.hypothesis):
            continue
        best = _better(best, case.tried(hypothesis, COARSE))
    for _ in range(ROUNDS):
        other = _corrected(arm, record, best)
        trial = None if other is None else case.tried(other, COARSE)
        if trial is None or _better(best, trial, CLEAR) is not trial:
            break
        best = trial
    found = case.finding(best and case.tried(best.hypothesis, step))
    return found if found is not None and found.log_bayes > -CLEAR else None


def _better(one: _Trial | None, other: _Trial | None, by: float = 0.0) -> _Trial | None:
    """The one that repairs, else the cheaper one; the other must be cheaper by so much."""
    if one is None or other is None:
        return one or other
    if one.repairs != other.repairs:
        return one if one.repairs else other
    return other if other.price < one.price - by else one


def _corrected(arm: Arm, record: Record, trial: _Trial | None) -> Hypothesis | None:
    """A unit error of one drive with the factor (1); None if its own is as good."""
    factors = factors_of(trial.hypothesis) if trial is not None else {}
    if trial is None or len(factors) != 1:
        return None
    [(at, factor)] = factors.items()
    slope = _slope(arm, str(record.signals[at].joint), trial.rest)
    return None if abs(log(slope)) < OFF else (UnitError(at=at, factor=factor / slope),)


def _slope(arm: Arm, joint: str, found: Sequence[Finding]) -> float:
    """Slope (1) of the channels that a joint moves, 1 where none is known."""
    fits = [each.channel.fit() for each in found if moves(arm, joint, each.channel.signal)]
    known = [fit for fit in fits if fit.slope > CERTAIN * fit.std]
    if not known:
        return 1.0
    weights = [(fit.slope / fit.std) ** 2 for fit in known]
    return exp(float(np.average([log(fit.slope) for fit in known], weights=weights)))  # eq. (1)


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

    if not set(fault.values) <= set(record.drive):
        return None
    effects: list[Any] = [
        read_effect({"name": fault.name, "at": at, **{key: value for key, (value, _, _) in values.items()}})
        for at, values in fault.values.items()
    ]
    case = _Case(arm, name, record, without, alpha)
    found = case.finding(case.tried(tuple(effects), step))
    return found if found is not None and found.log_bayes > 0 else None
