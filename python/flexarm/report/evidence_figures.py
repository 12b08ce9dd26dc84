"""Evidence: candidates, parameters by record, and the curves of missing laws."""

from __future__ import annotations

from math import log
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.named_effects import NORMAL_90, NamedEffect, Place
from flexarm.report.files import BOTTOM, LEFT, TOP, legend_below, margin_for, sheet, write_beside
from flexarm.report.gap_figures import AFTER, BEFORE, along, draw, label, sides, worst
from flexarm.report.state_figures import draw_of_effect
from flexarm.wording import labelled_scale, place_words, probability, with_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from flexarm.diagnosis.result import Diagnosis
    from flexarm.law_curve import LawCurve, LawGap


ALTERNATIVE, OTHER, MOVING = "#56B4E9", "#bbbbbb", "#a02c00"
REACH = log(20.0)
"""Evidence that a candidate may lack and still be an alternative."""
TITLED = BOTTOM + TOP
"""Space between rows that have labels and titles of their own [in]."""


def candidates(d: Diagnosis) -> Figure | None:
    """Return what evidence every candidate lacks against what was chosen; None if none was tried."""
    rows = _candidate_rows(d)
    if len(rows) < 2:
        return None
    shown = sorted(rows, key=lambda row: row[1])[:14]
    figure, axes = sheet(1, 1, 0.22 * len(shown) + 0.1, left=margin_for([row[0] for row in shown]))
    ax = axes[0, 0]
    bars = ax.barh([row[0] for row in shown], [row[1] for row in shown], color=[row[2] for row in shown])
    texts = ["chosen" if c == AFTER else f"{x:,.1f}" if x < 100 else f"{x:,.0f}" for _, x, c in shown]
    write_beside(ax, bars, texts)
    ax.axvline(REACH, color="black", lw=0.8, ls="--", label="ln 20: right of it out of reach")
    ax.set_xscale("symlog", linthresh=REACH)
    ax.set_xlim(0, 10 * max(REACH, *(row[1] for row in shown)))
    ax.set_xlabel("evidence lacking: −ln(Bayes factor) [-]")
    ax.invert_yaxis()
    ax.grid(visible=False, axis="y")
    legend_below(figure, ax)
    return figure


def _candidate_rows(d: Diagnosis) -> list[tuple[str, float, str]]:
    """Words, evidence lacking, colour; each pair of name and place once."""
    rows: dict[tuple[str, Place], tuple[float, str]] = {}
    for effect in d.effects:
        rows[effect.name, effect.at] = (0.0, AFTER)
        for other in effect.alternatives:
            odds = other.probability / effect.probability if effect.probability > 0 else 1.0
            lacking = -log(odds) if odds > 0 else REACH
            rows.setdefault((other.name, other.at), (max(0.0, lacking), ALTERNATIVE))
    for candidate in d.rejected:
        if np.isfinite(candidate.log_bayes_factor):
            lacking = max(0.0, -candidate.log_bayes_factor)
            rows.setdefault((candidate.name, candidate.at), (lacking, OTHER))
    return [(place_words(*place), lacking, colour) for place, (lacking, colour) in rows.items()]


def constancy(d: Diagnosis) -> Figure | None:
    """Return parameters fitted to each record alone, and to all together; None if there are none."""
    entries = d.constancy
    if not entries:
        return None
    heights = [0.2 * (1 + len(entry["values"])) for entry in entries]
    left = margin_for([name for entry in entries for name in entry["values"]])
    figure, axes = sheet(
        len(entries), 1, sum(heights), left=left, between=(0.0, TITLED), legend=False, height_ratios=heights
    )
    for ax, entry in zip(axes[:, 0], entries, strict=True):
        draw_constancy(ax, d, entry)
    return figure


def draw_constancy(ax: Axes, d: Diagnosis, entry: Any) -> None:
    """One parameter by record with 90 % bars; the joint estimate and its interval as a band."""
    values = {name: (float(value), float(std)) for name, (value, std) in entry["values"].items()}
    estimates = (each for effect in d.effects if _is_of(entry, effect) for each in effect.parameters)
    joint = next((each for each in estimates if each.name == entry["parameter"]), None)
    factor, unit = labelled_scale([value for value, _ in values.values()], entry["unit"])
    if joint is not None:
        ax.axvspan(factor * joint.low90, factor * joint.high90, color=ALTERNATIVE, alpha=0.35, lw=0)
        ax.axvline(factor * joint.value, color=AFTER, lw=0.8)
    for i, (value, std) in enumerate(values.values()):
        spread = NORMAL_90 * factor * std if np.isfinite(std) else 0.0
        colour = "black" if entry.get("constant", True) else MOVING
        ax.errorbar([factor * value], [i], xerr=[spread], fmt="o", ms=4, capsize=3, color=colour)
    moves = "" if entry.get("constant", True) else f": moves with {entry.get('moves_with') or 'the record'}"
    ax.set(yticks=range(len(values)), yticklabels=list(values), ylim=(len(values) - 0.5, -0.5))
    ax.set_xlabel(f"{entry['parameter']} [{unit}]")
    ax.set_title(f"{place_words(entry['effect'], entry['at'])}{moves}")
    ax.margins(x=0.15)


