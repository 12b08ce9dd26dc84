r"""What a channel looks like, as competing hypotheses about its sensor.

A hypothesis H (in order; flipped; in another unit; dead; cut off) leaves a scatter m_H of the N independent
samples. With an unknown scale (Jeffreys' prior) its likelihood is proportional to m_H^{-N}, so that against
a sensor that is in order

.. math:: \ln B_H = N \ln(m_{in order}/m_H) + \ln\text{prior}_H                                       (1)

Whether the channels or the drive are at fault is a question to all of them. Each explanation costs, summed
over the channels,

.. math:: N \ln \max(left, least) + \tfrac12 \sum_j a_j^2/S_j^2 - \ln\text{prior}                    (2)

with what it leaves and how far it strains what is no fault (`validation.regression`). `least` is that of the
readings and the same for all explanations: were it a share of the motion that each one claims, a sensor that
is said to show a thousandth of a wild motion would explain quiet readings better than the truth does.

Source: [Gregory2005], chapter 9: marginalising a scale parameter.

The outcome of a check: sensor faults, outliers that were removed, remarks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import log
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.measurement.outliers import listed
from flexarm.named_effects import NamedEffect
from flexarm.validation.channel import Channel
from flexarm.validation.regression import independent
from flexarm.wording import with_unit

if TYPE_CHECKING:
    from flexarm.arm.effect import Effect
    from flexarm.record import Record


PRIOR = log(1e-3)
"""Of a channel to be at fault, in (1)."""
NOTHING = 1e-12
"""What is left at least: readings and prediction may both stand at 0 [SI]."""


@dataclass(frozen=True, eq=False)
class Finding:
    """One channel under its best hypothesis.

    Attributes
    ----------
    channel : Channel
        Which.
    name : str
        Of the fault, empty if in order.
    log_bayes : float
        (1).
    cost : float
        (2) of the best hypothesis, less its prior; to compare explanations of all channels by.
    values : dict of str to (value, std, unit)
        The fault's parameters.
    sentence : str
        For a person: how, by how much.
    strange : bool
        Whether no hypothesis explains what the channel shows.
    frozen : tuple of int
        Rows of the signal that repeat a value; too few for a fault.
    """

    channel: Channel
    name: str = ""
    log_bayes: float = 0.0
    cost: float = 0.0
    values: Mapping[str, tuple[float, float, str]] = field(default_factory=dict)
    sentence: str = ""
    strange: bool = False
    frozen: tuple[int, ...] = ()

    @property
    def key(self) -> tuple[str, str, str]:
        """Fault, signal and channel."""
        return self.name, self.channel.signal.name, self.channel.name


def log_bayes(count: int, before: float, after: float) -> float:
    """(1)."""
    if not before > 0:
        return PRIOR  # there was nothing to explain
    return independent(count) * float(np.log(before / after)) + PRIOR


def cost(channel: Channel, left: float, strain: float = 0.0) -> float:
    """(2) of a hypothesis that leaves so much, and strains what is no fault by so much."""
    return independent(len(channel.rows)) * float(np.log(max(left, channel.least, NOTHING))) + strain


def cost_of_all(found: Sequence[Finding]) -> float:
    """(2) of all channels; those of one sensor that have one fault share its prior."""
    named = [(each.name, each.channel.signal.name) for each in found if each.name]
    return sum(each.cost for each in found) + PRIOR * (len(named) - len(set(named)))


@dataclass(frozen=True)
class Fault(NamedEffect):
    """A sensor whose data cannot be used: a `dead_channel`, `sign_error`, `unit_error` or `saturation`.

    Attributes
    ----------
    channels : tuple of str
        Which, as `flexarm.arm.sensor_effect.ChannelEffect` names them; empty: all.
    records : tuple of str
        Names of the records that show it.
    """

    channels: tuple[str, ...] = ()
    records: tuple[str, ...] = ()

    def effect(self) -> Effect:
        """The effect that a model needs to see what the sensor showed."""
        from flexarm.arm.effect import read_effect

        table: dict[str, Any] = {"name": self.name, "at": self.at}
        if self.channels:
            table["channels"] = list(self.channels)
        return read_effect({**table, **{each.name: each.value for each in self.parameters}})


@dataclass(frozen=True)
class Removed:
    """Outliers that were taken out of a signal.

    Attributes
    ----------
    record, signal : str
        Where.
    rows : tuple of int
        Rows of the signal, counted from 0, whose values are now NaN.
    size : float
        Root mean square of how far off they were [unit].
    unit : str
        SI unit of the signal.
    poses : tuple of str
        The pose of each row of a static record.
    """

    record: str
    signal: str
    rows: tuple[int, ...]
    size: float
    unit: str
    poses: tuple[str, ...] = ()

    def __str__(self) -> str:
        count = f"{len(self.rows)} outlier{'s' * (len(self.rows) > 1)}"
        size = with_unit(self.size, self.unit)
        poses = f" ({listed(self.poses, 'pose')})" if self.poses else ""
        return f"{count} of {self.signal} in {self.record}, {listed(self.rows)}{poses}, {size} off, removed"


@dataclass(frozen=True, eq=False, repr=False)
class Checked:
    """What `check` found.

    Attributes
    ----------
    records : dict of str to Record
        The records without outliers and without rows that repeat a frozen value.
    faults : tuple of Fault
        Sensors whose data contradict the rest, most probable first; empty: the data can be used.
    outliers : tuple of Removed
        What was taken out of the records.
    remarks : tuple of str
        What a person should know: clocks that jump, pauses, scatter unlike the stated noise, records that
        contradict each other.
    compared : dict of str to tuple of str
        By record the signals that the model predicts; a record that has none cannot be compared at all.
    doubts : tuple of str
        Values that no sensor of this arm shows, models that cannot be simulated: what stands against a
        judgement of the sensors.
    """

    records: Mapping[str, Record]
    faults: tuple[Fault, ...] = ()
    outliers: tuple[Removed, ...] = ()
    remarks: tuple[str, ...] = field(default=())
    compared: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    doubts: tuple[str, ...] = ()

    @property
    def usable(self) -> bool:
        """Whether no sensor is at fault."""
        return not self.faults

    @property
    def judged(self) -> bool:
        """Whether sensors were laid beside a model that nothing is doubted of."""
        return not self.doubts and (not self.compared or any(self.compared.values()))

    def comparable(self) -> dict[str, Record]:
        """The records that something can be compared of; all of them if that is true of none."""
        found = {name: record for name, record in self.records.items() if self.compared.get(name, True)}
        return found or dict(self.records)

    def summary(self) -> str:
        """The same for a person to read."""
        count = f"{len(self.records)} record{'s' * (len(self.records) != 1)}"
        lines = [f"{count} checked: {self._verdict()}"]
        lines += [f"  doubt: {doubt}" for doubt in self.doubts] if self.usable else []
        for fault in self.faults:
            where = ", ".join(fault.channels)
            lines.append(
                f"  {fault.name:<14}{fault.at + (f' ({where})' if where else ''):<20}"
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
            return "sensors cannot be judged beside this model until what is doubted is mended"
        if not self.judged:
            return "no sensor can be judged: nothing is compared with the model"
        return "no sensor is at fault"

    def __repr__(self) -> str:
        return self.summary()
