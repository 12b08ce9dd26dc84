r"""Evidence for faults of channels, and the result of a validation.

A hypothesis H (in order, sign error, unit error, dead, saturated) leaves a scatter m_H of the N independent
samples. With an unknown scale (Jeffreys' prior) its likelihood is proportional to m_H^{-N}. Against a channel
in order its log Bayes factor, with the prior odds, is

.. math:: \ln B_H = N \ln(m_{in order}/m_H) + \ln\text{prior}_H                                       (1)

Channels or the drive may be at fault. Each explanation has a cost, summed over the channels,

.. math:: N \ln \max(rms, least) + \tfrac12 \sum_j a_j^2/S_j^2 - \ln\text{prior}                     (2)

with the rms residual and the penalty of the nuisance regressors (`validation.channel`). The least scatter
is a share of the motion that the readings show, and so the same for all explanations. A share of the motion
that an explanation claims would favour small readings of large motions.

Findings of all records are merged by sensor.

Source: [Gregory2005], chapter 9: marginalising a scale parameter.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import exp
from typing import Any

import numpy as np

from flexarm.arm.effect import Effect, read_effect
from flexarm.comparison.drive_outliers import RemovedOutliers
from flexarm.named_effects import Alternative, Estimate, NamedEffect, place_text
from flexarm.pictures import Summarised
from flexarm.quantities import channel_names
from flexarm.record import Record
from flexarm.validation.channel import Channel, independent_samples
from flexarm.validation.policy import POLICY
from flexarm.wording import listed

NOTHING = 1e-12
"""Least scatter: readings and prediction may both be 0 [SI]."""


@dataclass(frozen=True, eq=False)
class ChannelFinding:
    """Hold one channel under its best hypothesis."""

    channel: Channel
    """The channel."""
    name: str = ""
    """Name of the fault, empty if in order."""
    log_bayes: float = 0.0
    """(1)."""
    cost: float = 0.0
    """(2) of the best hypothesis, less its prior."""
    values: Mapping[str, tuple[float, float, str]] = field(default_factory=dict)
    """The fault's parameters."""
    sentence: str = ""
    """Description of the fault."""
    unexplained: bool = False
    """True if no hypothesis explains the readings."""
    frozen_rows: tuple[int, ...] = ()
    """Rows of the signal that repeat a value; too few for a fault."""

    @property
    def key(self) -> tuple[str, str, str]:
        """Return fault, signal and channel."""
        return self.name, self.channel.signal.name, self.channel.name


def log_bayes(count: int, before: float, after: float) -> float:
    """Return the log Bayes factor (1)."""
    if not before > 0:
        return POLICY.prior_log_odds  # there was nothing to explain
    return independent_samples(count) * float(np.log(before / after)) + POLICY.prior_log_odds


def cost(channel: Channel, rms: float, penalty: float = 0.0) -> float:
    """Return the cost (2) of a hypothesis from its rms residual and its penalty."""
    left = max(rms, channel.least_scatter, NOTHING)
    return independent_samples(len(channel.rows)) * float(np.log(left)) + penalty


def total_cost(found: Sequence[ChannelFinding]) -> float:
    """Return the cost (2) of all channels; those of one sensor with one fault share its prior."""
    named = [(each.name, each.channel.signal.name) for each in found if each.name]
    return sum(each.cost for each in found) + POLICY.prior_log_odds * (len(named) - len(set(named)))


Values = Mapping[str, tuple[float, float, str]]


@dataclass(frozen=True, eq=False)
class DriveFault:
    """Hold a fault of one drive of a record, or of all alike."""

    values: Mapping[str, Values]
    """Parameters of the faults by drive."""
    name: str
    """Name of the fault."""
    log_bayes: float
    """Against the best explanation without it."""
    sentence: str
    """Description."""
    channels: Sequence[ChannelFinding] = ()
    """The channels, driven by what the drive really was; empty where that is lost."""

    @property
    def key(self) -> tuple[str, tuple[str, ...]]:
        """Return the fault and its drives."""
        return self.name, tuple(self.values)


