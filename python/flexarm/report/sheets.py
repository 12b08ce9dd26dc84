"""Sheets with axes, as wide as a page on a phone can show.

Margins are stated in inches: an engine that measures every label to find them takes as long as the drawing.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 6.4
"""Of every sheet [in]."""
LEFT, RIGHT, TOP, BOTTOM, LEGEND = 0.66, 0.14, 0.28, 0.48, 0.26
"""Margins [in]: labels of the y axis, half a number, a title, labels of the x axis, a legend below them."""


def sheet(
    rows: int,
    columns: int,
    height: float,
    *,
    left: float = LEFT,
    between: tuple[float, float] = (0.0, 0.0),
    legend: bool = True,
    **options: Any,
) -> tuple[Figure, Any]:
    """Return a figure and its axes in rows and columns, without pyplot's global state.

    All sizes are in inches: the height is that of one row, or of all together with `height_ratios`; `left` is
    the margin for labels, `between` the space between columns and between rows. Options are as of
    `Figure.subplots`.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    inside = height if "height_ratios" in options else rows * height
    bottom = BOTTOM + (LEGEND if legend else 0.0)
    tall = bottom + inside + (rows - 1) * between[1] + TOP
    figure = Figure(figsize=(WIDTH, tall))
    figure.set_layout_engine("none")
    FigureCanvasAgg(figure)
    wide = (WIDTH - left - RIGHT - (columns - 1) * between[0]) / columns
    axes = figure.subplots(
        rows,
        columns,
        squeeze=False,
        gridspec_kw={
            "left": left / WIDTH,
            "right": 1 - RIGHT / WIDTH,
            "bottom": bottom / tall,
            "top": 1 - TOP / tall,
            "wspace": between[0] / wide,
            "hspace": between[1] / (inside / rows),
        },
        **options,
    )
    for ax in axes.flat:
        ax.set_axisbelow(True)
    return figure, axes


def margin_for(labels: Sequence[str], size: float = 9.0) -> float:
    """Left margin [in] that holds the longest of these labels at a size of font [pt]."""
    from matplotlib.textpath import TextPath

    widths = [TextPath((0, 0), label, size=size).get_extents().width for label in labels if label.strip()]
    return min(0.5 * WIDTH, 0.16 + max(widths, default=0.0) / 72)


def legend_below(figure: Figure, ax: Axes) -> None:
    """Draw the legend of one of the axes below all, where it hides nothing."""
    handles, labels = ax.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=4, frameon=False, borderaxespad=0.1)


def write_beside(ax: Axes, bars: Any, texts: Sequence[str]) -> None:
    """Write a text at the end of each bar, legible on lines too."""
    behind = {"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85}
    ax.bar_label(bars, texts, padding=3, fontsize=8, bbox=behind)


def log_if_wide(ax: Axes, which: str, values: Sequence[float]) -> None:
    """Set a logarithmic axis, with plain numbers, where a linear one would hide the small values."""
    positive = [value for value in values if value > 0]
    if not positive or max(positive) < 30 * min(positive):
        return
    ax.set(**{f"{which}scale": "log"})
    axis = ax.yaxis if which == "y" else ax.xaxis
    axis.set_major_formatter(lambda value, _: f"{value:g}")
