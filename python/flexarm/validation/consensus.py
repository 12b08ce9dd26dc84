"""Faults of sensors, merged from the findings of all records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp

import numpy as np

from flexarm.named_effects import Alternative, Estimate
from flexarm.quantities import channel_names
from flexarm.validation.drive_faults import DriveFault
from flexarm.validation.finding import ChannelFinding, Fault
from flexarm.wording import listed


@dataclass(frozen=True, eq=False)
class RecordFindings:
    """Hold the findings of one record."""

    record: str
    """Its name."""
    channels: Sequence[ChannelFinding] = ()
    """Its channels."""
    drive: DriveFault | None = None
    """A drive at fault."""
    ambiguous: bool = False
    """True if the drive explains no more than the channels do: either may be at fault."""


@dataclass(frozen=True, eq=False)
class _FaultEvidence:
    """Hold one finding of a channel or drive as evidence for a fault."""

    record: str
    name: str
    at: str
    channel: str
    known: tuple[str, ...]
    log_odds: float
    values: dict[str, tuple[float, float, str]]
    sentence: str
    rival: DriveFault | None = None


def merge_findings(all_findings: Sequence[RecordFindings]) -> tuple[Fault, ...]:
    """Return faults by sensor, most probable first."""
    all_findings = _resolve_ambiguous(all_findings)
    items = _one_fault_per_channel([item for findings in all_findings for item in _items(findings)])
    keys = dict.fromkeys((item.name, item.at) for item in items)
    faults = [_fault([item for item in items if (item.name, item.at) == key]) for key in keys]
    return tuple(sorted(faults, key=lambda fault: -fault.probability))


def _resolve_ambiguous(all_findings: Sequence[RecordFindings]) -> list[RecordFindings]:
    """Resolve an ambiguous record by one that clearly shows the same fault of the drive."""
    sure = {v.drive.key for v in all_findings if v.drive and not v.ambiguous}
    return [
        replace(v, ambiguous=False, channels=v.drive.channels)
        if v.drive and v.ambiguous and v.drive.key in sure
        else v
        for v in all_findings
    ]


def _one_fault_per_channel(items: list[_FaultEvidence]) -> list[_FaultEvidence]:
    """Keep one fault for each channel, that of the record with the highest odds."""
    best: dict[tuple[str, str], _FaultEvidence] = {}
    for item in items:
        key = item.at, item.channel
        if key not in best or item.log_odds > best[key].log_odds:
            best[key] = item
    return [item for item in items if item.name == best[item.at, item.channel].name]


def _items(findings: RecordFindings) -> list[_FaultEvidence]:
    """Return the evidence of one record."""
    drive = findings.drive
    found = []
    for each in findings.channels:
        if each.name:
            signal = each.channel.signal
            rival = drive if findings.ambiguous else None
            known = channel_names(signal.quantity, signal.axes)
            found.append(
                _FaultEvidence(
                    findings.record,
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
    if drive is not None and (not findings.ambiguous or not found):
        for at, values in drive.values.items():
            item = findings.record, drive.name, at, "", ("",), drive.log_bayes, dict(values), drive.sentence
            found.append(_FaultEvidence(*item))
    return found


def _fault(items: list[_FaultEvidence]) -> Fault:
    """Merge all findings of one name at one signal."""
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


def _estimates(items: list[_FaultEvidence]) -> tuple[Estimate, ...]:
    """Return means of all records, weighted by inverse variances, with 90 % intervals."""
    found = []
    for name, (_, _, unit) in items[0].values.items():
        pairs = np.array([item.values[name][:2] for item in items if name in item.values])
        weights = 1 / np.maximum(pairs[:, 1], 1e-12 * np.abs(pairs[:, 0]).max() + 1e-300) ** 2
        value = float(np.sum(weights * pairs[:, 0]) / np.sum(weights))
        std = float(1 / np.sqrt(np.sum(weights)))
        if len(pairs) > 1:
            std = max(std, float(np.std(pairs[:, 0], ddof=1) / np.sqrt(len(pairs))))
        found.append(Estimate.normal(name, value, std, unit))
    return tuple(found)


def _sentence(items: list[_FaultEvidence], first: _FaultEvidence) -> str:
    """Return the most probable sentence, and the places of which the same holds."""
    others = [item for item in items if item is not first]
    more = dict.fromkeys(
        f"{item.at} {item.channel}".rstrip() + (f" in {item.record!r}" if item.record != first.record else "")
        for item in others
    )
    same = f"; the same holds for {listed(list(more))}" if more else ""
    return f"in record {first.record!r} {first.sentence}{same}."
