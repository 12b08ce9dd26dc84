"""Excel and OpenDocument: a sheet is a topic, its first row of numbers follows the names."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date, datetime, time, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.arm.consistency import missing
from flexarm.importing.delimited_text import header_of
from flexarm.importing.map_file import Dialect
from flexarm.importing.source import Array, Group, Request, Source, Unreadable, needed

Rows = list[list[Any]]


class Spreadsheet(Source):
    """A spreadsheet; without a topic its first sheet."""

    def __init__(self, path: Path, dialect: Dialect, requests: Sequence[Request]) -> None:
        super().__init__(path, dialect, requests)
        self._book = needed("python_calamine", path).CalamineWorkbook.from_path(path)
        self._sheets: dict[str, tuple[list[str], list[str], list[int], Rows]] = {}

    def _sheet(self, topic: str | None) -> tuple[list[str], list[str], list[int], Rows]:
        """Return names, units, the numbers of the rows that are not empty, and these rows."""
        sheets = list(self._book.sheet_names)
        name = sheets[0] if topic is None else topic
        if name not in sheets:
            raise Unreadable("topic", missing("sheet", name, sheets))
        if name not in self._sheets:
            rows = self._book.get_sheet_by_name(name).to_python(skip_empty_area=False)
            self._sheets[name] = self._split(rows)
        return self._sheets[name]

    def _split(self, rows: Rows) -> tuple[list[str], list[str], list[int], Rows]:
        tail = rows[len(rows) // 2 :]
        count = max(map(len, rows), default=0)
        numeric = [2 * sum(_is_value(row[i]) for row in tail) > len(tail) for i in range(count)]
        first = self.dialect.header_rows
        if first is None:
            first = next((k for k, row in enumerate(rows) if _fits(row, numeric)), len(rows))
        above = [[str(cell) for cell in row] for row in rows[:first] if any(cell != "" for cell in row)]
        names, units = header_of(above, count, "#")
        names = list(self.dialect.columns) or [*names, *[""] * (count - len(names))]
        filled = [k for k in range(first, len(rows)) if any(cell != "" for cell in rows[k])]
        return names, units, [k + 1 for k in filled], [rows[k] for k in filled]

    def names(self, topic: str | None) -> list[str]:
        """Return the names of the columns of a sheet."""
        return self._sheet(topic)[0]

    def groups(self) -> list[Group]:
        """Return the sheets."""
        found = [(name, *self._sheet(name)) for name in self._book.sheet_names]
        return [
            Group(name, tuple(names), units=tuple(units)) for name, names, units, _, rows in found if rows
        ]

    def time_unit(self, topic: str | None, index: int) -> str:
        """Return the unit of a column, where a row gives it."""
        return dict(enumerate(self._sheet(topic)[1])).get(index, "")

    def array(self, topic: str | None, index: int) -> Array:
        """Return a column."""
        cells = [row[index] for row in self._sheet(topic)[3]]
        filled = [cell for cell in cells if cell != ""]
        if filled and all(isinstance(cell, datetime | date) for cell in filled):
            return np.array([None if cell == "" else cell for cell in cells], dtype="datetime64[us]")
        if filled and all(isinstance(cell, time | timedelta) for cell in filled):
            return np.array([_of_day(cell) for cell in cells])
        if any(isinstance(cell, str) for cell in filled):
            return np.array(cells, dtype=object)
        return np.array([np.nan if cell == "" else float(cell) for cell in cells])

    def place(self, topic: str | None, row: int) -> str:
        """Return the row as the program that wrote it counts."""
        return f"row {self._sheet(topic)[2][row]}"


def _is_value(cell: Any) -> bool:
    return cell != "" and not isinstance(cell, str)


def _fits(row: Sequence[Any], numeric: Sequence[bool]) -> bool:
    asked = [cell for cell, wanted in zip(row, numeric, strict=False) if wanted]
    return any(map(_is_value, asked)) and all(cell == "" or _is_value(cell) for cell in asked)


def _of_day(cell: Any) -> np.timedelta64:
    """Return a time of the day."""
    if cell == "":
        return np.timedelta64("NaT")
    whole = cell if isinstance(cell, timedelta) else datetime.combine(date.min, cell) - datetime.min
    return np.timedelta64(whole, "us")
