"""The files of a report: its figures, its page from a template, and the object for programs."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
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
    with style():
        return [
            Drawing(name, section, caption, _png(figure, **options))
            for name, section, caption, figure in figures
            if figure is not None
        ]


def _png(figure: Figure, **options: Any) -> bytes:
    content = BytesIO()
    figure.savefig(content, format="png", dpi=170, metadata={"Software": FIGURE}, **options)
    return content.getvalue()


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
    """Return a template of this folder with its values, which are escaped; a missing value is an error."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("flexarm.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= filters or {}
    return environment.get_template(template).render(**values)
