"""The gap from the nominal to the repaired model, an effect at a time: what each brings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.effect import Effect
from flexarm.comparison.comparison import Comparison
from flexarm.diagnosis.at_once import at_once
from flexarm.diagnosis.candidates.candidate import Candidate, springs_first, with_members
from flexarm.diagnosis.named import Stage
from flexarm.record import Record

Gaps = Mapping[str, Comparison]
"""A model beside each record."""


def gaps(
    compared: Callable[[Arm, Record], Comparison], model: Arm, records: Mapping[str, Record], jobs: int = 1
) -> Gaps:
    """A model beside records, `jobs` at once."""
    found = at_once(partial(compared, model), records.values(), jobs)
    return dict(zip(records, found, strict=True))


def main_signal(records: Mapping[str, Record], before: Gaps) -> str:
    """The signal of the report's gap: of positions the one that moves most, else the one that misses most."""
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
            found.append(Stage(f"{member.name} at {member.at}", _rms(beside(model), main)))
    if updated != arm:
        found.append(Stage("nominal values refined", _rms(after, main)))
    return tuple(found)


def _rms(found: Gaps, signal: str) -> dict[str, float]:
    return {
        name: float(c.signals[signal].rms["total"] or 0.0) for name, c in found.items() if signal in c.signals
    }
