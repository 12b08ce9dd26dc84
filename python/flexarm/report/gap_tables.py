"""The gap of signals by record, before and after, as tables that a person reads: in the summary, on the page.

First stands the report's main signal, then each other one of which the repair changes the gap noticeably, as
friction of a motor does that shows in a torque alone: in the training or in what was held out, by more than
`changed` of itself and

    sqrt(|rms_before^2 - rms_after^2|) > `noticed` noise                                               (1)
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexarm.comparison.pooled_gap import PooledGap
from flexarm.wording import number, scale

if TYPE_CHECKING:
    from flexarm.comparison.before_after import BeforeAfter


@dataclass(frozen=True)
class GapTable:
    """The gap of one signal by record: rms before and after, noise, greatest before and after [unit]."""

    signal: str
    unit: str
    rows: tuple[tuple[str, tuple[str, ...]], ...]


def gap_tables(diagnosis: BeforeAfter) -> list[GapTable]:
    """Of the main signal and of all others that the repair changes; none where nothing was compared."""
    signals = [diagnosis.main_signal, *changed_signals(diagnosis)]
    tables = [_table(diagnosis, signal) for signal in signals]
    return [table for table in tables if table.rows]


def changed_signals(diagnosis: BeforeAfter) -> list[str]:
    """Signals beside the main one whose gap changes noticeably, in the order of the records."""
    d = diagnosis
    names = dict.fromkeys(name for comparison in d.before.values() for name in comparison.evidence)
    return [
        name
        for name in names
        if name != d.main_signal and any(changes(d.gap(of, name)) for of in (d.training, d.held_out))
    ]


def changes(gap: PooledGap) -> bool:
    """Return True if a gap changes by more than `changed`, and (1)."""
    # Of (1): what an effect must do to a channel to be taken is half of its noise as well.
    changed, noticed = 0.1, 0.5
    if gap.before_rms is None or gap.after_rms is None:
        return False
    change = abs(gap.before_rms - gap.after_rms) > changed * max(gap.before_rms, gap.after_rms)
    return change and abs(gap.before_rms**2 - gap.after_rms**2) > (noticed * (gap.noise_rms or 0.0)) ** 2


def _table(d: BeforeAfter, signal: str) -> GapTable:
    found = {
        name: gap
        for name in (*d.training, *d.held_out)
        if (gap := d.gap([name], signal)).before_rms is not None
    }
    factor, unit = scale([gap.before_rms for gap in found.values()], d.unit_of(signal))
    rows = tuple((name, tuple(_cells(gap, factor))) for name, gap in found.items())
    return GapTable(signal, unit, rows)


def _cells(gap: PooledGap, factor: float) -> Iterator[str]:
    for value in (gap.before_rms, gap.after_rms, gap.noise_rms, gap.before_max, gap.after_max):
        yield number(None if value is None else factor * value)
