"""The figures of a diagnosis: the gap before and after, by band, by stage, by candidate and by record.

Every axis has its unit. Colours are Okabe and Ito's; before and after differ in marker too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import log
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.diagnosis.gap_curves import (
    AFTER,
    LOOKS,
    along,
    directions,
    draw,
    label,
    noise_of,
    sides,
    worst,
)
from flexarm.diagnosis.pooled_gap import pooled
from flexarm.diagnosis.wording import number, place_words, scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from flexarm.comparison.gap import SignalGap
    from flexarm.diagnosis.result import Diagnosis, NamedEffect

WIDTH = 6.4
"""Narrow enough to be read on a phone [in]."""
RIVAL, OTHER, TRAINING, HELD_OUT, DRIFTS = "#56B4E9", "#bbbbbb", "#CC79A7", "#009E73", "#a02c00"
REACH = log(20.0)
"""Evidence that a candidate may lack and still be an alternative."""
MOST_CANDIDATES = 14


def sheet(rows: int, columns: int, height: float, **options: Any) -> tuple[Figure, Any]:
    """Axes in rows and columns, without pyplot's global state."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height))
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, columns, squeeze=False, **options)
    for ax in axes.flat:
        ax.set_axisbelow(True)
    return figure, axes


def _write_beside(ax: Axes, bars: Any, texts: Sequence[str]) -> None:
    """A text at the end of each bar, legible on lines too."""
    behind = {"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85}
    ax.bar_label(bars, texts, padding=3, fontsize=8, bbox=behind)


def gap_along(d: Diagnosis, record: str) -> Figure:
    """Before and after along a record, a row each direction; on the right what is left, enlarged."""
    gaps = sides(d, record)
    first, (model, last) = _first(gaps), list(gaps.items())[-1]
    names = directions(first)
    figure, axes = sheet(len(names), 2, 0.7 + 1.5 * len(names), sharex=True, width_ratios=(1.5, 1))
    for row, name in zip(axes, names, strict=True):
        factor, unit = scale([first.max[name]], first.unit)
        draw(row[0], gaps, name, factor)
        row[0].set_ylabel(f"{'gap' if name == 'total' else name} [{unit}]")
        largest = max(last.max[name] or 0.0, 2 * (noise_of(last) or 0.0))
        factor, unit = scale([largest], last.unit)
        draw(row[1], {model: last}, name, factor)
        row[1].set(ylabel=f"[{unit}]", ylim=(-1.15 * factor * largest, 1.15 * factor * largest))
    for ax, title in zip(axes[0], (f"{record}: measured − model", "what is left, enlarged"), strict=True):
        ax.set_title(title)
    for ax in axes[-1]:
        ax.set_xlabel(along(first))
    _legend_below(figure, axes[0, 0])
    return figure


def _first(gaps: Mapping[str, SignalGap]) -> SignalGap:
    return next(iter(gaps.values()))


def _legend_below(figure: Figure, ax: Axes) -> None:
    handles, labels = ax.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)


def by_band(d: Diagnosis, records: Sequence[str]) -> Figure | None:
    """The gap in each band of frequencies before and after, beside the noise; None without bands."""
    shown = {name: gaps for name in records if len(gaps := sides(d, name)) == 2 and _first(gaps).bands}
    if not shown:
        return None
    figure, axes = sheet(1, len(shown), 2.5, sharey=True)
    factor, unit = scale([_first(gaps).rms["total"] for gaps in shown.values()], d.unit)
    for ax, (name, gaps) in zip(axes[0], shown.items(), strict=True):
        labels = [f"{band.low:.2g}–{band.high:.2g}" for band in _first(gaps).bands]
        for (model, gap), shift in zip(gaps.items(), (-0.2, 0.2), strict=True):
            heights = [factor * band.rms for band in gap.bands[: len(labels)]]
            ax.bar(np.arange(len(heights)) + shift, heights, 0.38, color=LOOKS[model]["color"], label=model)
        noise = gaps["updated model"].noise_rms
        if noise:
            ax.axhline(factor * noise, color="black", lw=0.8, ls="--", label="noise, all bands")
        ax.set(xticks=np.arange(len(labels)), xticklabels=labels, xlabel="band [Hz]", title=name)
        ax.set_yscale("log")
    axes[0, 0].set_ylabel(f"rms of {d.main_signal} [{unit}]")
    _legend_below(figure, axes[0, 0])
    return figure


