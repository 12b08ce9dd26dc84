"""Tables of text: CSV in any dialect, and what laser trackers write as ASCII.

The first lines tell the separator, the decimal mark, the encoding and where the rows begin; `Dialect` says
what they do not. Arrow reads the columns that are asked for.
"""

from __future__ import annotations

import codecs
import csv
import mmap
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.errors import InvalidFile
from flexarm.importing.map_file import Dialect
from flexarm.importing.source import Array, Group, Request, Source, Unreadable, needed
from flexarm.units import FACTORS

BLOCK = 1 << 24
"""Bytes that Arrow converts at once."""
DROP_OUTS = ["", "nan", "NaN", "NAN", "null", "NULL", "NA", "N/A"]
"""Cells that hold no value."""
SEPARATORS = (",", ";", "\t", "|", " ")
_COMMENTS = ("//", "%", "#")
"""Marks of remarks: the one with which a file begins, else the last."""
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?|[+-]?(nan|inf)", re.I)
_DECIMAL_COMMA = re.compile(r"[+-]?(\d+(,\d*)?|,\d+)([eE][+-]?\d+)?|[+-]?nan", re.I)
_INSTANT = re.compile(
    r"\d{4}-\d\d-\d\d([T ]\d\d:\d\d.*)?|\d\d?:\d\d(:\d\d([.,]\d+)?)?|\d\d?[./]\d\d?[./]\d{2,4}.*"
)
_UNITS = {unit.lower() for units in FACTORS.values() for unit in units} | {
    "count",
    "counts",
    "a",
    "nm",
    "n.m",
}


@dataclass(frozen=True)
class Layout:
    """How a file is written."""

    encoding: str
    separator: str
    decimal: str
    comment: str
    """As `Dialect` has them."""
    first: int
    """Line of the first row, counted from 0."""
    names: tuple[str, ...]
    """Names of the columns; empty where the file has none."""
    units: tuple[str, ...] = ()
    """Their units, where a line gives them."""
    whole: tuple[bool | None, ...] = ()
    """True for columns of whole numbers in the sample, False for others of numbers, None for the rest."""


