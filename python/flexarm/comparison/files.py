"""A comparison as files: its numbers, and a table and a picture of the gap of each signal."""

from __future__ import annotations

import json
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.output import SavedAsDirectory, stems, write_file
from flexarm.pictures import Summarised

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NUMBERS = "comparison.json"


class SavedGap(SavedAsDirectory, Summarised):
    """Base of comparisons, which writes them into a directory."""

    def to_json_dict(self) -> dict[str, Any]:
        """Return the object of `flexarm compare --json`."""
        raise NotImplementedError

    def tables(self) -> Mapping[str, pd.DataFrame]:
        """Return the gap of each signal by row."""
        raise NotImplementedError

    def plot(self, ax: Axes | None = None, signal: str | None = None) -> Axes:
        """Draw the gap of a signal."""
        raise NotImplementedError

    def draw(self, figure: Figure, signal: str) -> None:
        """Fill a figure with the picture of a signal."""
        self.plot(figure.subplots(), signal)

    def write(self, directory: Path) -> None:
        """Write comparison.json, and of each signal that does not drive `gap-NAME.csv` and `gap-NAME.png`.

        The JSON file holds what `flexarm compare --json` prints.
        """
        numbers = json.dumps(self.to_json_dict(), indent=2, allow_nan=False)
        write_file(directory / NUMBERS, numbers + "\n")
        tables = self.tables()
        for (name, table), stem in zip(tables.items(), stems(list(tables)), strict=True):
            write_file(directory / f"gap-{stem}.csv", table.to_csv(index=False))
            write_file(directory / f"gap-{stem}.png", self._image(name))

    def _image(self, signal: str) -> bytes:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=(6.4, 4.8), layout="constrained")
        FigureCanvasAgg(figure)
        self.draw(figure, signal)
        content = BytesIO()
        figure.savefig(content, format="png", dpi=170)
        return content.getvalue()
