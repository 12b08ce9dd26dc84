"""A diagnosis as text in a terminal: verdict, effects with intervals, rivals, gap, what to measure next."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from typing import TYPE_CHECKING

from flexarm.comparison.comparison import frame_words
from flexarm.report.gap_tables import gap_tables
from flexarm.report.law_figures import law_rows
from flexarm.report.sentences import (
    headline,
    hold_out_sentence,
    remarks_beside,
    stated_sentence,
    unpredicted_sentence,
    verdict_sentence,
)
from flexarm.wording import interval, place_words, probability, signed, with_unit

if TYPE_CHECKING:
    from flexarm.comparison.before_after import BeforeAfter
    from flexarm.diagnosis.result import Diagnosis
    from flexarm.named_effects import Estimate, NamedEffect


def summary(diagnosis: Diagnosis) -> str:
    """All that matters on one screen."""
    parts = [
        [
            f"{headline(diagnosis)}  [{diagnosis.verdict}]",
            *wrapped(verdict_sentence(diagnosis)),
            *wrapped(unpredicted_sentence(diagnosis)),
        ],
        _laws(diagnosis),
        _effects(diagnosis),
        _refined(diagnosis),
        _nuisances(diagnosis),
        _gaps(diagnosis),
        _remarks(diagnosis),
    ]
    return "\n\n".join("\n".join(part) for part in parts if part)


def wrapped(text: str, indent: str = "", then: str | None = None) -> list[str]:
    """Return the lines of a text, indented as the first one or by `then` from the second on."""
    return textwrap.wrap(
        text,
        100,
        initial_indent=indent,
        subsequent_indent=indent if then is None else then,
        break_long_words=False,
        break_on_hyphens=False,
    )


def _laws(diagnosis: Diagnosis) -> list[str]:
    """Return lines on the missing laws, each with its probability and the gap of held-out data with it."""
    lines: list[str] = []
    for row in law_rows(diagnosis):
        text = f"missing law, probability {row['probability']}: {row['says']}"
        shrinks = "" if row["held_out"] == "–" else f" Held out: {row['held_out']}."
        lines += wrapped(text + shrinks, then="  ")
    return lines


def _effects(diagnosis: Diagnosis) -> list[str]:
    return [line for effect in diagnosis.effects for line in _effect(diagnosis, effect)]


def _effect(diagnosis: Diagnosis, effect: NamedEffect) -> list[str]:
    title = f"{place_words(effect.name, effect.at)}, probability {probability(effect.probability)}"
    lines = [title, *(_row(each) for each in effect.parameters)]
    if diagnosis.verdict != "unusable":
        lines += wrapped(stated_sentence(diagnosis, effect), "  ")
    lines += wrapped(effect.evidence, "  ")
    for other in effect.alternatives:
        words = place_words(other.name, other.at)
        lines.append(f"  or {words}, probability {probability(other.probability)}")
    return lines


def _row(estimate: Estimate) -> str:
    value, low, high, unit = interval(estimate)
    return f"  {estimate.name:<18}{value:>12} {unit:<12} 90 % interval {low} to {high}"


def _refined(diagnosis: Diagnosis) -> list[str]:
    found = diagnosis.refinements
    lines = ["nominal values refined: from, by +- 1 sigma, of what is stated"] if found else []
    for each in found:
        if each.determined or each.changed:
            moved, std, unit = each.texts
            nominal = with_unit(each.refined.nominal, each.refined.unit, 4)
            pull = "" if each.pull is None else f", {signed(each.pull, 1)} stated sigma"
            lines.append(f"  {each.refined.parameter}: {nominal} {moved} +- {std} {unit}{pull}")
    left = [each.refined.parameter for each in found if not (each.determined or each.changed)]
    return lines + (wrapped(f"as they were, not determined: {', '.join(left)}", "  ", "    ") if left else [])


def _nuisances(diagnosis: Diagnosis) -> list[str]:
    title = "clocks and frames, fitted along: within stated sigmas, or freely where unknown"
    lines = [title] if diagnosis.nuisances else []
    for nuisance in diagnosis.nuisances:
        lines.append(f"  {place_words(nuisance.name, nuisance.at)}")
        lines += [f"  {_row(each)}" for each in nuisance.parameters]
    return lines + [
        f"  {record}: {frame_words(name, pose)}"
        for record, found in diagnosis.frames.items()
        for name, pose in found.items()
    ]


def _gaps(diagnosis: Diagnosis) -> list[str]:
    """Return a table by record for each signal, and how the held-out data relate to the training."""

    def label(name: str) -> str:
        return f"{name} (held out)" if name in diagnosis.held_out and "held" not in name else name

    lines = gap_lines(diagnosis, label)
    return [*lines, *wrapped(hold_out_sentence(diagnosis))] if lines else []


def gap_lines(diagnosis: BeforeAfter, label: Callable[[str], str]) -> list[str]:
    """Return the tables of the gap by signal as lines, each record under its label."""
    lines = []
    for table in gap_tables(diagnosis):
        head = f"gap of {table.signal} [{table.unit}]"
        labels = [f"  {label(name)}" for name, _ in table.rows]
        wide = max(26, *(len(text) + 2 for text in (head, *labels)))
        columns = ("rms before", "rms after", "noise", "max before", "max after")
        rows = zip([head, *labels], [columns, *(cells for _, cells in table.rows)], strict=True)
        lines += [f"{text:<{wide}}" + "".join(f"{cell:>12}" for cell in cells) for text, cells in rows]
    return lines


def _remarks(diagnosis: Diagnosis) -> list[str]:
    lines: list[str] = []
    if diagnosis.remainder and diagnosis.verdict != "unexplained":
        lines += wrapped(f"remains: {diagnosis.remainder}", "", "  ")
    for remark in remarks_beside(diagnosis):
        lines += wrapped(f"note: {remark}", "", "  ")
    if diagnosis.next_experiment:
        lines += wrapped(f"measure next: {diagnosis.next_experiment}", "", "  ")
    return lines
