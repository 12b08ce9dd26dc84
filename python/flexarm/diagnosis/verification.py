"""The updated model, its verification against all records, and the gap from one model to the other.

The updated model is the nominal one with refined values and the effects that were found. Effects that explain
all are kept. Where a gap is left, they are kept if they halve the cross-validated residual, or predict each
part of the training from the others (`diagnosis.cross_validation`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import log10

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.effect import Effect
from flexarm.arm.parameter import with_value
from flexarm.comparison.aligned_record import AlignedRecord, simulate_record
from flexarm.comparison.compare import comparison_of
from flexarm.comparison.comparison import Comparison
from flexarm.diagnosis.candidate import Candidate, springs_first, with_members
from flexarm.diagnosis.cross_validation import cross_validated_skill, press_rms
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.selection import Choice
from flexarm.diagnosis.uncertainty import Estimates
from flexarm.errors import InvalidParameter
from flexarm.named_effects import Stage, place_text
from flexarm.record import Record
from flexarm.residual_analysis.free_decay import describe_free_decays, free_decays
from flexarm.residual_analysis.localisation import Localisation, localise
from flexarm.residual_analysis.noise_floor import noise_floor
from flexarm.residual_analysis.unexplained import unexplained_residual
from flexarm.threads import at_once


def repaired(arm: Arm, fit: Fit, sizes: Estimates) -> Arm:
    """Return the nominal model with refined values and the effects of a fit.

    Values are rounded, but where a rounded one would be beyond the limit of what is allowed.
    """
    for refined in (each for each in sizes.refined if each.changed):
        try:
            arm = with_value(arm, refined.parameter, rounded_to_std(refined.value, refined.std))
        except InvalidParameter:
            arm = with_value(arm, refined.parameter, refined.value)
    found = dict(zip(fit.places, sizes.effects, strict=True))
    for member in springs_first(fit.members):
        values = {each.name: each.value for each in found[member.place]}
        rounded = {each.name: rounded_to_std(each.value, each.std) for each in found[member.place]}
        try:
            arm = member.with_parameters(rounded).enter(arm)
        except InvalidParameter:
            arm = member.with_parameters(values).enter(arm)
    return arm


def rounded_to_std(value: float, std: float) -> float:
    """Return a value to a thousandth of its standard deviation, so that files do not feign more."""
    return value if not std > 0 else round(value, 3 - int(np.floor(log10(std))))


def worth_keeping(choice: Choice, problem: Problem) -> bool:
    """Return True if a fit that does not explain all is better than none: it closes half, or it predicts."""
    if not choice.best.members:
        return False
    best, null = choice.best, choice.null
    if press_rms(best, problem) < (1 - problem.policy.halfway) * press_rms(null, problem):
        return True
    return (
        cross_validated_skill(best, null, choice.estimator.nominal_residual(), problem)
        > problem.policy.predictive_share
    )


Gaps = Mapping[str, Comparison]
"""Comparison by record."""


def main_signal(records: Mapping[str, Record], before: Gaps) -> str:
    """Return the signal of the report's gap: the position that moves most, else the signal with the largest
    gap.
    """
    travel: dict[str, float] = {}
    misses: dict[str, float] = {}
    for name, record in records.items():
        for signal, gap in before[name].evidence.items():
            values = record.signals[signal].values
            if gap.quantity == "position":
                spread = float(np.nansum(np.nanvar(values, axis=0)))
                travel[signal] = max(travel.get(signal, 0.0), spread)
            misses[signal] = max(misses.get(signal, 0.0), (gap.rms["total"] or 0.0) / (gap.noise_rms or 1.0))
    chosen = travel or misses
    return max(chosen, key=lambda signal: chosen[signal]) if chosen else ""


def stages(
    gaps_of: Callable[[Arm], Gaps],
    arm: Arm,
    updated: Arm,
    encoders: Iterable[Effect],
    members: Iterable[Candidate],
    main: str,
    before: Gaps,
    after: Gaps,
) -> tuple[Stage, ...]:
    """Return the rms gap of the `main` signal by record, for the models from nominal to updated.

    `gaps_of` compares a model with all records. `encoders` are steps that were seen in readings; with them
    drives are smoothed more. `members` are the effects that were found; the updated model need not have them.
    `before` and `after` are the gaps of the nominal and the updated model.
    """
    found = [Stage("nominal", _rms(before, main))]
    model = arm
    for effect in encoders:
        model = model.with_effect(effect)
        found.append(Stage(f"{effect.name} at {effect.at}", _rms(gaps_of(model), main)))
    if updated.effects != model.effects:
        for member in springs_first(members):
            model = with_members(model, [member])
            found.append(Stage(f"{member.name} at {place_text(member.at)}", _rms(gaps_of(model), main)))
    if updated != arm:
        found.append(Stage("nominal values refined", _rms(after, main)))
    return tuple(found)


def _rms(found: Gaps, signal: str) -> dict[str, float]:
    return {
        name: float(c.signals[signal].rms["total"] or 0.0) for name, c in found.items() if signal in c.signals
    }


@dataclass(frozen=True)
class SplitRecords:
    """Records of a training and held-out ones, with which models are compared."""

    training: Mapping[str, Record]
    held_out: Mapping[str, Record]
    """Records that were fitted, and those that were not."""
    step: float
    alpha: float
    """Settings of the simulations [s], [-]."""
    jobs: int
    """Simulations at once."""
    _kept: dict[tuple[Arm, str], AlignedRecord] = field(default_factory=dict, init=False, repr=False)

    def training_gaps(self, model: Arm) -> Gaps:
        """Return the gap of a model by record that was fitted."""
        return compared(self._aligned(model, self.training))

    def gaps(self, model: Arm, before: Gaps | None = None) -> Gaps:
        """Return the same by any record, in the bands of another model's gaps where they are given."""
        return compared(self.aligned(model), before)

    def aligned(self, model: Arm) -> dict[str, AlignedRecord]:
        """Return the aligned simulation of each record by a model."""
        return self._aligned(model, {**self.training, **self.held_out})

    def _aligned(self, model: Arm, records: Mapping[str, Record]) -> dict[str, AlignedRecord]:
        def aligned(name: str) -> AlignedRecord:
            if (model, name) not in self._kept:
                self._kept[model, name] = simulate_record(
                    model, records[name], step=self.step, alpha=self.alpha
                )
            return self._kept[model, name]

        return dict(zip(records, at_once(aligned, records, self.jobs), strict=True))