@dataclass(frozen=True)
class Fault(NamedEffect):
    """Hold a fault of a sensor: a `dead_channel`, `sign_error`, `unit_error` or `saturation`."""

    channels: tuple[str, ...] = ()
    """Channels as `flexarm.arm.sensor_effect.ChannelEffect` names them; empty: all."""
    records: tuple[str, ...] = ()
    """Names of the records that show it."""

    def effect(self) -> Effect:
        """Return the effect by which a model reproduces the fault."""
        table: dict[str, Any] = {"name": self.name, "at": self.at}
        if self.channels:
            table["channels"] = list(self.channels)
        return read_effect({**table, **{each.name: each.value for each in self.parameters}})


@dataclass(frozen=True, eq=False, repr=False)
class ValidationResult(Summarised):
    """Hold the result of `check`."""

    records: Mapping[str, Record]
    """The records without outliers and without rows that repeat a frozen value."""
    faults: tuple[Fault, ...] = ()
    """Faulty sensors, most probable first; empty: the data can be used."""
    outliers: tuple[RemovedOutliers, ...] = ()
    """Rows removed from the records."""
    remarks: tuple[str, ...] = field(default=())
    """Clock steps, pauses, noise unlike the stated one, frames that moved between records."""
    compared: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """By record the signals that the model predicts; a record without any cannot be compared."""
    doubts: tuple[str, ...] = ()
    """Implausible values and models that cannot be simulated, which prevent a judgement of the sensors."""

    @property
    def usable(self) -> bool:
        """Return True if no sensor is at fault."""
        return not self.faults

    @property
    def judged(self) -> bool:
        """Return True if sensors were compared with a model, and nothing is in doubt."""
        return not self.doubts and (not self.compared or any(self.compared.values()))

    def comparable(self) -> dict[str, Record]:
        """Return the records with signals that can be compared; all of them if there are none."""
        found = {name: record for name, record in self.records.items() if self.compared.get(name, True)}
        return found or dict(self.records)

    def summary(self) -> str:
        """Return the result as text."""
        count = f"{len(self.records)} record{'s' * (len(self.records) != 1)}"
        lines = [f"{count} checked: {self._verdict()}"]
        lines += [f"  doubt: {doubt}" for doubt in self.doubts] if self.usable else []
        for fault in self.faults:
            where = ", ".join(fault.channels)
            lines.append(
                f"  {fault.name:<14}{place_text(fault.at) + (f' ({where})' if where else ''):<20}"
                f"probability {fault.probability:.3f}   in {', '.join(fault.records)}"
            )
            lines += [
                f"    {each.name} = {each.value:.5g} +- {each.std:.2g} {each.unit}"
                for each in fault.parameters
            ]
            lines.append(f"    {fault.evidence}")
            lines += [
                f"    or {other.name} at {other.at} (probability {other.probability:.2f})"
                for other in fault.alternatives
            ]
        lines += [f"  {removed}" for removed in self.outliers]
        lines += [f"  note: {remark}" for remark in self.remarks]
        return "\n".join(lines)

    def _verdict(self) -> str:
        if self.faults:
            return "data are unusable"
        if self.doubts:
            return "sensors cannot be judged with this model until what is doubted is mended"
        if not self.judged:
            return "no sensor can be judged: nothing is compared with the model"
        return "no sensor is at fault"


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
    values: Values
    sentence: str
    alternative: DriveFault | None = None