def _is_of(entry: Any, effect: NamedEffect) -> bool:
    """Return True if a parameter by record is one of an effect."""
    places = (entry["at"],) if isinstance(entry["at"], str) else tuple(entry["at"])
    return (entry["effect"], places) == (effect.name, effect.places)


def of_effect(d: Diagnosis, effect: NamedEffect) -> Figure:
    """Return the gap that an effect repairs, and whether its parameters stay the same from record to
    record.
    """
    entries = [entry for entry in d.constancy if _is_of(entry, effect)]
    heights = [1.7, *(0.2 * (1 + len(entry["values"])) for entry in entries)]
    left = max(LEFT, margin_for([name for entry in entries for name in entry["values"]]))
    figure, axes = sheet(
        len(heights), 1, sum(heights), left=left, between=(0.0, TITLED), height_ratios=heights
    )
    if d.located is not None and d.main_signal in d.located.gaps:
        draw_of_effect(axes[0, 0], d, effect)
    else:
        _draw_in_time(axes[0, 0], d)
    legend_below(figure, axes[0, 0])
    for ax, entry in zip(axes[1:, 0], entries, strict=True):
        draw_constancy(ax, d, entry)
    return figure


def _draw_in_time(ax: Axes, d: Diagnosis) -> None:
    """Draw the gap along the record that has the largest, in its largest direction."""
    known = {name: gaps["nominal model"] for name in d.before if (gaps := sides(d, name))}
    record = max(known, key=lambda name: known[name].rms["total"] or 0.0)
    gap, name = known[record], worst(known[record])
    factor, unit = labelled_scale([gap.max[name]], gap.unit)
    draw(ax, sides(d, record), name, factor)
    ax.set(xlabel=along(gap), ylabel=f"{label(gap, name)} [{unit}]", title=f"{record}: measured − model")


def laws(d: Diagnosis) -> Figure | None:
    """Return the curves of the two best laws side by side; None without a law."""
    shown = [law for law in d.laws if law.x][:2]
    if not shown:
        return None
    figure, axes = sheet(1, len(shown), 2.6, between=(0.7, 0.0))
    for ax, law in zip(axes[0], shown, strict=True):
        draw_law(ax, law)
    legend_below(figure, axes[0, 0])
    return figure


def draw_law(ax: Axes, law: LawCurve) -> None:
    """Draw a curve with its band, and the latent motion over its state."""
    factor, unit = labelled_scale(law.value, law.unit)
    value, low, high = (factor * np.array(each) for each in (law.value, law.low90, law.high90))
    if law.cloud_x:
        cloud = factor * np.array(law.cloud_value)
        ax.plot(law.cloud_x, cloud, ".", ms=2, color=BEFORE, label="latent motion")
    if law.of == "pose":  # in no order
        ax.errorbar(law.x, value, (value - low, high - value), fmt=".", color=AFTER, label="90 % interval")
    else:
        ax.fill_between(law.x, low, high, alpha=0.3, color=AFTER, lw=0, label="90 % band")
        ax.plot(law.x, value, color=AFTER, label="curve")
    ax.set_xlabel(f"{law.of.replace('_', ' ')} [{law.of_unit}]")
    ax.set_ylabel(f"{law.quantity} [{unit}]")
    ax.set_title(f"{law.at}: {law.kind}")


def law_rows(d: Diagnosis) -> list[dict[str, Any]]:
    """Return the words of each law: place, kind, probability, sentence, and the gap without and with it."""
    return [
        {
            "place": f"{law.quantity} of {law.at}",
            "kind": law.kind,
            "probability": probability(law.probability),
            "says": f"{law.says[:1].upper()}{law.says[1:]}.",
            "train": _shrinks(law.train, d.unit),
            "held_out": _shrinks(law.held_out, d.unit),
        }
        for law in d.laws
    ]


def _shrinks(gap: LawGap, unit: str) -> str:
    if gap.before_rms is None or gap.after_rms is None:
        return "–"
    noise = "" if gap.noise_rms is None else f" (noise {with_unit(gap.noise_rms, unit)})"
    return f"{with_unit(gap.before_rms, unit)} → {with_unit(gap.after_rms, unit)}{noise}"
