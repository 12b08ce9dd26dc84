"""Faulty drives: encoders that count the other way or in another unit.

A wrong drive moves the model wrongly everywhere. Each hypothesis of `validation.drive_hypotheses` is an
effect on the drive's signal that takes the fault back, and is simulated. It wins if all channels together,
each under its best hypothesis, then cost less (`validation.finding`, eq. (2)). Only those are simulated with
which the rigid arm alone explains more (`validation.drive_hypotheses`). Similar factors all leave the
channels in order. The first one that does is compared with the others, and its factor f is corrected by the
gains s of the channels that the drive moves,

    f / s,   ln s = sum w ln s_i / sum w,   w = (s_i/std_i)^2,                                         (1)

where they differ from 1 by more than a missing effect explains. The motion of a stuck drive is lost; see
`validation.stuck_drives`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import exp, inf, log
from typing import Any

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.effect import read_effect
from flexarm.budget import allows
from flexarm.effects import UnitError
from flexarm.errors import InvalidParameter
from flexarm.record import Record
from flexarm.validation.drive_hypotheses import (
    Hypothesis,
    describe_hypothesis,
    drive_hypotheses,
    is_moved_by,
    kinematic_signals,
    relative_range,
    rigid_record,
    similar_factors,
    unit_factors,
)
from flexarm.validation.finding import ChannelFinding, DriveFault, total_cost
from flexarm.validation.gain_faults import find_channel_faults
from flexarm.validation.initial_alignment import simulate_records
from flexarm.validation.policy import POLICY


@dataclass(frozen=True, eq=False)
class _TestedHypothesis:
    """Hold a hypothesis and the channels that its simulation leaves."""

    hypothesis: Hypothesis
    channels: Sequence[ChannelFinding]
    """The channels then."""
    cost: float
    """Costs of the channels and of the hypothesis; further drives at fault cost `clear_log_odds` each."""
    repairs: bool
    """True if enough channels are in order, and none is at fault that was not before."""

    @property
    def all_in_order(self) -> bool:
        """Return True if all channels are in order."""
        return self.repairs and not any(each.name or each.unexplained for each in self.channels)


@dataclass(frozen=True, eq=False)
class DriveTest:
    """Simulate hypotheses for one record."""

    arm: Arm
    name: str
    record: Record
    channels: Sequence[ChannelFinding] | None = None
    """Those along the drives as recorded; None if the model cannot follow these."""
    step: float = POLICY.coarse_step
    """Step [s] and `alpha` [-] of the last simulation of a hypothesis; those before have a coarse step."""
    alpha: float = 0.0

    def simulate(self, hypothesis: Hypothesis, step: float = POLICY.coarse_step) -> _TestedHypothesis | None:
        """Simulate one hypothesis; return None if the model cannot follow it."""
        repaired = self.arm.replace(effects=(*self.arm.effects, *hypothesis))
        simulations, _, _ = simulate_records(repaired, {self.name: self.record}, step, self.alpha)
        rest = find_channel_faults(self.name, simulations[self.name]) if self.name in simulations else []
        if not rest:
            return None
        known = {each.key for each in self.channels or () if each.name}
        new = any(each.name and each.key not in known for each in rest)
        repairs = (
            not new and np.mean([not (each.name or each.unexplained) for each in rest]) >= POLICY.min_repaired
        )
        price = total_cost(rest) - POLICY.prior_log_odds + POLICY.clear_log_odds * (len(hypothesis) - 1)
        return _TestedHypothesis(hypothesis, rest, price, bool(repairs))

    def screened(self, hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
        """Return the hypotheses to be simulated, the likely ones first.

        Kinematic signals that a drive moves must cost the rigid arm less. A drive that moves none of them,
        while others are moved, is at fault only if it goes beyond the usual range of joints. Factors near the
        best one stay: a soft arm moves farther than a rigid one.
        """
        as_recorded = self.rigid_cost(())
        if as_recorded is None:
            return list(hypotheses)
        shown = kinematic_signals(self.record).values()
        costs: list[tuple[float, Hypothesis]] = []
        for hypothesis in hypotheses:
            drives = [self.record.signals[effect.at] for effect in hypothesis]
            if not any(is_moved_by(self.arm, str(d.joint), signal) for d in drives for signal in shown):
                if any(relative_range(drive, self.arm) > 1 for drive in drives):
                    costs.append((-inf, hypothesis))
                continue
            cost = self.rigid_cost(hypothesis)
            if cost is not None and cost < as_recorded:
                costs.append((cost, hypothesis))
        costs.sort(key=lambda each: each[0])
        known = [(cost, each) for cost, each in costs if cost > -inf]
        least, best = known[0] if known else (inf, ())
        return [
            each
            for cost, each in costs
            if cost <= least + POLICY.decisive_log_odds or similar_factors(each, best)
        ]

    def rigid_cost(self, hypothesis: Hypothesis) -> float | None:
        """Return the cost of the kinematic channels of the rigid arm, or None if there are none."""
        found = self.rigid_channels(hypothesis)
        return total_cost(found) + POLICY.clear_log_odds * (len(hypothesis) - 1) if found else None

    def rigid_channels(self, hypothesis: Hypothesis = ()) -> list[ChannelFinding]:
        """Return the kinematic channels of the rigid arm under their best hypotheses."""
        repaired = self.arm.replace(effects=(*self.arm.effects, *hypothesis))
        try:
            simulated = rigid_record(repaired, self.record)
        except InvalidParameter:
            return []
        return find_channel_faults(self.name, simulated) if simulated is not None else []

    def log_bayes(self, trial: _TestedHypothesis) -> float:
        """Return the log Bayes factor against the best explanation without the hypothesis."""
        before = total_cost(self.channels) if self.channels is not None else np.inf
        return float(min(before - trial.cost, POLICY.max_log_odds))

    def finding(self, trial: _TestedHypothesis | None) -> DriveFault | None:
        """Return the fault of a hypothesis that repairs the channels, else None."""
        if trial is None or not trial.repairs:
            return None
        values = {}
        for effect in trial.hypothesis:
            gain = _mean_gain(self, effect.at, trial.channels)
            relative = max(POLICY.factor_accuracy, abs(log(gain)))
            values[effect.at] = {
                key: (value, relative * value, unit) for key, value, unit in effect.parameters()
            }
        odd = {each.channel.signal.name for each in trial.channels if each.name or each.unexplained}
        followed = {each.channel.signal.name: None for each in trial.channels}.keys() - odd
        names = [name for name in self.record.signals if name in followed]
        said = describe_hypothesis(self.arm, trial.hypothesis, self.record, names)
        return DriveFault(values, trial.hypothesis[0].name, self.log_bayes(trial), said, trial.channels)


def refuted_drives(arm: Arm, name: str, record: Record) -> set[str]:
    """Return drives beyond the usual range of joints that the rigid arm does not follow, but a fault of them.

    A simulation along them could take minutes, or not end.
    """
    wild = {drive for drive in record.drive if relative_range(record.signals[drive], arm) > 1}
    test = DriveTest(arm, name, record)
    as_recorded = test.rigid_cost(()) if wild else None
    if as_recorded is None:
        return set()
    best = test.screened(drive_hypotheses(arm, record, None))[:1]
    costs = [cost for each in best if (cost := test.rigid_cost(each)) is not None]
    return wild if any(cost < as_recorded - POLICY.decisive_log_odds for cost in costs) else set()


def exchanged_drives(arm: Arm, name: str, record: Record) -> str | None:
    """Return a doubt about two drives with which the rigid arm moves as measured if exchanged, or None."""
    before = DriveTest(arm, name, record).rigid_channels()
    if not any(each.name or each.unexplained for each in before):
        return None
    found = []
    for one, other in combinations((record.signals[drive] for drive in record.drive), 2):
        if one.unit == other.unit:
            swapped = {one.name: one.replace(joint=other.joint), other.name: other.replace(joint=one.joint)}
            exchanged = record.replace(signals={**record.signals, **swapped})
            after = DriveTest(arm, name, exchanged).rigid_channels()
            if after and not any(each.name or each.unexplained for each in after):
                found.append((total_cost(after), one.name, other.name))
    if not found or min(found)[0] > total_cost(before) - POLICY.decisive_log_odds:
        return None
    _, *drives = min(found)
    return f"{name}: the arm follows {' and '.join(drives)} far better exchanged: is each that of its joint?"


def find_drive_fault(test: DriveTest) -> DriveFault | None:
    """Return the best hypothesis on the drives of a record if it may compete with its channels, else None."""
    best: _TestedHypothesis | None = None
    for hypothesis in test.screened(drive_hypotheses(test.arm, test.record, test.channels)):
        plain = best is not None and best.all_in_order and test.log_bayes(best) > POLICY.decisive_log_odds
        if plain and best is not None and not similar_factors(hypothesis, best.hypothesis):
            continue
        if not allows(f"all wrong units and signs of the drives of {test.name} were tried"):
            break
        best = _choose(best, test.simulate(hypothesis))
    for _ in range(POLICY.max_corrections):
        other = _corrected(test, best)
        trial = None if other is None else test.simulate(other)
        if trial is None or _choose(best, trial, POLICY.clear_log_odds) is not trial:
            break
        best = trial
    found = test.finding(best and test.simulate(best.hypothesis, test.step))
    return found if found is not None and found.log_bayes > -POLICY.clear_log_odds else None


def _choose(
    one: _TestedHypothesis | None, other: _TestedHypothesis | None, by: float = 0.0
) -> _TestedHypothesis | None:
    """Return the one that repairs, else the cheaper one; the other must be cheaper by a margin."""
    if one is None or other is None:
        return one or other
    if one.repairs != other.repairs:
        return one if one.repairs else other
    return other if other.cost < one.cost - by else one


def _corrected(test: DriveTest, trial: _TestedHypothesis | None) -> Hypothesis | None:
    """Return the unit error of one drive with the factor (1), or None if its own is as good."""
    factors = unit_factors(trial.hypothesis) if trial is not None else {}
    if trial is None or len(factors) != 1:
        return None
    [(at, factor)] = factors.items()
    gain = _mean_gain(test, at, trial.channels)
    return None if abs(log(gain)) < POLICY.factor_tolerance else (UnitError(at=at, factor=factor / gain),)


def _mean_gain(test: DriveTest, drive: str, found: Sequence[ChannelFinding]) -> float:
    """Return the mean gain (1) of the channels that a drive moves, 1 if none is known."""
    joint = str(test.record.signals[drive].joint)
    fits = [each.channel.fit() for each in found if is_moved_by(test.arm, joint, each.channel.signal)]
    known = [fit for fit in fits if fit.gain > POLICY.min_sigmas * fit.std]
    if not known:
        return 1.0
    weights = [(fit.gain / fit.std) ** 2 for fit in known]
    return exp(float(np.average([log(fit.gain) for fit in known], weights=weights)))  # eq. (1)


def apply_known_fault(test: DriveTest, fault: DriveFault) -> DriveFault | None:
    """Return a drive's fault known from another record if it explains this one as well, else None."""
    if not set(fault.values) <= set(test.record.drive):
        return None
    effects: list[Any] = [
        read_effect({"name": fault.name, "at": at, **{key: value for key, (value, _, _) in values.items()}})
        for at, values in fault.values.items()
    ]
    found = test.finding(test.simulate(tuple(effects), test.step))
    return found if found is not None and found.log_bayes > 0 else None
