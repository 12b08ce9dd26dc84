"""The files of a report: its figures, its page, and the object for programs."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.output import FIGURE, write_file

if TYPE_CHECKING:
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
DOTS = 170
"""Resolution [per inch]: sharp at the page's full width."""


@contextmanager
def style() -> Iterator[None]:
    """Draw without a screen, in the style of a journal."""
    import matplotlib as mpl

    with mpl.rc_context(STYLE):
        yield


@dataclass(frozen=True)
class Drawing:
    """A figure of a page.

    Attributes
    ----------
    name : str
        Of its file, without `.png`.
    section : str
        Where on the page it stands.
    caption : str
        What it shows.
    png : bytes
        The image.
    """

    name: str
    section: str
    caption: str
    png: bytes

    @property
    def address(self) -> str:
        """The image itself as an address, so that the page fetches nothing."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode()


def drawn(figures: Iterable[tuple[str, str, str, Figure | None]], **options: Any) -> list[Drawing]:
    """Draw figures as images once, for their files and the page.

    Parameters
    ----------
    figures : iterable of (str, str, str, Figure or None)
        Name, section, caption and figure; made here, in the style of a journal. What is None is left out.
    **options
        As of `Figure.savefig`.
    """
    with style():
        return [
            Drawing(name, section, caption, _png(figure, **options))
            for name, section, caption, figure in figures
            if figure is not None
        ]


def _png(figure: Figure, **options: Any) -> bytes:
    content = BytesIO()
    figure.savefig(content, format="png", dpi=DOTS, metadata={"Software": FIGURE}, **options)
    return content.getvalue()


def write_files(
    directory: Path, drawings: Sequence[Drawing], page: tuple[str, str], report: tuple[str, Mapping[str, Any]]
) -> None:
    """Write figures, page and object into a directory that exists.

    Parameters
    ----------
    directory : Path
        See `flexarm.output.output_directory` for one that is whole or not there.
    drawings : sequence of Drawing
        The figures.
    page, report : (str, str) and (str, dict)
        Name and content of the page and of the JSON file; numbers must be finite.
    """
    for drawing in drawings:
        write_file(directory / f"{drawing.name}.png", drawing.png)
    name, html = page
    write_file(directory / name, html)
    name, content = report
    text = json.dumps(content, indent=2, allow_nan=False)
    write_file(directory / name, text + "\n")