def waterfall(d: Diagnosis) -> Figure | None:
    """The gap from the nominal model to the repaired one, effect by effect; None if nothing was added."""
    groups = [("training", d.training, TRAINING), ("held out", d.held_out, HELD_OUT)]
    rows = [(name, heights, colour) for name, of, colour in groups if (heights := _stages(d, of))]
    if len(d.stages) < 2 or not rows:
        return None
    figure, axes = sheet(1, 1, 1.0 + 0.42 * len(d.stages))
    ax = axes[0, 0]
    largest = max(max(heights) for _, heights, _ in rows)
    factor, unit = scale([largest], d.unit)
    for i, (name, heights, colour) in enumerate(rows):
        place = np.arange(len(heights)) + 0.38 * (i - (len(rows) - 1) / 2)
        values = [factor * height for height in heights]
        bars = ax.barh(place, values, 0.36, color=colour, label=name)
        _write_beside(ax, bars, [number(value) for value in values])
    noise = d.gap([*d.training, *d.held_out]).noise_rms
    if noise:
        ax.axvline(factor * noise, color="black", lw=0.8, ls="--", label="noise")
    smallest = min([min(heights) for _, heights, _ in rows] + ([noise] if noise else []))
    labels = [_stage_label(stage.label, i) for i, stage in enumerate(d.stages)]
    ax.set(yticks=np.arange(len(labels)), yticklabels=labels)
    ax.set(xscale="log", xlim=(0.6 * factor * smallest, 2.2 * factor * largest))
    ax.set_xlabel(f"rms gap of {d.main_signal} [{unit}]")
    ax.invert_yaxis()
    ax.grid(visible=False, axis="y")
    _legend_below(figure, ax)
    return figure


def _stages(d: Diagnosis, records: Sequence[str]) -> list[float]:
    """The gap of each stage pooled over records; empty if one is not known."""
    known = [name for name in records if sides(d, name) and all(name in stage.rms for stage in d.stages)]
    gaps = [_first(sides(d, name)) for name in known]
    heights = [pooled([stage.rms[name] for name in known], gaps) for stage in d.stages]
    return [height for height in heights if height] if all(heights) else []


def _stage_label(text: str, place: int) -> str:
    words = text.replace("_", " ")
    return words if place == 0 else f"+ {words}"


def candidates(d: Diagnosis) -> Figure | None:
    """What evidence every candidate lacks against what was chosen; None if none was tried."""
    rows = _candidate_rows(d)
    if len(rows) < 2:
        return None
    shown = sorted(rows, key=lambda row: row[1])[:MOST_CANDIDATES]
    figure, axes = sheet(1, 1, 0.9 + 0.22 * len(shown))
    ax = axes[0, 0]
    bars = ax.barh([row[0] for row in shown], [row[1] for row in shown], color=[row[2] for row in shown])
    _write_beside(ax, bars, [_lacking(row[1], row[2]) for row in shown])
    ax.axvline(REACH, color="black", lw=0.8, ls="--", label="ln 20: right of it out of reach")
    ax.set_xscale("symlog", linthresh=REACH)
    ax.set_xlim(0, 4 * max(REACH, *(row[1] for row in shown)))
    ax.set_xlabel("evidence lacking: −ln(Bayes factor) [-]")
    ax.invert_yaxis()
    ax.grid(visible=False, axis="y")
    _legend_below(figure, ax)
    return figure


def _lacking(value: float, colour: str) -> str:
    return "chosen" if colour == AFTER else f"{value:,.1f}" if value < 100 else f"{value:,.0f}"


