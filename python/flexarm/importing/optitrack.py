"""OptiTrack's CSV of Motive: names of bodies and markers stand in several lines above the rows.

A column is named `BODY.Rotation.X`, `BODY.Position.X` or `MARKER.Position.X`; stamps: `Time (Seconds)`.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from flexarm.errors import InvalidFile
from flexarm.importing.delimited_text import DelimitedText
from flexarm.importing.map_file import Dialect
from flexarm.importing.source import Request


class OptiTrack(DelimitedText):
    """A CSV file of Motive."""

    def __init__(self, path: Path, dialect: Dialect, requests: Sequence[Request]) -> None:
        furthest = 20  # lines above the rows: Motive writes up to eight
        with path.open(encoding="utf-8-sig", errors="replace") as file:
            rows = list(csv.reader(line for line, _ in zip(file, range(furthest), strict=False)))
        last = next((k for k, row in enumerate(rows) if row[:1] == ["Frame"]), None)
        kinds = next((k for k, row in enumerate(rows) if row[2:] and not any(row[:1])), None)
        if last is None or kinds is None or kinds + 1 >= last:
            raise InvalidFile(path, "line 1", "has no names as Motive writes them above Frame, Time")
        bodies, what, axes = rows[kinds + 1], rows[last - 1], rows[last]
        names = [
            ".".join(part for part in (body, quantity, axis) if part)
            for body, quantity, axis in zip(bodies, what, axes, strict=False)
        ]
        known = Dialect(separator=",", decimal=".", header_rows=last + 1, columns=tuple(names))
        super().__init__(path, known, requests)
