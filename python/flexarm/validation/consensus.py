"""What all records say of one sensor, as faults."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp

import numpy as np

from flexarm.named_effects import Alternative, Estimate
from flexarm.quantities import channel_names
from flexarm.validation.drive_faults import DriveFinding
from flexarm.validation.finding import Fault, Finding
from flexarm.wording import listed


@dataclass(frozen=True, eq=False)
class Verdict:
    """What was found in one record.

    Attributes
    ----------
    record : str
        Its name.
    channels : sequence of Finding
        Its channels.
    drive : DriveFinding or None
        A drive at fault.
    tied : bool
        Whether the drive explains no more than the channels do: then either is at fault.
    """

    record: str
    channels: Sequence[Finding] = ()
    drive: DriveFinding | None = None
    tied: bool = False


@dataclass(frozen=True, eq=False)
class _Item:
    """One finding, of a channel or drive, on the way to a fault."""

    record: str
    name: str
    at: str
    channel: str
    known: tuple[str, ...]
    log_odds: float
    values: dict[str, tuple[float, float, str]]
    sentence: str
    rival: DriveFinding | None = None


def merged(verdicts: Sequence[Verdict]) -> tuple[Fault, ...]:
    """Faults by sensor, most probable first."""
    verdicts = _agreed(verdicts)
    items = _one_name([item for verdict in verdicts for item in _items(verdict)])
    keys = dict.fromkeys((item.name, item.at) for item in items)
    faults = [_fault([item for item in items if (item.name, item.at) == key]) for key in keys]
    return tuple(sorted(faults, key=lambda fault: -fault.probability))


def _agreed(verdicts: Sequence[Verdict]) -> list[Verdict]:
    """Where a record leaves open whether its drive is at fault, another one that does not decides."""
    sure = {v.drive.key for v in verdicts if v.drive and not v.tied}
    return [
        replace(v, tied=False, channels=v.drive.rest) if v.drive and v.tied and v.drive.key in sure else v
        for v in verdicts
    ]


def _one_name(items: list[_Item]) -> list[_Item]:
    """A channel has one fault, that of the record that shows it best: a small motion shows little."""
    best: dict[tuple[str, str], _Item] = {}
    for item in items:
        key = item.at, item.channel
        if key not in best or item.log_odds > best[key].log_odds:
            best[key] = item
    return [item for item in items if item.name == best[item.at, item.channel].name]


def _items(verdict: Verdict) -> list[_Item]:
    """Of one record."""
    drive = verdict.drive
    found = []
    for each in verdict.channels:
        if each.name:
            signal = each.channel.signal
            rival = drive if verdict.tied else None
            known = channel_names(signal.quantity, signal.axes)
            found.append(
                _Item(
                    verdict.record,
                    each.name,
                    signal.name,
                    each.channel.name,
                    known,
                    each.log_bayes,
                    dict(each.values),
                    each.sentence,
                    rival,
                )
            )
    if drive is not None and (not verdict.tied or not found):
        for at, values in drive.values.items():
            item = verdict.record, drive.name, at, "", ("",), drive.log_bayes, dict(values), drive.sentence
            found.append(_Item(*item))
    return found


def _fault(items: list[_Item]) -> Fault:
    """All findings of one name at one signal."""
    first = max(items, key=lambda item: item.log_odds)
    seen = {item.channel for item in items}
    whole = seen == set(first.known)
    channels = () if whole else tuple(name for name in first.known if name in seen)
    probability = float(1 / (1 + exp(-min(first.log_odds, 50.0))))
    alternatives: tuple[Alternative, ...] = ()
    rival = next((item.rival for item in items if item.rival is not None), None)
    if rival is not None:
        share = 1 / (1 + exp(-rival.log_bayes))
        alternatives = tuple(Alternative(rival.name, at, probability * share) for at in rival.values)
        probability *= 1 - share
    return Fault(
        first.name,
        first.at,
        probability,
        _estimates(items),
        alternatives,
        _sentence(items, first),
        channels,
        tuple(dict.fromkeys(item.record for item in items)),
    )


def _estimates(items: list[_Item]) -> tuple[Estimate, ...]:
    """Means of all records, weighted by their variances, with 90 % intervals."""
    found = []
    for name, (_, _, unit) in items[0].values.items():
        pairs = np.array([item.values[name][:2] for item in items if name in item.values])
        weights = 1 / np.maximum(pairs[:, 1], 1e-12 * np.abs(pairs[:, 0]).max() + 1e-300) ** 2
        value = float(np.sum(weights * pairs[:, 0]) / np.sum(weights))
        std = float(1 / np.sqrt(np.sum(weights)))
        if len(pairs) > 1:
            std = max(std, float(np.std(pairs[:, 0], ddof=1) / np.sqrt(len(pairs))))
        found.append(Estimate(name, value, std, value - 1.645 * std, value + 1.645 * std, unit))
    return tuple(found)


def _sentence(items: list[_Item], first: _Item) -> str:
    """The clearest one, and which others say the same."""
    others = [item for item in items if item is not first]
    more = dict.fromkeys(
        f"{item.at} {item.channel}".rstrip() + (f" in {item.record!r}" if item.record != first.record else "")
        for item in others
    )
    same = f"; the same holds for {listed(list(more))}" if more else ""
    return f"in record {first.record!r} {first.sentence}{same}."
