"""The noise of a held-out record that states none, where the training knows it of the same signal.

Without a noise a signal aligns no clock and no frame, and its gap stands beside nothing: a tracker that is a
millisecond late then looks as if the model foretold nothing. Who measured both records with one sensor stated
its noise once. Where records of the training state several, the greatest counts.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from flexarm.comparison.unknowns import movable
from flexarm.diagnosis.wording import listed, with_unit

if TYPE_CHECKING:
    from flexarm.record import Record, Signal


def with_noise_of(
    training: Mapping[str, Record], held_out: Mapping[str, Record]
) -> tuple[dict[str, Record], list[str]]:
    """The held-out records with the noise of signals of the training, and sentences that say so.

    Also said is what a signal without any does not align; of one of the training that is said elsewhere.
    """
    found, said = dict(held_out), []
    for name, record in held_out.items():
        signals = dict(record.signals)
        for signal in record.signals.values():
            if signal.noise_std is None:
                same = _same(training, signal)
                noise = max((each.noise_std for each in same if each.noise_std is not None), default=None)
                signals[signal.name] = signal.replace(noise_std=noise)
                said += _sentences(name, record, signal, noise) if noise is not None or not same else []
        found[name] = record.replace(signals=signals)
    return found, said


def _same(training: Mapping[str, Record], signal: Signal) -> list[Signal]:
    """The signals of that name and quantity."""
    named = [record.signals[signal.name] for record in training.values() if signal.name in record.signals]
    return [each for each in named if each.quantity == signal.quantity]


def _sentences(name: str, record: Record, signal: Signal, noise: float | None) -> list[str]:
    begin = f"{name} states no noise of {signal.name}"
    if noise is not None:
        return [f"{begin}: {with_unit(noise, signal.unit, 2)} count, as the training states it"]
    places = movable(record, signal)
    return [f"{begin}, nor does the training: it does not align {listed(places)}"] if places else []
