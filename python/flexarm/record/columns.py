"""Columns of a CSV file as arrays: fast, and exact about the place of what cannot be read.

The first line that is not a comment names the columns. Lines that start with `#` are comments, empty lines
are skipped, empty cells and `nan` are drop-outs.

The core reads the file block by block, so that memory holds the columns and one block. Where it meets a cell
that is no plain number, the file is read once more, row by row, by the rules of this page.
"""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import TextIO

import numpy as np

from flexarm import _core
from flexarm.arrays import Floats
from flexarm.errors import InvalidFile
from flexarm.tables.toml import read_text

BLOCK = 1 << 20
"""Characters that are read at once: many lines, and little memory beside their columns."""


class CsvFile:
    """A CSV file whose columns are read on demand; messages call it `named`.

    Raise InvalidFile if it cannot be read, has no header or no rows.
    """

    def __init__(self, path: Path, named: str | Path | None = None) -> None:
        self.file = named or path
        self._path = path
        self._text: str | None = None
        if not _is_file(path):  # a pipe gives its text once
            self._text = self._read()
        content = self._content()
        self._header_line, header = next(content, (0, ""))
        if not self._header_line:
            raise InvalidFile(self.file, "line 1", "has no header; the first line must name the columns")
        self.header = self._header(header)
        if next(content, None) is None:
            last = self._read().replace("\r\n", "\n").replace("\r", "\n").count("\n") + 1
            raise InvalidFile(self.file, f"line {last}", "has a header and no rows")

    def _read(self) -> str:
        if self._text is not None:
            return self._text
        try:
            return read_text(self._path)
        except InvalidFile as error:
            problem = error.problems[0]
            coded = isinstance(error.__cause__, UnicodeDecodeError)
            other = "; `flexarm import` reads other encodings" if coded else ""
            raise InvalidFile(self.file, problem.where, f"{problem.what}{other}") from None

    def _open(self) -> TextIO:
        if self._text is not None:
            return io.StringIO(self._text, newline=None)
        return self._path.open(encoding="utf-8-sig")

    def _content(self) -> Iterator[tuple[int, str]]:
        """Yield number and text of the lines that are neither empty nor comments, the header first."""
        try:
            with self._open() as file:
                for number, line in enumerate(file, 1):
                    if line.strip() and not line.lstrip().startswith("#"):
                        yield number, line.rstrip("\n")
        except (OSError, UnicodeDecodeError):
            self._read()  # says what is wrong
            raise

    def _header(self, line: str) -> list[str]:
        header = [name.strip() for name in self._cells(line)]
        other = next((mark for mark in ";\t|" if len(header) == 1 and mark in line.strip()), None)
        if other:
            what = f"cells are separated by {other!r}; allowed are commas, and points in decimals"
            raise InvalidFile(self.file, "header", f"{what}; `flexarm import` reads other forms")
        doubled = {name for name, count in Counter(header).items() if count > 1 and name}
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
        return next(islice(self._content(), row + 1, None))[0]

    def texts(self, column: str) -> list[str]:
        """Return the cells of a column as they stand."""
        index = self.header.index(column)
        return [row[index].strip() for _, row in self._rows()]

    def numbers(self, columns: Sequence[str]) -> Floats:
        """Return columns as an array of shape (rows, columns), drop-outs as NaN.

        Raise InvalidFile with line and column of the first cell that is neither a number nor a drop-out.
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
        """Return the columns as the core reads them, or None where a cell needs a closer look."""
        blocks = []
        try:
            with self._open() as file:
                for _ in range(self._header_line):
                    file.readline()
                while text := file.read(BLOCK) + file.readline():
                    rows = _core.number_rows(text, len(self.header), where)
                    if rows is None:
                        return None
                    blocks.append(rows)
        except UnicodeDecodeError:
            return None
        end = sum(map(len, blocks))
        values = np.empty((len(where), end))
        while blocks:  # from the end, so that each block gives its memory back
            rows = blocks.pop()
            values[:, end - len(rows) : end] = rows.T
            end -= len(rows)
        return values.T

    def _rows(self) -> Iterator[tuple[int, list[str]]]:
        """Line numbers and cells, all rows as long as the header."""
        for number, line in islice(self._content(), 1, None):
            cells = self._cells(line)
            if len(cells) != len(self.header):
                what = f"has {len(cells)} cells, the header has {len(self.header)}: {line[:60]!r}"
                raise InvalidFile(self.file, f"line {number}", what)
            yield number, cells

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
        what = f"must be a number, got {got}; a drop-out is an empty cell or nan"
        return InvalidFile(self.file, f"line {line}, column {self.header[column]}", what)


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name that no file can have
        return False