def merge_findings(all_findings: Sequence[RecordFindings]) -> tuple[Fault, ...]:
    """Return faults by sensor, most probable first."""
    sure = {v.drive.key for v in all_findings if v.drive and not v.ambiguous}
    all_findings = [
        replace(v, ambiguous=False, channels=v.drive.channels)
        if v.drive and v.ambiguous and v.drive.key in sure
        else v
        for v in all_findings
    ]
    items = [item for findings in all_findings for item in _items(findings)]
    best: dict[tuple[str, str], _FaultEvidence] = {}  # by channel: one fault each, that of the highest odds
    for item in items:
        channel = item.at, item.channel
        if channel not in best or item.log_odds > best[channel].log_odds:
            best[channel] = item
    by_fault: dict[tuple[str, str], list[_FaultEvidence]] = {}
    for item in items:
        if item.name == best[item.at, item.channel].name:
            by_fault.setdefault((item.name, item.at), []).append(item)
    found = [_fault(alike) for each in by_fault.values() for alike in _split_by_value(each)]
    return tuple(sorted(found, key=lambda fault: -fault.probability))


def _split_by_value(items: list[_FaultEvidence]) -> list[list[_FaultEvidence]]:
    """Return the findings of one name at one signal, channels apart that stop at other values.

    Factors are of the sensor as a whole: what its channels differ by there is the model's error.
    """
    groups: list[list[_FaultEvidence]] = []
    for item in items:
        group = next(
            (g for g in groups if any(item.channel == o.channel or _agree(item, o) for o in g)), None
        )
        if group is None:
            groups.append(group := [])
        group.append(item)
    return groups


def _agree(one: _FaultEvidence, other: _FaultEvidence) -> bool:
    pairs = [(one.values[name], other.values[name]) for name in one.values]
    return all(
        (unit == "-" and a * b > 0) or abs(a - b) <= POLICY.min_sigmas * float(np.hypot(s, t))
        for (a, s, unit), (b, t, _) in pairs
    )


def _items(findings: RecordFindings) -> list[_FaultEvidence]:
    """Return the evidence of one record."""
    record, drive = findings.record, findings.drive
    found = [
        _FaultEvidence(
            record,
            each.name,
            each.channel.signal.name,
            each.channel.name,
            channel_names(each.channel.signal.quantity, each.channel.signal.axes),
            each.log_bayes,
            each.values,
            each.sentence,
            drive if findings.ambiguous else None,
        )
        for each in findings.channels
        if each.name
    ]
    if drive is not None and (not findings.ambiguous or not found):
        found += [
            _FaultEvidence(record, drive.name, at, "", ("",), drive.log_bayes, values, drive.sentence)
            for at, values in drive.values.items()
        ]
    return found


def _fault(items: list[_FaultEvidence]) -> Fault:
    """Merge all findings of one name at one signal."""
    first = max(items, key=lambda item: item.log_odds)
    seen = {item.channel for item in items}
    whole = seen == set(first.known)
    channels = () if whole else tuple(name for name in first.known if name in seen)
    probability = float(1 / (1 + exp(-min(first.log_odds, 50.0))))
    alternatives: tuple[Alternative, ...] = ()
    alternative = next((item.alternative for item in items if item.alternative is not None), None)
    if alternative is not None:
        share = 1 / (1 + exp(-alternative.log_bayes))
        alternatives = tuple(
            Alternative(alternative.name, at, probability * share) for at in alternative.values
        )
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
        weights = 1 / np.maximum(pairs[:, 1], 1e-12 * np.abs(pairs[:, 0]).max() + 1e-150) ** 2
        value = float(np.sum(weights * pairs[:, 0]) / np.sum(weights))
        std = float(1 / np.sqrt(np.sum(weights)))
        if len(pairs) > 1:
            std = max(std, float(np.std(pairs[:, 0], ddof=1) / np.sqrt(len(pairs))))
        found.append(Estimate.normal(name, value, std, unit))
    return tuple(found)


def _sentence(items: list[_FaultEvidence], first: _FaultEvidence) -> str:
    """Return the most probable sentence, and the places of which the same holds."""
    others = [item for item in items if (item.record, item.sentence) != (first.record, first.sentence)]
    more = dict.fromkeys(
        f"{item.at} {item.channel}".rstrip() + (f" in {item.record!r}" if item.record != first.record else "")
        for item in others
    )
    same = f"; the same holds for {listed(list(more))}" if more else ""
    return f"in record {first.record!r} {first.sentence}{same}."
