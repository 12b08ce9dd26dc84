"""A plan as a directory (plan.json for programs, plan.html for a person, figures) and as text in a terminal.

Figures show which effect would be taken for which, and how small an effect is still seen.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.json_values import plain
from flexarm.report.diagnosis import effect_law
from flexarm.report.files import Drawing, drawn, filled, margin_for, sheet, text_of, write_files
from flexarm.wording import listed, number, place_words, with_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from flexarm.diagnosis.design.plan_result import Plan, PlannedEffect


FILE, PAGE = "plan.json", "plan.html"
"""Names of the files."""


def write(plan: Plan, directory: Path) -> None:
    """Write plan.json, plan.html and the figures into a directory that is there."""
    figures = drawn(_figures(plan), bbox_inches="tight")
    write_files(directory, figures, (PAGE, page(plan, figures)), (FILE, plan.to_json_dict()))


def page(plan: Plan, figures: list[Drawing]) -> str:
    """Return the page as HTML."""
    headline = plan.headline()
    return filled(
        "plan.html.j2",
        p=plan,
        headline=headline[:1].upper() + headline[1:],
        effects=list(_effect_rows(plan)),
        groups=group_words(plan),
        additions=plan.additions(),
        effect_law=effect_law,
        drawn={drawing.name: drawing for drawing in figures},
    )


def _figures(plan: Plan) -> Iterator[tuple[str, str, str, Figure]]:
    labels = [place_words(*each.place) for each in plan.effects]
    margin = margin_for(labels, 7)
    figure, axes = sheet(1, 1, 0.19 * len(labels) + 0.2, left=margin, legend=False)
    draw_sizes(plan, axes[0, 0])
    what = (
        "The smallest size of each effect that this experiment would detect, over a plausible size (dashed). "
        "Grey: not seen at a plausible size."
    )
    yield "smallest-sizes", "smallest-sizes", what, figure
    margin = margin_for([labels[i] for i in near_effects(plan)] or labels, 7)
    figure, axes = sheet(1, 1, 6.4 - 0.14, left=margin, legend=False)
    draw_matrix(plan, axes[0, 0])
    axes[0, 0].set_anchor("N")
    what = (
        "If the effect of a row is there, could that of a column be named? Red: they cannot be told apart "
        "(expected ln Bayes factor below ln 20); pale: hardly; blue: well. Grey: itself, or not seen. "
        "Effects that are told well from all others are left out."
    )
    yield "matrix", "matrix", what, figure


def group_words(plan: Plan) -> list[str]:
    """Return the effects of each indistinguishable group as text."""
    return [listed([place_words(*plan.effects[i].place) for i in group]) for group in plan.groups]


def least_words(effect: PlannedEffect) -> str:
    """Return the smallest detectable size as text: a value, or a change of the nominal one."""
    if not effect.detectable:
        return "not seen"
    if effect.null == inf:
        return f"softer than {with_unit(effect.least, effect.unit)}"
    size = with_unit(abs(effect.least - effect.null), effect.unit)
    return f"± {size}" if effect.null else size


def value_words(effect: PlannedEffect) -> str:
    """Return the plausible size as text; of a change below 5 % the change."""
    change = effect.value - effect.null
    if isfinite(effect.null) and 0 < abs(change) < 0.05 * abs(effect.null):
        sign = "+" if change > 0 else "-"
        return f"{effect.parameter} = {effect.null:g} {sign} {with_unit(abs(change), effect.unit)}"
    return f"{effect.parameter} = {with_unit(effect.value, effect.unit)}"


def _evidence(log_bayes_factor: float) -> str:
    """Return ln B; below a thousandth it is rounding."""
    return number(0.0 if abs(log_bayes_factor) < 1e-3 else log_bayes_factor)


def _effect_rows(plan: Plan) -> Iterator[dict[str, Any]]:
    for i, each in enumerate(plan.effects):
        rivals = [place_words(*plan.effects[j].place) for j in plan.rivals(i)] if each.seen else []
        more = len(rivals) - 3 if len(rivals) > 4 else 0
        yield {
            "planned": each,
            "least": least_words(each),
            "value": value_words(each),
            "evidence": _evidence(each.log_bayes_factor),
            "rivals": rivals,
            "more": more,
            "shown": ", ".join(rivals[:3]) + f" and {more} more" if more else ", ".join(rivals),
        }


TIED, PARTED, CLEAR, UNSEEN = "#d55e00", "#f0c08a", "#0072b2", "#dddddd"
"""Colours of a pair: indistinguishable, hardly separated (up to ten times ln 20), well; of an unseen effect.
"""


def near_effects(plan: Plan) -> list[int]:
    """Return numbers of effects that are not well separated from some other one; all if there are none.

    An effect that is hardly seen is hardly separated from any: it is near those only that explain more than
    half of the evidence for it, or that are indistinguishable from it.
    """
    reach = plan.thresholds["parted"]
    own = np.array([each.log_bayes_factor for each in plan.effects])
    seen = np.array([each.seen for each in plan.effects], dtype=bool)
    factors = plan.log_bayes_factor
    hardly = (factors < 10 * reach) & (factors < own[:, None] / 2) & seen
    near = seen[:, None] & ((factors < reach) | hardly)
    np.fill_diagonal(near, False)
    found = np.flatnonzero(near.any(axis=0) | near.any(axis=1))
    return found.tolist() if len(found) else list(range(len(seen)))


def draw_matrix(plan: Plan, ax: Axes | None = None) -> Axes:
    """Rows: the effect that is there; columns: the one that is named. Only effects that are near another."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.figure import Figure

    if ax is None:
        figure = Figure(figsize=(6.4, 6.4), layout="constrained")
        FigureCanvasAgg(figure)
        ax = figure.subplots()
    shown = near_effects(plan)
    reach = plan.thresholds["parted"]
    effects = [plan.effects[i] for i in shown]
    seen = np.array([each.seen for each in effects])
    values = np.clip(plan.log_bayes_factor[np.ix_(shown, shown)], 1e-3, 1e9)
    values = np.where(seen[:, None], values, np.nan)
    np.fill_diagonal(values, np.nan)
    colours = ListedColormap([TIED, PARTED, CLEAR]).with_extremes(bad=UNSEEN)
    norm = BoundaryNorm([0.0, reach, 10 * reach, 1e10], 3)
    ax.imshow(values, cmap=colours, norm=norm, aspect="equal", interpolation="none")
    labels = [place_words(*each.place) for each in effects]
    ax.set_yticks(range(len(labels)), labels, fontsize=7)
    ax.set_xticks(range(len(labels)), labels, fontsize=7, rotation=90)
    ax.set_ylabel("there is")
    ax.set_xlabel("taken for")
    ax.grid(visible=False)
    for side in ax.spines.values():
        side.set_visible(False)
    return ax