def compared(pairs: Mapping[str, AlignedRecord], before: Gaps | None = None) -> Gaps:
    """Return the gap of each simulated record, in the bands of `before`."""
    return {name: comparison_of(pair, other=(before or {}).get(name)) for name, pair in pairs.items()}


@dataclass(frozen=True, eq=False)
class Verification:
    """Comparison of nominal and updated model with all records."""

    before: Gaps
    after: Gaps
    """The nominal and the repaired model by record."""
    main_signal: str
    """The signal of the report's gap."""
    stages: tuple[Stage, ...]
    """Its gap, an effect at a time."""
    located: Localisation | None
    located_after: Localisation | None
    """Localisation of the gap of the training; None where motions and poses are mixed."""
    remainder: str
    """Description of an unexplained gap."""
    remarks: tuple[str, ...]
    """Records of which most of a gap is aligned away; where the simulation is not clearly better than data.
    """


def verified(
    records: SplitRecords,
    arm: Arm,
    updated: Arm,
    encoders: Sequence[Effect],
    members: Sequence[Candidate],
    open_gap: bool,
) -> Verification:
    """Return the comparison of nominal and updated model with all records.

    `encoders` are steps of encoders that were seen in readings, `members` the chosen effects. If the gap is
    open the remainder is described.
    """
    runs, runs_after = records.aligned(arm), records.aligned(updated)
    before = compared(runs)
    after = compared(runs_after, before)
    main = main_signal(records.training, before)
    pairs, pairs_after = ({name: found[name] for name in records.training} for found in (runs, runs_after))
    located_after = _located(pairs_after)
    remainder = ""
    if open_gap:
        left = unexplained_residual(located_after) if located_after else None
        swings = describe_free_decays(free_decays(pairs))
        remainder = " ".join(said for said in (str(left or ""), swings) if said)
    return Verification(
        before,
        after,
        main,
        stages(records.gaps, arm, updated, encoders, members, main, before, after),
        _located(pairs),
        located_after,
        remainder,
        (
            *(f"{name}: {said}" for name, gap in after.items() for said in gap.aligned.overfitted),
            *noise_floor(pairs_after, step=records.step, alpha=records.alpha).notes,
        ),
    )


def _located(pairs: Mapping[str, AlignedRecord]) -> Localisation | None:
    kinds = {pair.record.kind for pair in pairs.values()}
    return localise(pairs) if len(kinds) == 1 else None
