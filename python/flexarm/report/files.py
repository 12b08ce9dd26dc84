"""The files of a report: sheets with axes, images, pages and texts from templates, the object for programs.

Sheets are as wide as a page on a phone can show. Margins are stated in inches: an engine that measures every
label to find them takes as long as the drawing.
"""

from __future__ import annotations

import base64
import json
import re
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm import wording
from flexarm.output import FIGURE, write_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


STYLE: Any = {
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.labelsize": 9,
    "legend.fontsize": 8,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.1,
    "legend.framealpha": 0.9,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 300,
    "pdf.fonttype": 42,
}


@contextmanager
def style() -> Iterator[None]:
    """Draw without a screen, in the style of a journal."""
    import matplotlib as mpl

    with mpl.rc_context(STYLE):
        yield


@dataclass(frozen=True)
class Drawing:
    """A figure of a page: name of its file without `.png`, section of the page, caption, and the image."""

    name: str
    section: str
    caption: str
    png: bytes

    @property
    def address(self) -> str:
        """The image itself as an address, so that the page fetches nothing."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode()


def drawn(figures: Iterable[tuple[str, str, str, Figure | None]], **options: Any) -> list[Drawing]:
    """Draw figures as images once, for their files and the page, in the style of a journal.

    Each comes as name, section, caption and figure; one that is None is left out. Options are those of
    `Figure.savefig`.
    """
    found = []
    with style():
        for name, section, caption, figure in figures:
            if figure is not None:
                content = BytesIO()
                figure.savefig(content, format="png", dpi=170, metadata={"Software": FIGURE}, **options)
                found.append(Drawing(name, section, caption, content.getvalue()))
    return found


def write_files(
    directory: Path, drawings: Sequence[Drawing], page: tuple[str, str], report: tuple[str, Mapping[str, Any]]
) -> None:
    """Write figures, page and JSON file (name and content, numbers finite) into a directory that exists."""
    for drawing in drawings:
        write_file(directory / f"{drawing.name}.png", drawing.png)
    name, html = page
    write_file(directory / name, html)
    name, content = report
    text = json.dumps(content, indent=2, allow_nan=False)
    write_file(directory / name, text + "\n")


def filled(template: str, filters: Mapping[str, Callable[..., Any]] | None = None, **values: Any) -> str:
    """Return a template of this folder with its values; a missing value is an error.

    Functions of `flexarm.wording` are known to all templates, as filters too. Values are escaped in pages.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("flexarm.report", "."),
        autoescape=template.endswith(".html.j2"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    words = {name: value for name, value in vars(wording).items() if callable(value)}
    environment.globals |= words
    environment.filters |= {**words, "wrapped": wrapped, **(filters or {})}
    return environment.get_template(template).render(**values)


def text_of(template: str, **values: Any) -> str:
    """Return a text from a template, its parts one blank line apart; empty ones leave none."""
    return re.sub(r"\n{3,}", "\n\n", filled(template, **values)).strip("\n")


def wrapped(text: str, indent: str = "", then: str | None = None) -> str:
    """Return a text in lines of a terminal, indented as the first one or by `then` from the second on."""
    return textwrap.fill(
        text,
        100,
        initial_indent=indent,
        subsequent_indent=indent if then is None else then,
        break_long_words=False,
        break_on_hyphens=False,
    )


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
