"""The directory of a plan: plan.json for programs, plan.html for a person, the figures."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.diagnosis.experiments.plan_curves import draw_matrix, draw_sizes, near_effects
from flexarm.diagnosis.wording import listed, number, place_words
from flexarm.report.diagnosis_page import effect_law
from flexarm.report.files import Drawing, drawn, write_files
from flexarm.report.sheets import margin_for, sheet
from flexarm.report.template import filled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexarm.diagnosis.experiments.plan_result import Plan

FILE, PAGE = "plan.json", "plan.html"
"""Names of the files beside the figures."""
MOST_RIVALS = 3
"""Effects that one could be taken for which are written out; the rest is counted."""
ROW = 0.19
"""Height of an effect in a figure [in]."""


def write(plan: Plan, directory: Path) -> None:
    """Writes plan.json, plan.html and the figures into a directory that is there."""
    figures = drawings(plan)
    write_files(directory, figures, (PAGE, page(plan, figures)), (FILE, plan.to_json_dict()))


def drawings(plan: Plan) -> list[Drawing]:
    """Both figures, drawn."""
    return drawn(_figures(plan), bbox_inches="tight")


def page(plan: Plan, figures: list[Drawing]) -> str:
    """The page as HTML."""
    headline = plan.headline()
    return filled(
        "plan.html.j2",
        p=plan,
        headline=headline[:1].upper() + headline[1:],
        effects=list(_effect_rows(plan)),
        groups=[listed([place_words(*plan.effects[i].place) for i in group]) for group in plan.groups],
        additions=plan.additions(),
        ties=list(_tie_rows(plan)),
        drawn={drawing.name: drawing for drawing in figures},
    )


def _figures(plan: Plan) -> Iterator[tuple[str, str, str, Figure]]:
    labels = [place_words(*each.place) for each in plan.effects]
    margin = margin_for(labels, 7)
    figure, axes = sheet(1, 1, ROW * len(labels) + 0.2, left=margin, legend=False)
    draw_sizes(plan, axes[0, 0])
    yield (
        "smallest-sizes",
        "smallest-sizes",
        "The smallest size of each effect that this experiment would detect, over a plausible size (dashed). "
        "Grey: not seen at a plausible size.",
        figure,
    )
    margin = margin_for([labels[i] for i in near_effects(plan)] or labels, 7)
    figure, axes = sheet(1, 1, 6.4 - 0.14, left=margin, legend=False)
    draw_matrix(plan, axes[0, 0])
    axes[0, 0].set_anchor("N")
    yield (
        "matrix",
        "matrix",
        "If the effect of a row is there, could that of a column be named? Red: they cannot be told apart "
        "(expected ln Bayes factor below ln 20); pale: hardly; blue: well. Grey: itself, or not seen. "
        "Effects that are told well from all others are left out.",
        figure,
    )


def _effect_rows(plan: Plan) -> Iterator[dict[str, Any]]:
    for i, each in enumerate(plan.effects):
        rivals = [place_words(*plan.effects[j].place) for j in plan.rivals(i)] if each.seen else []
        more = len(rivals) - MOST_RIVALS if len(rivals) > MOST_RIVALS + 1 else 0
        yield {
            "title": place_words(*each.place),
            "what": effect_law(each.name),
            "least": each.least_words,
            "value": each.value_words,
            "evidence": number(each.log_bayes_factor),
            "seen": each.seen,
            "hidden": each.hidden,
            "rivals": rivals,
            "more": more,
            "shown": ", ".join(rivals[:MOST_RIVALS]) + f" and {more} more" if more else ", ".join(rivals),
        }


def _tie_rows(plan: Plan) -> Iterator[dict[str, Any]]:
    for tie in plan.ties:
        best = tie.cheapest
        yield {
            "pair": f"{place_words(*tie.one)} | {place_words(*tie.other)}",
            "before": number(tie.log_bayes_factor, 2),
            "addition": best.addition if best else "nothing on the menu",
            "minutes": f"{best.minutes:g}" if best else "–",
            "after": number(best.log_bayes_factor) if best else "–",
        }