def draw_sizes(plan: Plan, ax: Axes) -> None:
    """Draw the smallest detectable size of every effect over its plausible one, smallest first."""
    shown = sorted((e for e in plan.effects if e.log_bayes_factor > 0), key=lambda each: each.times)
    labels = [place_words(*each.place) for each in shown]
    times = [min(each.times, 10.0) for each in shown]
    colours = [CLEAR if each.seen else UNSEEN for each in shown]
    bars = ax.barh(labels, times, color=colours)
    ax.axvline(1.0, color="black", lw=0.8, ls="--", zorder=0.9)
    behind = {"facecolor": "white", "edgecolor": "none", "pad": 0.4, "alpha": 0.85}
    ax.bar_label(bars, [least_words(each) for each in shown], padding=3, fontsize=7, bbox=behind)
    ax.set_xscale("log")
    if times:
        ax.set(xlim=(0.5 * min(times), 12 * max(times)), ylim=(-0.7, len(times) - 0.3))
    ax.tick_params(axis="y", labelsize=7)
    ax.set_xlabel(
        f"smallest detectable size (ln B = {plan.thresholds['detected']:g}) over the plausible one [-]"
    )
    ax.invert_yaxis()
    ax.tick_params(axis="y", length=0)
    ax.grid(visible=False, axis="y")


FORMAT = "flexarm-plan/1"


def plan_dict(plan: Plan) -> dict[str, Any]:
    """Return the object of the file; what is infinite becomes null."""
    added = ("addition", "minutes", "log_bayes_factor", "parts")
    effects = [
        {
            **{key: getattr(each, key) for key in ("name", "at", "parameter", "unit", "value", "null")},
            "smallest_detectable": each.least if each.detectable else None,
            **{key: getattr(each, key) for key in ("log_bayes_factor", "seen", "hidden")},
        }
        for each in plan.effects
    ]
    content = {
        "format": FORMAT,
        "model": plan.arm.name,
        "runs": plan.runs,
        "assumed": plan.assumed,
        "thresholds": plan.thresholds,
        "effects": effects,
        "log_bayes_factor": plan.log_bayes_factor,
        "groups": [_places(plan.effects[i].place for i in group) for group in plan.groups],
        "ties": [
            {
                "effects": _places((tie.one, tie.other)),
                "log_bayes_factor": tie.log_bayes_factor,
                "additions": [{key: getattr(each, key) for key in added} for each in tie.partings],
            }
            for tie in plan.ties
        ],
        "provenance": plan.provenance,
    }
    found: dict[str, Any] = plain(content)
    return found


def _places(places: Iterable[tuple[str, str]]) -> list[dict[str, str]]:
    return [{"name": name, "at": at} for name, at in places]


def headline(plan: Plan) -> str:
    """Return the plan in a sentence."""
    seen = [e for e in plan.effects if e.seen]
    text = (
        f"of {len(plan.effects)} effects the experiment would show {len(seen)} at a plausible size and "
        f"tell {len(plan.alone())} of them from all others"
    )
    if not plan.ties:
        return text + "."
    words, minutes, count = plan.additions()[0] if plan.additions() else ("", 0.0, 0)
    if not count:
        return text + f"; nothing on the menu parts any of the {len(plan.ties)} tied pairs."
    return text + (
        f"; a run {words} (some {minutes:g} min) would part {count} of the {len(plan.ties)} tied pairs."
    )


def summary(plan: Plan) -> str:
    """All that matters on one screen."""
    return text_of(
        "plan.txt.j2",
        p=plan,
        headline=headline(plan),
        effects="\n".join(_effect_lines(plan)),
        groups=group_words(plan),
        most=12,  # pairs; plan.json has all
    )


def _effect_lines(plan: Plan) -> Iterator[str]:
    """Yield the effects as a table with columns that align."""
    rows = [("effect", "smallest detectable", "at plausible", "ln B", "taken for, or why not seen")]
    for i, each in enumerate(plan.effects):
        rivals = [place_words(*plan.effects[j].place) for j in plan.rivals(i)]
        shown = ", ".join(rivals[:2]) + (f" and {len(rivals) - 2} more" if len(rivals) > 2 else "")
        told = shown if each.seen else each.hidden
        sizes = least_words(each), value_words(each), _evidence(each.log_bayes_factor)
        rows.append((place_words(*each.place), *sizes, told))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        yield "  ".join(f"{cell:<{w}}" for cell, w in zip(row, widths, strict=True)).rstrip()
