"""Sheets with axes, as wide as a page on a phone can show."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 6.4
"""Of every sheet [in]."""
WIDE = 30.0
"""Ratio of values beyond which an axis is logarithmic."""


def sheet(rows: int, columns: int, height: float, **options: Any) -> tuple[Figure, Any]:
    """Axes in rows and columns, without pyplot's global state.

    Parameters
    ----------
    rows, columns : int
        Of the axes.
    height : float
        Of the sheet [in].
    **options
        As of `Figure.subplots`.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height))
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, columns, squeeze=False, **options)
    for ax in axes.flat:
        ax.set_axisbelow(True)
    return figure, axes


def legend_below(figure: Figure, ax: Axes) -> None:
    """The legend of one of the axes below all, where it hides nothing."""
    handles, labels = ax.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)


def write_beside(ax: Axes, bars: Any, texts: Sequence[str]) -> None:
    """A text at the end of each bar, legible on lines too."""
    behind = {"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85}
    ax.bar_label(bars, texts, padding=3, fontsize=8, bbox=behind)


def log_if_wide(ax: Axes, which: str, values: Sequence[float]) -> None:
    """A logarithmic axis, with plain numbers, where a linear one would hide the small values."""
    positive = [value for value in values if value > 0]
    if not positive or max(positive) < WIDE * min(positive):
        return
    ax.set(**{f"{which}scale": "log"})
    axis = ax.yaxis if which == "y" else ax.xaxis
    axis.set_major_formatter(lambda value, _: f"{value:g}")