def layout(path: Path, dialect: Dialect) -> Layout:
    """Return how a file is written, seen from its first lines where the dialect leaves it open.

    Raise InvalidFile if it holds no rows of numbers that could be seen.
    """
    sample = 1 << 18  # bytes that show how a file is written
    with path.open("rb") as file:
        raw = file.read(sample)
        complete = not file.read(1)
    encoding = dialect.encoding or _encoding(raw)
    try:
        text = codecs.getincrementaldecoder(encoding)().decode(raw, complete)
    except (LookupError, UnicodeDecodeError) as error:
        raise InvalidFile(path, "csv.encoding", f"cannot be read as {encoding!r}: {error}") from None
    lines = text.lstrip("\ufeff").replace("\r\n", "\n").split("\n")
    lines = lines if complete or len(lines) < 2 else lines[:-1]
    comment = dialect.comment or _comment(lines)
    start = dialect.header_rows or 0
    body = [line for line in lines[start:] if line.strip() and not line.lstrip().startswith(comment)]
    if not body:
        raise InvalidFile(path, "file", "holds no rows")
    last = body[-50:]  # the end of the sample is past what stands above the rows
    separator, decimal = _marks(path, last, dialect)
    table = [cells_of(line, separator) for line in last]
    count = max(map(len, table), key=[len(row) for row in table].count)
    whole_rows = [row for row in table if len(row) == count]
    tail = whole_rows[len(whole_rows) // 2 :]
    numeric = [
        2 * sum(_is_value(row[i], decimal) and bool(row[i].strip()) for row in tail) > len(tail)
        for i in range(count)
    ]
    first = dialect.header_rows
    if first is None:
        first = next(
            (
                k
                for k, line in enumerate(lines)
                if line.strip()
                and not line.lstrip().startswith(comment)
                and _fits(cells_of(line, separator), numeric, decimal)
            ),
            len(lines),
        )
    above = [cells_of(line.strip("\r\n"), separator) for line in lines[:first] if line.strip()]
    if separator == " ":  # any sentence has blanks: names are as many as columns
        above = [cells[1:] if set(cells[0]) <= set("#%/") else cells for cells in above]
        above = [cells for cells in above if len(cells) == count]
    names, units = header_of(above, count, comment)
    if dialect.columns:
        if len(dialect.columns) != count:
            what = f"must name the {count} columns of the file, got {len(dialect.columns)}"
            raise InvalidFile(path, "csv.columns", what)
        names = list(dialect.columns)
    names = [*names[:count], *[""] * (count - len(names))]
    whole = tuple(_whole([row[i].strip() for row in table if i < len(row)], decimal) for i in range(count))
    return Layout(encoding, separator, decimal, comment, first, tuple(names), tuple(units), whole)


def _comment(lines: Sequence[str]) -> str:
    """Return the mark of remarks, seen from the first line that is not empty."""
    first = next((line.lstrip() for line in lines if line.strip()), "")
    return next((mark for mark in _COMMENTS if first.startswith(mark)), _COMMENTS[-1])


def _encoding(raw: bytes) -> str:
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    try:
        codecs.getincrementaldecoder("utf-8")().decode(raw)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def _marks(path: Path, lines: Sequence[str], dialect: Dialect) -> tuple[str, str]:
    """Return separator and decimal mark: those that make rows of one length, of cells that are values."""
    best: tuple[float, int] = (0.0, 0)
    found = None
    for separator in [dialect.separator] if dialect.separator else SEPARATORS:
        rows = [cells_of(line, separator) for line in lines]
        cells = [cell for row in rows for cell in row]
        for decimal in [dialect.decimal] if dialect.decimal else (".", ","):
            if decimal == separator:
                continue
            share = sum(_is_value(cell, decimal) and bool(cell.strip()) for cell in cells) / len(cells)
            counts = [len(row) for row in rows]
            most = max(counts, key=counts.count)
            even = counts.count(most) / len(counts)
            score = (round(share * even * (0.5 if most == 1 else 1.0), 2), len(cells))
            if share > 0 and score > best:
                best, found = score, (separator, decimal)
    if found is None:
        raise InvalidFile(path, "csv", "no cell is a number; say separator and decimal, or header_rows")
    return found


def cells_of(line: str, separator: str) -> list[str]:
    """Return the cells of a line; a blank stands for any number of blanks and tabs."""
    if separator == " ":
        return line.split() if '"' not in line else next(csv.reader([" ".join(line.split())], delimiter=" "))
    return next(csv.reader([line], delimiter=separator), [])


def _is_value(cell: str, decimal: str) -> bool:
    cell = cell.strip()
    pattern = _NUMBER if decimal == "." else _DECIMAL_COMMA
    return not cell or bool(pattern.fullmatch(cell) or _INSTANT.fullmatch(cell))


def _whole(cells: Sequence[str], decimal: str) -> bool | None:
    """Return True for whole numbers, False for other numbers, None for anything else."""
    values = [cell for cell in cells if cell]
    pattern = _NUMBER if decimal == "." else _DECIMAL_COMMA
    if not values or not all(pattern.fullmatch(cell) for cell in values):
        return None
    return len(values) == len(cells) and all(re.fullmatch(r"[+-]?\d{1,19}", cell) for cell in values)


def _fits(cells: Sequence[str], numeric: Sequence[bool], decimal: str) -> bool:
    """Return True if a line can be the first row: values where all rows have them, and one at least."""
    asked = [cell for cell, wanted in zip(cells, numeric, strict=False) if wanted]
    return (
        len(cells) == len(numeric)
        and all(_is_value(cell, decimal) for cell in asked)
        and any(cell.strip() for cell in asked)
    )


def header_of(above: Sequence[Sequence[str]], count: int, comment: str) -> tuple[list[str], list[str]]:
    """Return names and units from the cells of the lines above the first row."""
    marks = "".join({comment, "#", "%", "/"})
    rows: list[list[str]] = []
    for cells in reversed(above):
        if len(cells) < count - 1 or (count > 1 and len(cells) < 2) or len(rows) == 2:
            break
        rows.append([cell.strip().lstrip(marks).strip() for cell in cells])
    if not rows:
        return [], []
    bare = [cell.strip("[]()").lower() for cell in rows[0]]
    if len(rows) == 2 and all(not cell or cell in _UNITS for cell in bare) and any(bare):
        return rows[1], [cell.strip("[]()") for cell in rows[0]]
    return rows[0], []


class DelimitedText(Source):
    """A table of text."""

    def __init__(self, path: Path, dialect: Dialect, requests: Sequence[Request]) -> None:
        super().__init__(path, dialect, requests)
        self.layout = layout(path, dialect)
        self._arrays: dict[int, Array] = {}

    def names(self, topic: str | None) -> list[str]:
        """Return the names of the columns, empty where there is none."""
        if topic is not None:
            raise Unreadable("topic", f"a table of text has no topics, got {topic!r}")
        return list(self.layout.names)

    def groups(self) -> list[Group]:
        """Return the only table."""
        return [Group(None, self.layout.names, units=self.layout.units)]

    def time_unit(self, topic: str | None, index: int) -> str:
        """Return the unit of a column, where a line gives it."""
        return dict(enumerate(self.layout.units)).get(index, "")

    def array(self, topic: str | None, index: int) -> Array:
        """Return a column; the first call reads all that is asked for."""
        if index not in self._arrays:
            self._arrays |= self._read([*self._wanted(), index])
        return self._arrays[index]

    def place(self, topic: str | None, row: int) -> str:
        """Return the line of a row."""
        for k, (number, _) in enumerate(self._rows()):
            if k == row:
                return f"line {number}"
        return f"row {row + 1}"

    def _wanted(self) -> Iterator[int]:
        """Yield the columns of all requests, as far as there are such."""
        for request in self.requests:
            others = [column for _, column in request.others]
            for column in (*request.columns, *request.time_columns, *others):
                with suppress(Unreadable):
                    yield self.find(None, column, "columns")[0]

    def _stamp_columns(self) -> dict[int, bool]:
        """Return the columns of stamps, and True for those that are read as text."""
        found = {}
        for request in self.requests:
            for column in request.time_columns:
                with suppress(Unreadable):
                    found[self.find(None, column, "time")[0]] = request.stamps_are_text
        return found

    def _rows(self) -> Iterator[tuple[int, list[str]]]:
        """Yield line numbers and cells."""
        at = self.layout
        with self.path.open(encoding=at.encoding, errors="replace") as file:
            for number, line in enumerate(file, 1):
                if number > at.first and line.strip() and not line.lstrip().startswith(at.comment):
                    yield number, cells_of(line.rstrip("\r\n"), at.separator)

    def _read(self, indices: Sequence[int]) -> dict[int, Array]:
        """Return columns as Arrow reads them: as the sample shows them, else as whole columns show."""
        pa = needed("pyarrow", self.path)
        names = list(dict.fromkeys(map(str, indices)))
        texts = {str(index): pa.string() for index, as_text in self._stamp_columns().items() if as_text}
        whole = self.layout.whole
        counted = {str(index) for index in self._stamp_columns() if whole[index]}
        kinds = {name: pa.float64() for name in names if whole[int(name)] is not None}
        kinds |= dict.fromkeys(counted & set(names), pa.int64())
        try:
            try:
                table = self._table(pa, names, {**kinds, **texts})
            except pa.ArrowInvalid:
                table = self._table(pa, names, texts)
        except pa.ArrowInvalid as error:
            raise self._uneven(str(error)) from None
        return {int(name): plain_array(table[name]) for name in table.column_names}

    def _table(self, pa: Any, names: list[str], kinds: dict[str, Any]) -> Any:
        arrow, at = needed("pyarrow.csv", self.path), self.layout
        columns = [str(index) for index in range(len(at.names))]
        return arrow.read_csv(
            self._bytes(pa),
            arrow.ReadOptions(column_names=columns, skip_rows=at.first, block_size=BLOCK),
            arrow.ParseOptions(delimiter=at.separator),
            arrow.ConvertOptions(
                include_columns=names,
                column_types=kinds,
                decimal_point=at.decimal,
                strings_can_be_null=True,
                null_values=DROP_OUTS,
            ),
        )

    def _bytes(self, pa: Any) -> Any:
        """Return what Arrow reads: the file, or its text in UTF-8, without comments, with single blanks."""
        at = self.layout
        comment = at.comment.encode()
        plain = codecs.lookup(at.encoding).name == "utf-8"
        with self.path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as raw:
            commented = not plain or raw.find(b"\n" + comment) >= 0
            if plain and at.separator != " " and not commented:
                return str(self.path)
            content = raw[:]
        if not plain:
            content = content.decode(at.encoding, errors="replace").encode()
        body = content.split(b"\n", at.first)[-1]
        if commented:
            body = re.sub(rb"(?m)^[ \t]*" + re.escape(comment) + rb"[^\n]*\n?", b"", body)
        if at.separator == " ":
            body = re.sub(rb"(?m)^ +| +(?=\r?$)", b"", re.sub(rb"[ \t]+", b" ", body))
        return pa.BufferReader(b"\n" * at.first + body)

    def _uneven(self, told: str) -> InvalidFile:
        """Return the error of the first row that has another number of cells than the others."""
        count = len(self.layout.names)
        for number, cells in self._rows():
            if len(cells) != count:
                what = f"has {len(cells)} cells, other rows have {count}: {', '.join(cells)[:60]!r}"
                return InvalidFile(self.path, f"line {number}", what)
        return InvalidFile(self.path, "file", f"cannot be read as a table: {told}")


def plain_array(column: Any) -> Array:
    """Return a column of Arrow as an array: numbers with NaN for drop-outs, instants, or text."""
    import pyarrow as pa

    kind = column.type
    if pa.types.is_null(kind):
        return np.full(len(column), np.nan)
    if pa.types.is_time(kind) or pa.types.is_date(kind):
        whole = pa.types.is_time32(kind) or pa.types.is_date32(kind)
        unit = "D" if pa.types.is_date32(kind) else getattr(kind, "unit", "ms")
        numbers = column.cast(pa.int32()).cast(pa.int64()) if whole else column.cast(pa.int64())
        return np.asarray(numbers.to_numpy()).astype(f"timedelta64[{unit}]")
    if pa.types.is_decimal(kind):
        column = column.cast(pa.float64())
    found: Array = column.to_numpy()
    return found
