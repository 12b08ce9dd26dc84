"""Gap of one signal, pooled over several records, before and after the repair.

    rms^2 = sum_r n_r rms_r^2 / sum_r n_r                                                            (1)

with n_r rows of record r, and rms_r the total that `flexarm compare` prints for that record alone. The
noise is pooled likewise; the greatest gap is the greatest of all.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import sqrt
from typing import TYPE_CHECKING

from flexarm.fit_statistics import PooledGap

if TYPE_CHECKING:
    from flexarm.comparison.comparison import Comparison
    from flexarm.comparison.gap import SignalGap


def pooled_gap(
    before: Mapping[str, Comparison], after: Mapping[str, Comparison], names: Iterable[str], signal: str
) -> PooledGap:
    """Return the gap of a signal over the records of these names."""
    wanted = list(names)
    old, new = _gaps(before, wanted, signal), _gaps(after, wanted, signal)
    return PooledGap(
        pooled([gap.rms["total"] for gap in old], old),
        pooled([gap.rms["total"] for gap in new], new),
        pooled([gap.noise_rms for gap in new or old], new or old),
        _greatest(old),
        _greatest(new),
    )


def pooled(values: Sequence[float | None], gaps: Sequence[SignalGap]) -> float | None:
    """Return (1); None if a value is not known or there is none."""
    rows = [len(gap.time) for gap in gaps]
    known = [value for value in values if value is not None]
    if len(known) < len(rows) or sum(rows) == 0:
        return None
    return sqrt(sum(n * value**2 for n, value in zip(rows, known, strict=True)) / sum(rows))  # eq. (1)


def _gaps(comparisons: Mapping[str, Comparison], names: Sequence[str], signal: str) -> list[SignalGap]:
    """Return the gaps of the signal on the records that hold values of it."""
    found = [comparisons[name].signals.get(signal) for name in names if name in comparisons]
    return [gap for gap in found if gap is not None and gap.rms["total"] is not None]


def _greatest(gaps: Sequence[SignalGap]) -> float | None:
    return max((value for gap in gaps if (value := gap.max["total"]) is not None), default=None)
