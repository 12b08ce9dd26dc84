"""The gap from the nominal to the repaired model, an effect at a time: what each brings.

What a repair does to the gap: records before and after it, where the gap lies, what each effect brings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.effect import Effect
from flexarm.comparison.aligned_record import AlignedRecord, simulate_record
from flexarm.comparison.compare import comparison_of
from flexarm.comparison.comparison import Comparison
from flexarm.diagnosis.candidate import Candidate, springs_first, with_members
from flexarm.named_effects import Stage, place_text
from flexarm.record import Record
from flexarm.residual_analysis.free_decay import describe_free_decays, free_decays
from flexarm.residual_analysis.localisation import Localisation, localise
from flexarm.residual_analysis.noise_floor import noise_floor
from flexarm.residual_analysis.unexplained import unexplained_residual
from flexarm.threads import at_once

Gaps = Mapping[str, Comparison]
"""A model beside each record."""


def main_signal(records: Mapping[str, Record], before: Gaps) -> str:
    """Return the signal of the report's gap: of positions the one that moves most, else the one that misses
    most.
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
    beside: Callable[[Arm], Gaps],
    arm: Arm,
    updated: Arm,
    encoders: Iterable[Effect],
    members: Iterable[Candidate],
    main: str,
    before: Gaps,
    after: Gaps,
) -> tuple[Stage, ...]:
    """Rms gap of the main signal by record, of each model on the way.

    Parameters
    ----------
    beside : callable
        A model beside all records.
    arm, updated : Arm
        The nominal and the repaired model.
    encoders : iterable of Effect
        Steps of encoders that were seen in the readings; with them drives are smoothed more.
    members : iterable of Candidate
        The effects that were found; the repaired model need not have them.
    main : str
        The signal.
    before, after : dict of str to Comparison
        The nominal and the repaired model beside all records.
    """
    found = [Stage("nominal", _rms(before, main))]
    model = arm
    for effect in encoders:
        model = model.with_effect(effect)
        found.append(Stage(f"{effect.name} at {effect.at}", _rms(beside(model), main)))
    if updated.effects != model.effects:
        for member in springs_first(members):
            model = with_members(model, [member])
            found.append(Stage(f"{member.name} at {place_text(member.at)}", _rms(beside(model), main)))
    if updated != arm:
        found.append(Stage("nominal values refined", _rms(after, main)))
    return tuple(found)


def _rms(found: Gaps, signal: str) -> dict[str, float]:
    return {
        name: float(c.signals[signal].rms["total"] or 0.0) for name, c in found.items() if signal in c.signals
    }


@dataclass(frozen=True)
class Bench:
    """Records to try models on.

    Attributes
    ----------
    training, held_out : dict of str to Record
        What was fitted, and what was not.
    step, alpha : float
        Of the simulations [s], [-].
    jobs : int
        Simulations at once.
    """

    training: Mapping[str, Record]
    held_out: Mapping[str, Record]
    step: float
    alpha: float
    jobs: int

    def in_training(self, model: Arm) -> Gaps:
        """Return the gap of a model by record that was fitted."""
        return compared(self._aligned(model, self.training))

    def in_all(self, model: Arm, before: Gaps | None = None) -> Gaps:
        """Return the same by any record, in the bands of another model's gaps where they are given."""
        return compared(self.aligned(model), before)

    def aligned(self, model: Arm) -> dict[str, AlignedRecord]:
        """Return a model beside each record, sample by sample."""
        return self._aligned(model, {**self.training, **self.held_out})

    def _aligned(self, model: Arm, records: Mapping[str, Record]) -> dict[str, AlignedRecord]:
        simulated = partial(simulate_record, model, step=self.step, alpha=self.alpha)
        return dict(zip(records, at_once(simulated, records.values(), self.jobs), strict=True))


def compared(pairs: Mapping[str, AlignedRecord], before: Gaps | None = None) -> Gaps:
    """Return the gap of each record that a model was simulated beside, in the bands of `before`."""
    return {name: comparison_of(pair, other=(before or {}).get(name)) for name, pair in pairs.items()}


@dataclass(frozen=True, eq=False)
class Verified:
    """A repair beside all records.

    Attributes
    ----------
    before, after : dict of str to Comparison
        The nominal and the repaired model by record.
    main_signal : str
        The signal of the report's gap.
    stages : tuple of Stage
        Its gap, an effect at a time.
    located, located_after : Localisation or None
        Where the gap of the training lies; None where motions and poses are mixed.
    remainder : str
        What is seen of a gap that stays open.
    remarks : tuple of str
        Records of which most of a gap is aligned away; where the simulation is not clearly better than data.
    """

    before: Gaps
    after: Gaps
    main_signal: str
    stages: tuple[Stage, ...]
    located: Localisation | None
    located_after: Localisation | None
    remainder: str
    remarks: tuple[str, ...]


def verified(
    bench: Bench,
    arm: Arm,
    updated: Arm,
    encoders: Sequence[Effect],
    members: Sequence[Candidate],
    open_gap: bool,
) -> Verified:
    """Return the nominal and the repaired model beside all records.

    Parameters
    ----------
    bench : Bench
        The records.
    arm, updated : Arm
        The two models.
    encoders : sequence of Effect
        Steps of encoders that were seen in their readings.
    members : sequence of Candidate
        The effects that were chosen.
    open_gap : bool
        Whether what is left is to be described.
    """
    runs, runs_after = bench.aligned(arm), bench.aligned(updated)
    before = compared(runs)
    after = compared(runs_after, before)
    main = main_signal(bench.training, before)
    pairs, pairs_after = ({name: found[name] for name in bench.training} for found in (runs, runs_after))
    located_after = _located(pairs_after)
    return Verified(
        before,
        after,
        main,
        stages(bench.in_all, arm, updated, encoders, members, main, before, after),
        _located(pairs),
        located_after,
        _remainder(pairs, located_after) if open_gap else "",
        (
            *(f"{name}: {said}" for name, gap in after.items() for said in gap.aligned.overfitted),
            *noise_floor(pairs_after, step=bench.step, alpha=bench.alpha).notes,
        ),
    )


def _located(pairs: Mapping[str, AlignedRecord]) -> Localisation | None:
    kinds = {pair.record.kind for pair in pairs.values()}
    return localise(pairs) if len(kinds) == 1 else None


def _remainder(before: Mapping[str, AlignedRecord], after: Localisation | None) -> str:
    """Return what is seen of a gap that stays open, in what is left and in how the machine rings down."""
    left = unexplained_residual(after) if after else None
    swings = describe_free_decays(free_decays(before))
    return " ".join(said for said in (str(left or ""), swings) if said)
