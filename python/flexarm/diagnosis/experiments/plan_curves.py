"""Pictures of a plan: which effect would be taken for which, and how small an effect is still seen."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexarm.diagnosis.choosing.acceptance import REACH, STRONG
from flexarm.diagnosis.experiments.plan_result import FAR
from flexarm.diagnosis.wording import place_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from flexarm.diagnosis.experiments.plan_result import Plan

HARDLY = 10 * REACH
"""Expected ln Bayes factor below which two effects are hardly told apart."""
TIED, PARTED, CLEAR, UNSEEN = "#d55e00", "#f0c08a", "#0072b2", "#dddddd"
"""Colours of a pair: not told apart, hardly (up to ten times ln 20), well; of an effect that is not seen."""


def near_effects(plan: Plan) -> list[int]:
    """Effects, by number, that are not told well from some other one; all if there is none such.

    Of an effect that is hardly seen every wrong name is hardly told: it is near those only that explain more
    than half of the evidence for it, or that are tied with it.
    """
    own = np.array([each.log_bayes_factor for each in plan.effects])
    seen = np.array([each.seen for each in plan.effects], dtype=bool)
    factors = plan.log_bayes_factor
    hardly = (factors < HARDLY) & (factors < own[:, None] / 2) & seen
    near = seen[:, None] & ((factors < REACH) | hardly)
    np.fill_diagonal(near, False)
    found = np.flatnonzero(near.any(axis=0) | near.any(axis=1))
    return found.tolist() if len(found) else list(range(len(seen)))


def draw_matrix(plan: Plan, ax: Axes | None = None) -> Axes:
    """Rows: the effect that is there; columns: the one that is named. Only effects that are near another."""
    from matplotlib.colors import BoundaryNorm, ListedColormap

    ax = ax if ax is not None else _axes()
    shown = near_effects(plan)
    effects = [plan.effects[i] for i in shown]
    seen = np.array([each.seen for each in effects])
    values = np.clip(plan.log_bayes_factor[np.ix_(shown, shown)], 1e-3, 1e9)
    values = np.where(seen[:, None], values, np.nan)
    np.fill_diagonal(values, np.nan)
    colours = ListedColormap([TIED, PARTED, CLEAR]).with_extremes(bad=UNSEEN)
    norm = BoundaryNorm([0.0, REACH, HARDLY, 1e10], 3)
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


def draw_sizes(plan: Plan, ax: Axes | None = None) -> Axes:
    """The smallest detectable size of every effect over its plausible one, smallest first."""
    ax = ax if ax is not None else _axes()
    shown = sorted((e for e in plan.effects if e.log_bayes_factor > 0), key=lambda each: each.times)
    labels = [place_words(*each.place) for each in shown]
    times = [min(each.times, FAR) for each in shown]
    colours = [CLEAR if each.seen else UNSEEN for each in shown]
    bars = ax.barh(labels, times, color=colours)
    ax.axvline(1.0, color="black", lw=0.8, ls="--", zorder=0.9)
    behind = {"facecolor": "white", "edgecolor": "none", "pad": 0.4, "alpha": 0.85}
    ax.bar_label(bars, [each.least_words for each in shown], padding=3, fontsize=7, bbox=behind)
    ax.set_xscale("log")
    if times:
        ax.set(xlim=(0.5 * min(times), 12 * max(times)), ylim=(-0.7, len(times) - 0.3))
    ax.tick_params(axis="y", labelsize=7)
    ax.set_xlabel(f"smallest detectable size (ln B = {STRONG:g}) over the plausible one [-]")
    ax.invert_yaxis()
    ax.tick_params(axis="y", length=0)
    ax.grid(visible=False, axis="y")
    return ax


def _axes() -> Axes:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 6.4), layout="constrained")
    FigureCanvasAgg(figure)
    return figure.subplots()
