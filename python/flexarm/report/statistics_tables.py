"""Statistics of the fit as rows of the page: channels, correlations, and what the records cover."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from flexarm.wording import effect_words, listed, number, scale, signed

if TYPE_CHECKING:
    from flexarm.fit_statistics import FitStatistics

AXES = "xyz"
"""Names of the channels of positions."""


def channel_rows(statistics: FitStatistics) -> Iterator[dict[str, str]]:
    """Return a row for each channel; one of several in a signal is told by its axis."""
    several = {(c.record, c.signal) for c in statistics.channels if c.channel > 0}
    for each in statistics.channels:
        axis = AXES[each.channel] if each.channel < len(AXES) else str(each.channel)
        lag = each.autocorrelation
        yield {
            "record": each.record,
            "signal": f"{each.signal} {axis}" if (each.record, each.signal) in several else each.signal,
            "rows": str(each.rows),
            "chi_square": number(each.chi_square, 2),
            "autocorrelation": "–" if lag is None else minus(signed(lag, 2)),
            "discrepancy": number(each.discrepancy, 2) if each.discrepancy > 0 else "none",
            "length": "–" if each.length is None else f"{number(each.length, 2)} s",
        }


def correlation_rows(statistics: FitStatistics) -> Iterator[dict[str, str]]:
    """Return a row for each pair of correlated parameters."""
    for each in statistics.correlations:
        one, other = each.parameters
        yield {"one": one, "other": other, "value": minus(signed(each.value, 3))}


def motion_rows(statistics: FitStatistics) -> Iterator[dict[str, str]]:
    """Return a row for each driven joint of a record: its range and rate."""
    for each in statistics.motions:
        factor, unit = scale([each.lowest, each.highest], each.unit)
        low, high = (minus(number(factor * end, 3)) for end in (each.lowest, each.highest))
        rate = "–" if each.rms_rate is None else f"{number(each.rms_rate, 3)} {each.unit}/s"
        yield {"record": each.record, "joint": each.joint, "range": f"{low} to {high} {unit}", "rate": rate}


def unseen_sentence(statistics: FitStatistics) -> str:
    """Return a sentence on effects that could not have been named; empty if there are none."""
    names = [effect_words(name) for name in statistics.unseen]
    return f"These signals and motions could not have shown: {listed(names)}." if names else ""


def minus(text: str) -> str:
    """Return a number with the sign that is as wide as a digit."""
    return text.replace("-", "−")