def _candidate_rows(d: Diagnosis) -> list[tuple[str, float, str]]:
    """Words, evidence lacking, colour; each pair of name and place once."""
    rows: dict[tuple[str, str], tuple[float, str]] = {}
    for effect in d.effects:
        rows[effect.name, effect.at] = (0.0, AFTER)
        for other in effect.alternatives:
            odds = other.probability / effect.probability if effect.probability > 0 else 1.0
            lacking = -log(odds) if odds > 0 else REACH
            rows.setdefault((other.name, other.at), (max(0.0, lacking), RIVAL))
    for candidate in d.rejected:
        if np.isfinite(candidate.log_bayes_factor):
            lacking = max(0.0, -candidate.log_bayes_factor)
            rows.setdefault((candidate.name, candidate.at), (lacking, OTHER))
    return [(place_words(*place), lacking, colour) for place, (lacking, colour) in rows.items()]


def constancy(d: Diagnosis, entries: Sequence[Any]) -> Figure | None:
    """Parameters fitted on each record alone, beside the value of all together; None if there are none."""
    if not entries:
        return None
    heights = [0.55 + 0.2 * len(entry["values"]) for entry in entries]
    figure, axes = sheet(len(entries), 1, 0.25 + sum(heights), height_ratios=heights)
    for ax, entry in zip(axes[:, 0], entries, strict=True):
        draw_constancy(ax, d, entry)
    return figure


def draw_constancy(ax: Axes, d: Diagnosis, entry: Any) -> None:
    """One parameter by record with 90 % bars; the joint estimate and its interval as a band."""
    values = {name: (float(value), float(std)) for name, (value, std) in entry["values"].items()}
    joint = _estimate(d, entry)
    factor, unit = scale([value for value, _ in values.values()], entry["unit"])
    if joint is not None:
        ax.axvspan(factor * joint.low90, factor * joint.high90, color=RIVAL, alpha=0.35, lw=0)
        ax.axvline(factor * joint.value, color=AFTER, lw=0.8)
    for i, (value, std) in enumerate(values.values()):
        spread = 1.645 * factor * std if np.isfinite(std) else 0.0
        colour = "black" if entry.get("constant", True) else DRIFTS
        ax.errorbar([factor * value], [i], xerr=[spread], fmt="o", ms=4, capsize=3, color=colour)
    moves = "" if entry.get("constant", True) else f": moves with {entry.get('moves_with') or 'the record'}"
    ax.set(yticks=range(len(values)), yticklabels=list(values), ylim=(len(values) - 0.5, -0.5))
    ax.set_xlabel(f"{entry['parameter']} [{unit or '-'}]")
    ax.set_title(f"{place_words(entry['effect'], entry['at'])}{moves}")
    ax.margins(x=0.15)


def _estimate(d: Diagnosis, entry: Any) -> Any:
    """What all records together gave for a parameter, or None."""
    for effect in d.effects:
        if (effect.name, effect.at) == (entry["effect"], entry["at"]):
            return next((each for each in effect.parameters if each.name == entry["parameter"]), None)
    return None


def of_effect(d: Diagnosis, effect: NamedEffect) -> Figure:
    """What an effect leaves in the gap, and whether its parameters stay the same from record to record."""
    known = {name: gaps for name in d.before if (gaps := sides(d, name))}
    record = max(known, key=lambda name: _first(known[name]).rms["total"] or 0.0)
    first, name = _first(known[record]), worst(_first(known[record]))
    entries = [e for e in d.constancy if (e["effect"], e["at"]) == (effect.name, effect.at)]
    heights = [2.2, *(0.6 + 0.2 * len(entry["values"]) for entry in entries)]
    figure, axes = sheet(len(heights), 1, 0.3 + sum(heights), height_ratios=heights)
    ax = axes[0, 0]
    factor, unit = scale([first.max[name]], first.unit)
    draw(ax, known[record], name, factor)
    ax.set(xlabel=along(first), ylabel=f"{label(first, name)} [{unit}]")
    ax.set_title(f"{place_words(effect.name, effect.at)}: gap on {record}, measured − model")
    ax.legend(loc="upper right", ncols=3)
    for ax, entry in zip(axes[1:, 0], entries, strict=True):
        draw_constancy(ax, d, entry)
    return figure
