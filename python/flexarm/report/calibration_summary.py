"""A calibration as text in a terminal, and the sentences and rows that its page shares with it."""

from __future__ import annotations

from math import exp
from typing import TYPE_CHECKING

from flexarm.comparison.comparison import frame_words
from flexarm.named_effects import Estimate
from flexarm.report.gap_tables import gap_tables
from flexarm.report.sentences import ROWS
from flexarm.report.summary import wrapped
from flexarm.wording import effect_words, interval, listed, number, with_unit

if TYPE_CHECKING:
    from flexarm.calibration.estimates import CalibratedFamily, CalibratedParameter
    from flexarm.calibration.result import Calibration

COLUMNS = ("rms before", "rms after", "noise", "max before", "max after")


def headline(found: Calibration) -> str:
    """Return how the gap shrinks on what was held out, or on the training where nothing was."""
    records = found.held_out or found.training
    gap = found.gap(records)
    sizes = (gap.before_rms, gap.after_rms, gap.noise_rms)
    before, after, noise = (with_unit(value, found.unit) for value in sizes)
    where = "held-out data" if found.held_out else "the training"
    return f"{found.main_signal}: rms gap on {where} {before} -> {after}, noise {noise}"


def fit_sentence(found: Calibration) -> str:
    """Return the number of parameters and chi-square in a sentence."""
    chi, known = found.chi_square, sum(each.determined for each in found.parameters)
    return (
        f"{len(found.parameters)} parameters, {known} of them determined by the data; chi-square "
        f"{number(chi.value, 4)} of {chi.rows} residuals and {number(chi.parameters)} effective parameters, "
        f"reduced {number(chi.reduced)}"
    )


def family_sentence(family: CalibratedFamily) -> str:
    """Return what a family shares, and how its members differ."""
    name = f"{effect_words(family.effect)}, {family.parameter}, at {len(family.at)} places"
    if family.shared is None:
        return f"{name}: rms size {with_unit(family.spread, family.unit)}"
    shared = family.shared
    value, low, high, unit = interval(
        Estimate(family.parameter, shared.value, 0.0, shared.low90, shared.high90, family.unit)
    )
    return (
        f"{name}: shared size {value} {unit}, 90 % interval {low} to {high}; "
        f"members differ by a factor {number(exp(family.spread))} (1 sigma)"
    )


def row(each: CalibratedParameter) -> tuple[str, str, str, str, str]:
    """Return name, value, interval, unit and identifiability of an estimate."""
    value, low, high, unit = interval(
        Estimate(each.name, each.value, each.std, each.low90, each.high90, each.unit)
    )
    return each.name, value, f"{low} to {high}", unit, f"{100 * each.identifiability:.0f} %"


def pair_sentence(pair: tuple[str, str, float]) -> str:
    """Return a pair of correlated parameters."""
    return f"{pair[0]} and {pair[1]}: {pair[2]:+.3f}"


def summary(found: Calibration) -> str:
    """Return all that matters on one screen."""
    known = [each for each in found.parameters if each.determined]
    left = [each.name for each in found.parameters if not each.determined]
    pairs = found.confounded[:ROWS]
    parts = [
        [headline(found), *wrapped(fit_sentence(found))],
        [line for family in found.families for line in wrapped(family_sentence(family), "", "  ")],
        ["determined by the data, with 90 % intervals, and the share of the prior variance removed"]
        * bool(known)
        + _table([row(each) for each in known]),
        wrapped(f"left near what was known before: {listed(left)}", "", "  ") if left else [],
        ["correlated"] * bool(pairs) + [f"  {pair_sentence(pair)}" for pair in pairs],
        [frame_words(each.name, (list(each.xyz), list(each.rpy))) for each in found.frames],
        _gaps(found),
        [line for remark in found.remarks for line in wrapped(f"note: {remark}", "", "  ")],
    ]
    return "\n\n".join("\n".join(part) for part in parts if part)


def _table(rows: list[tuple[str, str, str, str, str]]) -> list[str]:
    """Return rows with columns that align."""
    widths = [max((len(each[k]) for each in rows), default=0) for k in range(5)]
    return [
        f"  {name:<{widths[0]}}  {value:>{widths[1]}} {unit:<{widths[3]}}  {ends:>{widths[2]}}  {share:>5}"
        for name, value, ends, unit, share in rows
    ]


def _gaps(found: Calibration) -> list[str]:
    lines = []
    for table in gap_tables(found):
        head = f"gap of {table.signal} [{table.unit}]"
        labels = [f"  {name}{' (held out)' * (name in found.held_out)}" for name, _ in table.rows]
        wide = max(26, *(len(text) + 2 for text in (head, *labels)))
        lines.append(f"{head:<{wide}}" + "".join(f"{column:>12}" for column in COLUMNS))
        for label, (_, cells) in zip(labels, table.rows, strict=True):
            lines.append(f"{label:<{wide}}" + "".join(f"{cell:>12}" for cell in cells))
    return lines
