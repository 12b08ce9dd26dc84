"""Columns of a CSV file as arrays: fast, and exact about the place of what cannot be read.

The first line that is not a comment names the columns. Lines that start with `#` are comments, empty lines
are skipped, empty cells and `nan` are drop-outs.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidFile
from flexarm.tables.toml import read_text


class CsvFile:
    """A CSV file whose columns are read on demand.

    Parameters
    ----------
    path : Path
        The file.
    named : str or Path, optional
        The file as messages name it.

    Raises
    ------
    InvalidFile
        If it cannot be read, has no header or no rows.
    """

    def __init__(self, path: Path, named: str | Path | None = None) -> None:
        self.file = named or path
        try:
            text = read_text(path)
        except InvalidFile as error:
            problem = error.problems[0]
            raise InvalidFile(self.file, problem.where, problem.what) from None
        lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
        self._numbers = [
            i for i, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")
        ]
        if not self._numbers:
            raise InvalidFile(self.file, "line 1", "has no header; the first line must name the columns")
        self.header = self._header(lines[self._numbers.pop(0)])
        self._lines = [lines[i] for i in self._numbers]
        if not self._lines:
            raise InvalidFile(self.file, f"line {len(lines)}", "has a header and no rows")

    def _header(self, line: str) -> list[str]:
        header = [name.strip() for name in self._cells(line)]
        doubled = {name for name in header if header.count(name) > 1 and name}
        if doubled:
            raise InvalidFile(self.file, "header", f"column {min(doubled)!r} stands there twice")
        return header

    def _cells(self, line: str) -> list[str]:
        try:
            return next(csv.reader([line]))
        except csv.Error as error:
            raise InvalidFile(self.file, "CSV", f"cannot be read: {error}") from None

    def line(self, row: int) -> int:
        """Line number of a row, counted from 1."""
        return self._numbers[row] + 1

    def index(self, column: str) -> int | None:
        """Position of a column, None if it does not exist."""
        return self.header.index(column) if column in self.header else None

    def texts(self, column: str) -> list[str]:
        """The cells of a column as they stand."""
        index = self.header.index(column)
        return [row[index].strip() for _, row in self._rows()]

    def numbers(self, columns: Sequence[str]) -> Floats:
        """Columns as an array of shape (rows, columns), drop-outs as NaN.

        Raises
        ------
        InvalidFile
            With line and column of the first cell that is neither a number nor a drop-out.
        """
        where = [self.header.index(column) for column in columns]
        values = self._fast(where)
        if values is None:
            values = np.array([[self._number(number, row, i) for i in where] for number, row in self._rows()])
        if np.isinf(values).any():
            row, column = np.argwhere(np.isinf(values))[0]
            raise self._bad_cell(self.line(row), where[column], "an infinite number")
        return values

    def _fast(self, where: list[int]) -> Floats | None:
        """The columns by NumPy's reader, or None where a cell needs a closer look."""
        commas = len(self.header) - 1
        if any(line.count(",") != commas for line in self._lines):
            return None
        try:
            values = np.loadtxt(_filled(self._lines), delimiter=",", usecols=where, comments=None, ndmin=2)
        except ValueError:
            return None
        return np.asarray(values, dtype=float)

    def _rows(self) -> Iterable[tuple[int, list[str]]]:
        """Line numbers and cells, all rows as long as the header."""
        for row, line in enumerate(self._lines):
            cells = self._cells(line)
            if len(cells) != len(self.header):
                raise InvalidFile(
                    self.file,
                    f"line {self.line(row)}",
                    f"has {len(cells)} cells, the header has {len(self.header)}: {line[:60]!r}",
                )
            yield self.line(row), cells

    def _number(self, line: int, row: list[str], column: int) -> float:
        cell = row[column].strip()
        if not cell:
            return float("nan")
        try:
            if "_" in cell:  # Python's float() takes 1_000
                raise ValueError
            return float(cell)
        except ValueError:
            raise self._bad_cell(line, column, repr(cell[:40])) from None

    def _bad_cell(self, line: int, column: int, got: str) -> InvalidFile:
        return InvalidFile(
            self.file,
            f"line {line}, column {self.header[column]}",
            f"must be a number, got {got}; a drop-out is an empty cell or nan",
        )


def _filled(lines: list[str]) -> list[str]:
    """Lines with `nan` in empty cells, for a reader that takes no empty ones."""
    text = "\n".join(lines)
    if not (",," in text or ",\n" in text or "\n," in text or text.startswith(",") or text.endswith(",")):
        return lines
    for _ in range(2):  # twice: ",,," holds overlapping pairs
        text = text.replace(",,", ",nan,")
    text = text.replace(",\n", ",nan\n").replace("\n,", "\nnan,")
    text = f"nan{text}" if text.startswith(",") else text
    return (f"{text}nan" if text.endswith(",") else text).split("\n")
