"""Unit of time stamps: records that last or move as if their stamps were in another unit than stated.

Milliseconds read as seconds make 18 s last 5 hours. Stamps alone do not tell that from a slow motion, but

    beside other signals   one lasts about 1000 (or a million) times as long as another; were its stamps so
                           many times shorter, it would be sampled as sensors are                         (1)
    all of a record        lasts for more than an hour, its joints move so many times slower than joints
                           do, and with shorter stamps it would be sampled as sensors are                 (2)
    the other way          a signal that lasts a thousandth as long is sampled as no sensor is; a joint
                           moves faster than any does                                                     (3)

(2) doubts a record of hours that really is one: a run of it takes millions of steps, which is worth saying.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import permutations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import Problem

if TYPE_CHECKING:
    from flexarm.record.record import Record
    from flexarm.record.signal import Signal

REMEDY = 'say time_unit = "{unit}"'
"""Remedy for stamps in another unit than stated."""
UNITS = {1e3: "ms", 1e6: "us", 1e9: "ns"}
"""Units of stamps by how many of them a second has."""
ALIKE = 2.0
"""Ratio of the spans of signals of one run: one may begin late, or end early."""
USUAL, UNHEARD = 2e3, 5e3
"""Rates [Hz] up to which loggers sample, and from which on hardly any sensor of an arm does."""
LONG = 3600.0
"""Duration from which on a run is worth a word [s]."""
LIVELY = 10.0
"""Rates that joints reach [rad/s or m/s]: robots turn by 2 to 7 rad/s."""
LEAST_ROWS = 3
"""Rows of which a rate is known."""


class Span(NamedTuple):
    """Duration of samples [s], and their rate [Hz]."""

    seconds: float
    rate: float

    def __str__(self) -> str:
        return f"{_duration(self.seconds)} at {float(f'{self.rate:.3g}'):g} Hz"

    def __truediv__(self, factor: float) -> Span:
        return Span(self.seconds / factor, self.rate * factor)


class Motion(NamedTuple):
    """Rate of a motion, in its unit a second."""

    name: str
    rate: float
    unit: str

    def __str__(self) -> str:
        return f"{self.name} moves by {self.rate:.2g} {self.unit}/s at most"


def span_of(time: Floats) -> Span:
    """Return duration and rate of stamps [s]."""
    with np.errstate(over="ignore"):
        return Span(float(time[-1] - time[0]), float(1 / np.median(np.diff(time))))


def motion_of(name: str, time: Floats, values: Floats, unit: str) -> Motion:
    """Return the rate of a motion: the quantile `share` over `looks` samples; NaN are drop-outs."""
    share = 0.9  # share of a motion that is no faster than what is called its rate: single samples may be off
    looks = 1001  # samples at which a motion is looked at
    good = np.flatnonzero(np.isfinite(values))
    few = good[np.unique(np.linspace(0, len(good) - 1, looks).astype(int))] if len(good) > 1 else good[:0]
    with np.errstate(over="ignore"):  # of numbers that no sensor gives
        rates = np.abs(np.diff(values[few]) / np.diff(time[few]))
    return Motion(name, float(np.quantile(rates, share)) if len(rates) else 0.0, unit)


def duration_problems(record: Record) -> Iterable[Problem]:
    """Yield signals whose durations violate (1), (2) or the first of (3)."""
    spans, apart = _spans(record), mismatched_durations(record)
    yield from apart
    if not spans or apart:
        return
    whole = Span(max(span.seconds for span in spans.values()), max(span.rate for span in spans.values()))
    motions = [_motion(record.signals[name]) for name in record.drive if name in spans]
    first = motions[0].name if motions else next(iter(spans))
    yield from (Problem(f"signals.{first}.time", what) for what in implausible_duration(whole, motions))


def mismatched_durations(record: Record) -> list[Problem]:
    """Return signals whose durations violate (1) or the first of (3)."""
    found: dict[str, list[tuple[str, str]]] = {}
    for (name, span), (other, its) in permutations(_spans(record).items(), 2):
        factor = next((f for f in UNITS if 1 / ALIKE < span.seconds / its.seconds / f < ALIKE), None)
        if factor is None:
            continue
        if its.rate > UNHEARD:
            what = f"lasts {its}, {name} {span}, {factor:g} times as long: are its stamps in s?"
            found.setdefault("in s", []).append((other, what))
        elif span.rate * factor <= USUAL:
            what = f"lasts {span}, {factor:g} times as long as {other} ({its}); {unit_hint(factor, span)}"
            found.setdefault(UNITS[factor], []).append((name, what))
    return [_one_of(alike) for alike in found.values()]


def _spans(record: Record) -> dict[str, Span]:
    return {s.name: span_of(s.time) for s in record.signals.values() if len(s.time) >= LEAST_ROWS}


def _motion(signal: Signal) -> Motion:
    return motion_of(signal.name, signal.time, signal.values[:, 0], signal.unit)


def implausible_rates(record: Record, joints: Sequence[str]) -> Iterable[Problem]:
    """Yield drives of these joints at rates that no joint reaches at its output (3)."""
    fastest = 100.0  # A rate that no joint reaches at its output [rad/s or m/s]
    for signal in (record.signals[name] for name in record.drive):
        motion = _motion(signal) if len(signal.time) >= LEAST_ROWS else None
        if motion and signal.joint in joints and motion.rate > fastest:
            what = f"moves by {motion.rate:.3g} {motion.unit}/s, faster than any joint"
            yield Problem(
                f"signals.{signal.name}", f"{what}; are its stamps, and its values, in their units?"
            )


def _one_of(alike: list[tuple[str, str]]) -> Problem:
    """Return the problem of the first of signals with the same unit, and the names of the others."""
    name, what = alike[0]
    others = ", ".join(other for other in dict.fromkeys(other for other, _ in alike) if other != name)
    return Problem(f"signals.{name}.time", what + (f"; the same holds for {others}" if others else ""))


def implausible_duration(span: Span, motions: Sequence[Motion], remedy: str = REMEDY) -> Iterable[str]:
    """Yield a sentence on a run of hours (2), with the likely unit of its stamps.

    The remedy says what to do about stamps in another `{unit}`.
    """
    step = 2e-3  # time step of a run, unless another one is asked for [s]
    if span.seconds <= LONG:
        return
    long = f"lasts {span}, {span.seconds / step:.2g} steps of a simulation at {1e3 * step:g} ms"
    fastest = max(motions, key=lambda motion: motion.rate, default=None)
    factor = next((f for f in UNITS if span.seconds / f <= LONG), None)
    if factor and fastest and span.rate * factor <= USUAL and 0 < fastest.rate * factor <= LIVELY:
        yield f"{long}, and {fastest}; {unit_hint(factor, span, remedy)}"
    else:
        yield long


def unit_hint(factor: float, span: Span, remedy: str = REMEDY) -> str:
    """Return the remedy for stamps in a unit of which a second has `factor`, and the duration then."""
    unit = UNITS[factor]
    return f"if its stamps are in {unit}, {remedy.format(unit=unit)}: {span / factor}"


def _duration(seconds: float) -> str:
    """Return a duration as a person reads it.

    >>> _duration(0.018), _duration(18), _duration(600), _duration(18e3), _duration(18e6)
    ('0.018 s', '18 s', '10 min', '5 h', '208 d')
    """
    for unit, size, least in (("d", 86400.0, 2.0), ("h", 3600.0, 1.0), ("min", 60.0, 2.0)):
        if seconds >= least * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.3g} s"
