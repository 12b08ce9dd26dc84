"""Data left out of a fit: held-out records or blocks, and masked outliers.

**Held-out data.** Without a record of its own, whole blocks of every record are held out: every fifth
twentieth of its time (every fifth pose of a static record). The motion is continuous and its drive is known
throughout, so only evidence is removed from one part and kept in the other. A row at the stamp s lies at

    x = (s - d - first)/(last - first)                                                                 (1)

of the record, with d the stated offset of its clock, and first and last the ends of all signals in that time.
If the offset of a clock is unknown, they are the ends of its own signals.

**Masked outliers.** Before an effect is found, a reading is an outlier only relative to the whole gap
(`validation.outliers`). Given a model that explains the gap the residual is noise, and r_i is an outlier if
it is off the median m_i of its seven neighbours by

    |r_i - m_i| > outlier max(sigma, s),   s = 1.48 median |r - m|                                     (2)

and by more than twice what most rows around it are: one row of white noise in ten millions. Torques,
accelerations and strains jump where teeth strike; only readings beyond twice the range of all others are
outliers there. They are removed if the model is adequate without them, as by a loss that rejects [Huber1981].
Held-out data lose their outliers relative to the updated model.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.assembly.machine import machine_of
from flexarm.comparison.drive_outliers import blank_rows
from flexarm.comparison.pose_outliers import MOST
from flexarm.comparison.poses import is_input
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.problem import Problem
from flexarm.errors import InvalidParameter
from flexarm.measurement.outliers import SMOOTH, beyond_range_of_others, deviation_from_median, nearby
from flexarm.record import Record
from flexarm.validation.finding import ValidationResult
from flexarm.validation.sensor_check import named_records
from flexarm.wording import with_unit

if TYPE_CHECKING:
    from flexarm.record import Signal


BLOCKS, EVERY = 20, 5
"""Blocks of a record, of which each fifth is held out."""
SAME = 0.05
"""Relative difference within which two motions or payloads count as the same."""


def hold_back(record: Record, compared: Iterable[str] | None = None) -> tuple[Record, Record | None]:
    """Return a record without its held-out blocks, and one with these alone.

    If either would hold none of the signals `compared` (default: all evidence), as of four poses, the record
    stays whole and the other is None.
    """
    fitted, held = dict(record.signals), dict(record.signals)
    for signal in _evidence(record):
        back = _held(record, signal)
        fitted[signal.name] = _without(signal, back)
        held[signal.name] = _without(signal, ~back)
    names = [signal.name for signal in _evidence(record)] if compared is None else list(compared)
    if not all(any(part[name].valid.any() for name in names) for part in (fitted, held)):
        return record, None
    return replace(record, signals=fitted), replace(record, signals=held)


def hold_out_kind(arm: Arm, training: Mapping[str, Record], held_out: Record) -> tuple[str, str]:
    """Return how far held-out data lie from the training, and what lies beyond it in words.

    Payloads, range and rates of the drives, and lengths of links are those of one training record
    ("repetition"), between training records ("interpolation"), or beyond ("extrapolation").
    """
    asked, known = _features(arm, held_out), _alike(arm, training, held_out)
    if not known:
        return "extrapolation", "it drives other joints, or other links are drawn out"
    clauses = (each.beyond([record[name].value for record in known]) for name, each in asked.items())
    beyond = "; ".join(filter(None, clauses))
    if any(all(one.same(record[name]) for name, one in asked.items()) for record in known):
        return "repetition", beyond
    return "extrapolation" if beyond else "interpolation", beyond


@dataclass(frozen=True)
class _Feature:
    """A number of a record that is compared."""

    words: str
    unit: str
    """Words before the number, and its unit."""
    value: float
    """Its value [unit]."""
    side: int = 0
    """On which side of known values it extrapolates: below, either, above. A smaller range is no
    extrapolation.
    """
    span: float = 0.0
    """Range of which the value is an end; differences count relative to it [unit]."""

    def same(self, other: _Feature) -> bool:
        """Return True if it is as in another record."""
        return abs(self.value - other.value) <= SAME * max(
            abs(self.value), abs(other.value), self.span, 1e-12
        )

    def beyond(self, known: Sequence[float]) -> str:
        """Return a clause that it lies beyond known values; empty if it does not."""
        size = SAME * max(abs(self.value), *map(abs, known), self.span, 1e-12)
        low, high = min(known), max(known)
        if self.side <= 0 and self.value < low - size:
            return self._told(low, "at least")
        if self.side >= 0 and self.value > high + size:
            return self._told(high, "at most")
        return ""

    def _told(self, end: float, which: str) -> str:
        here, there = with_unit(self.value, self.unit), with_unit(end, self.unit)
        return f"{self.words} {here}, in the training {there} {which}"


Features = dict[str, _Feature]
"""Features by name."""


def _alike(arm: Arm, training: Mapping[str, Record], held_out: Record) -> list[Features]:
    """Return features of the training records that drive the same joints and draw out the same links."""
    return [
        _features(arm, record)
        for record in training.values()
        if _driven(record) == _driven(held_out) and record.links.keys() == held_out.links.keys()
    ]


def _driven(record: Record) -> set[str]:
    """Return the joints that a record drives."""
    return {record.signals[name].joint or name for name in record.drive}


def _features(arm: Arm, record: Record) -> Features:
    """Return lengths of links, range and rms rate of each drive, and masses of payloads."""
    found = {
        f"length of {name}": _Feature(f"link {name} is drawn out to", "m", record.links[name].length)
        for name in sorted(record.links)
    }
    for name in record.drive:
        signal = record.signals[name]
        least, most = _range(signal)
        joint = signal.joint or name
        found |= {
            f"least of {joint}": _Feature(f"{joint} goes down to", signal.unit, least, -1, most - least),
            f"most of {joint}": _Feature(f"{joint} goes up to", signal.unit, most, 1, most - least),
            f"rate of {joint}": _Feature(f"the rms rate of {joint} is", f"{signal.unit}/s", rms_rate(signal)),
        }
    return found | _masses(arm, record)


def _masses(arm: Arm, record: Record) -> Features:
    """Return least and greatest mass of each payload; they differ only if records state a mass by pose."""
    machine = machine_of(record.applied_to(arm))
    by_pose = {signal.payload: signal for signal in record.of_quantity("payload_mass").values()}
    found = {}
    for name, load in machine.payloads.items():
        least, most = _range(by_pose[name]) if name in by_pose else (load.mass, load.mass)
        words = "the payload weighs" if len(machine.payloads) == 1 else f"payload {name} weighs"
        found[f"least mass of {name}"] = _Feature(words, "kg", least, -1)
        found[f"greatest mass of {name}"] = _Feature(words, "kg", most, 1)
    return found


def _range(signal: Signal) -> tuple[float, float]:
    """Return least and greatest value; zeros if there is none."""
    values = signal.values[np.isfinite(signal.values[:, 0]), 0]
    return (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)


def rms_rate(signal: Signal) -> float:
    """Return the rms rate of a drive over tenths of a second, so that noise does not count; 0 for poses."""
    if signal.pose is not None or len(signal.time) < 3:
        return 0.0
    step = max(1, round(0.1 / float(np.median(np.diff(signal.time)))))
    values, time = signal.values[::step, 0], signal.time[::step]
    rate = np.diff(values) / np.diff(time)
    return float(np.sqrt(np.nanmean(rate**2))) if len(rate) else 0.0


def _evidence(record: Record) -> list[Signal]:
    """Return the signals that are outputs of the arm."""
    return [
        signal
        for name, signal in record.signals.items()
        if name not in record.drive and not (record.kind == "static" and is_input(record, signal))
    ]


def _held(record: Record, signal: Signal) -> NDArray[np.bool_]:
    """Return True at held-out rows."""
    if signal.pose is not None:
        # poses in the order in which they were measured, the same for all signals
        poses = (each.pose.tolist() for each in _evidence(record) if each.pose is not None)
        number = {pose: k for k, pose in enumerate(dict.fromkeys(chain.from_iterable(poses)))}
        return np.array([number[pose] % EVERY == EVERY - 1 for pose in signal.pose.tolist()], dtype=bool)
    own = _time_of(record, signal)
    times = [
        record.instants(other)
        for other in record.signals.values()
        if other.pose is None and len(other.time) and _time_of(record, other) == own
    ]
    first, last = (min(t[0] for t in times), max(t[-1] for t in times)) if times else (0.0, 1.0)
    share = (record.instants(signal) - first) / max(last - first, 1e-12)  # eq. (1)
    block = np.minimum((BLOCKS * share).astype(int), BLOCKS - 1)
    found: NDArray[np.bool_] = block % EVERY == EVERY - 1
    return found


def _time_of(record: Record, signal: Signal) -> str:
    """Return the time base of a signal: "" for the reference clock, or its own clock of unknown offset."""
    return signal.clock if record.clocks[signal.clock].unknown else ""


def _without(signal: Signal, rows: NDArray[np.bool_]) -> Signal:
    return replace(signal, values=np.where(rows[:, None], np.nan, signal.values))


@dataclass(frozen=True)
class Split:
    """Training and held-out records, kind of the hold-out and its reason, and remarks."""

    training: dict[str, Record]
    held_out: dict[str, Record]
    kind: str
    why: str
    remarks: tuple[str, ...]

    def without_outliers(self, model: Arm, like: Problem) -> Split:
        """Return the split without outliers of held-out data, relative to a model."""
        motions = {name: record for name, record in self.held_out.items() if record.kind == "motion"}
        if not motions:
            return self
        held = Problem(model, motions, step=like.step, alpha=like.alpha, jobs=like.jobs, policy=like.policy)
        out = residual_outliers(held.residual(model), held)
        told = (*self.remarks, *outlier_remarks(out, held))
        return replace(self, held_out=left_out(self.held_out, out, held), remarks=told)


def named_hold_out(arm: Arm, hold_out: Record | None, given: Mapping[str, Record]) -> dict[str, Record]:
    """Return the given held-out record by name, checked against the model; empty without one."""
    if hold_out is None:
        return {}
    [record] = named_records({"hold_out": hold_out}).values()
    record.check_against(arm)
    for name, training in given.items():
        if set(record.signals) == set(training.signals) and all(
            np.array_equal(signal.values, training.signals[name].values, equal_nan=True)
            for name, signal in record.signals.items()
        ):
            raise InvalidParameter(
                f"holds the same values as {name!r}, which is fitted: nothing would be held out",
                where="hold_out",
            )
    # named by its directory, with as many parents as names of the training have
    parents = max(each.count("/") for each in given)
    parts = ("held_out",) if record.path is None else record.path.resolve().parts[-1 - parents :]
    name = "/".join(parts)
    return {name if name not in given else f"{name} (held out)": record}


def split(arm: Arm, checked: ValidationResult, held_out: ValidationResult) -> Split:
    """Return training and held-out data: a record of its own, or blocks of each record."""
    named = checked.comparable()
    remarks = (*map(str, held_out.outliers), *held_out.remarks)
    for record in held_out.records.values():
        return Split(named, dict(held_out.records), *hold_out_kind(arm, named, record), remarks)
    parts = {name: hold_back(record, checked.compared.get(name)) for name, record in named.items()}
    whole = [name for name, (_, back) in parts.items() if back is None]
    return Split(
        {name: fitted for name, (fitted, _) in parts.items()},
        {f"{name}, held-back blocks": back for name, (_, back) in parts.items() if back is not None},
        "blocks",
        "",
        tuple(f"{name} is too short to hold a part of it back" for name in whole),
    )


AROUND = 2.0
"""Least distance of an outlier over that of most rows around it."""


def residual_outliers(rest: Floats, problem: Problem) -> NDArray[np.bool_]:
    """Return True at rows of motions that are outliers of a residual by (2), shape (n,)."""
    found = np.zeros(len(problem), dtype=bool)
    for each, where in problem.channels():
        record = problem.records[each.record]
        if record.kind == "static":
            continue
        values = rest[where][:, None]
        rows, off, usual = deviation_from_median(values)
        if not len(rows):
            continue
        size = np.abs(off)
        least = problem.policy.outlier
        far = (size > least * np.maximum(1.0, usual))[:, 0]  # eq. (2)
        far[far] = (size[far] > AROUND * nearby(size, np.flatnonzero(far)))[:, 0]
        if far.any() and record.signals[each.signal].quantity not in SMOOTH:
            far &= beyond_range_of_others(values, far)
        if far.mean() < MOST:
            found[where.start + rows] = far
    return found


def masked_outliers(best: Fit, criteria: Criteria) -> NDArray[np.bool_]:
    """Return outliers whose removal makes a model adequate; none if it already is, or stays inadequate."""
    problem = criteria.problem
    nothing = np.zeros(len(problem), dtype=bool)
    if not criteria.leaves_gap(best):
        return nothing
    found = residual_outliers(best.projected, problem)
    rest = best.projected.copy()
    rest[np.flatnonzero(found)] = 0.0
    return nothing if criteria.leaves_gap(replace(best, projected=rest)) else found


def left_out(records: Mapping[str, Record], out: NDArray[np.bool_], problem: Problem) -> dict[str, Record]:
    """Return records without the readings of a mask of rows, in all their channels."""
    found = dict(records)
    for each, where in problem.channels():
        rows = np.flatnonzero(each.mask)[out[where]]
        found[each.record] = blank_rows(found[each.record], each.signal, rows)
    return found


def outlier_remarks(found: NDArray[np.bool_], problem: Problem) -> list[str]:
    """Return a sentence for each signal of a record that has some."""
    counts: dict[tuple[str, str], int] = {}
    for each, where in problem.channels():
        key = (each.signal, each.record)
        counts[key] = counts.get(key, 0) + int(found[where].sum())
    return [
        f"{count} value{'s' * (count > 1)} of {signal} in {record} left out: outliers that the gap had hidden"
        for (signal, record), count in counts.items()
        if count
    ]
