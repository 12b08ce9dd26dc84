"""A log as named arrays: what every format gives, and how columns are picked from it.

A reader of a format is a subclass of `Source`. It says which columns a topic has and gives their arrays; what
a map may write for a column (a name, a number, a path, a row of a matrix) is the same for all.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.consistency import missing
from flexarm.arrays import Floats
from flexarm.errors import InvalidFile
from flexarm.importing.time_unit import last_word, seconds_of

if TYPE_CHECKING:
    from flexarm.importing.map_file import Dialect

Array = NDArray[Any]
LOG = "log"
"""Word of a map for the time that a file gives by itself."""


class Unreadable(Exception):
    """What is wrong with a part of a source, and the key of the map that asked for it."""

    def __init__(self, key: str, what: str) -> None:
        super().__init__(what)
        self.key, self.what = key, what


@dataclass(frozen=True)
class Request:
    """What a signal needs of its source."""

    topic: str | None
    """Topic, path of a group, or sheet."""
    columns: tuple[str | int, ...]
    """Columns of values."""
    time: str | int | tuple[str | int, ...] | None = None
    """Column of stamps, or "log"; several are texts that make a stamp together; None: none needed."""
    others: tuple[tuple[str, str | int], ...] = ()
    """Key of the map and a column that tells rows apart: poses, and what they are chosen by."""
    stamps_are_text: bool = False
    """True if stamps are read as text."""
    time_unit: str | None = None
    """Unit of the stamps as the map states it."""

    @property
    def time_columns(self) -> tuple[str | int, ...]:
        """The columns of stamps."""
        if self.time is None:
            return ()
        return self.time if isinstance(self.time, tuple) else (self.time,)


@dataclass(frozen=True)
class Samples:
    """What a source has for a request."""

    values: Floats
    """Values, drop-outs as NaN, shape (n, columns)."""
    time: Array | None = None
    """Stamps as they stand: whole numbers stay whole, shape (n,)."""
    time_unit: str | None = None
    """Their unit, where the source says it."""
    others: tuple[Array, ...] = ()
    """Columns that tell rows apart, as they stand, shape (n,)."""


@dataclass(frozen=True)
class Group:
    """Columns of a source that belong together."""

    topic: str | None
    """As a map names it."""
    names: tuple[str, ...]
    time: str | None = None
    """The column of stamps, or "log", as far as the format tells."""
    kind: str = ""
    """What the source says that it is, such as the type of a message; empty if nothing."""
    units: tuple[str, ...] = ()
    """Units of the columns, where the source gives them."""


class Source(ABC):
    """One log: a file, or the directory of a bag.

    `requests` are all that will be asked for, so that a format can read it in one go.
    """

    tried_apart: ClassVar[bool] = False
    """True if its library may end the program on damaged bytes: another process tries it first."""

    def __init__(self, path: Path, dialect: Dialect, requests: Sequence[Request]) -> None:
        self.path, self.dialect, self.requests = path, dialect, tuple(requests)

    @abstractmethod
    def names(self, topic: str | None) -> list[str]:
        """Return the columns of a topic.

        Raise Unreadable if there is no such topic.
        """

    @abstractmethod
    def array(self, topic: str | None, index: int) -> Array:
        """Return a column, counted from 0 in `names`: numbers, instants as datetime64, text, or a matrix."""

    @abstractmethod
    def groups(self) -> list[Group]:
        """Return all columns of the source."""

    def log_time(self, topic: str | None, indices: Sequence[int]) -> tuple[Array, str]:
        """Return the file's own stamps of columns, and their unit.

        Raise Unreadable if the format has none.
        """
        what = "has no time of its own; name a column of stamps, or say { rate_hz = } if there is none"
        raise Unreadable("time", what)

    def time_unit(self, topic: str | None, index: int) -> str:
        """Return the unit of a column of stamps as the source spells it; empty where it says none."""
        return ""

    def place(self, topic: str | None, row: int) -> str:
        """Return where a row stands, counted from 0."""
        return f"row {row + 1}"

    def read(self, request: Request) -> Samples:
        """Return the samples of a request.

        Raise Unreadable with the key of the map and what is wrong.
        """
        topic = request.topic
        found = [self.find(topic, column, "columns") for column in request.columns]
        time, unit = self._time(request, [index for index, _ in found])
        rows, beside = (None, "") if time is None else (len(time), "stamps")
        found = [*(self.find(topic, column, key) for key, column in request.others), *found]
        asked = [*request.others, *(("columns", column) for column in request.columns)]
        arrays = []
        for (key, column), (index, pick) in zip(asked, found, strict=True):
            array = self._row(topic, index, pick, rows, f"column {column!r}")
            if rows is None:
                rows, beside = len(array), f"values of column {column!r}"
            if len(array) != rows:
                raise Unreadable(key, f"column {column!r} has {len(array)} values beside {rows} {beside}")
            arrays.append(array)
        others, columns = tuple(arrays[: len(request.others)]), []
        for array, column in zip(arrays[len(others) :], request.columns, strict=True):
            parts = (array.real, array.imag) if array.dtype.kind == "c" else (array,)
            what = f"column {column!r}"
            columns += [as_numbers(part, lambda row: self.place(topic, row), what) for part in parts]
        values = columns[0][:, None] if len(columns) == 1 else np.stack(columns, axis=1)
        return Samples(values, time, unit, others)

    def find(self, topic: str | None, column: str | int, key: str) -> tuple[int, int | None]:
        """Return the place of a column in `names`, and the row of a matrix that it picks, from 0."""
        names = self.names(topic)
        if isinstance(column, int):
            if column > len(names):
                raise Unreadable(key, f"there is no column {column}; there are {len(names)}")
            return column - 1, None
        if names.count(column) > 1:
            numbers = [i for i, name in enumerate(names, 1) if name == column]
            what = (
                f"column {column!r} stands there {len(numbers)} times; say its number, such as {numbers[0]}"
            )
            raise Unreadable(key, what)
        if column in names:
            return names.index(column), None
        match = re.fullmatch(r"(.*)\[(\d+)\]", column)
        if match and match[1] in names:
            if int(match[2]) < 1:
                raise Unreadable(key, f"rows of a matrix count from 1, got {column!r}")
            return names.index(match[1]), int(match[2]) - 1
        close = get_close_matches(column, names, n=1)
        meant = f"; did you mean {close[0]!r}?" if close else ""
        raise Unreadable(key, missing("column", column, [n for n in names if n]) + meant)

    def length(self, matrix: Array) -> int | None:
        """Return the number of samples of a matrix; None where its rows are the columns of the log."""
        return None

    def _row(self, topic: str | None, index: int, pick: int | None, rows: int | None, what: str) -> Array:
        """Return a column, or the row of a matrix that is picked, of so many samples if that is known."""
        array = self.array(topic, index)
        return one_row(array, pick, self.length(array) if rows is None else rows, what)

    def _time(self, request: Request, indices: Sequence[int]) -> tuple[Array | None, str | None]:
        topic, column = request.topic, request.time
        if column is None:
            return None, None
        if isinstance(column, tuple):
            return self._joined(topic, column), None
        if column == LOG and LOG not in self.names(topic):
            return self.log_time(topic, indices)
        index, pick = self.find(topic, column, "time")
        found = self._row(topic, index, pick, None, f"column {column!r}")
        if request.stamps_are_text:
            return found, None
        if found.dtype.kind in "Mm":
            if np.isnat(found).any():
                row = int(np.flatnonzero(np.isnat(found))[0])
                raise Unreadable("time", f"{self.place(topic, row)}: a row needs a time, got none")
            kind = "datetime64[ns]" if found.dtype.kind == "M" else "timedelta64[ns]"
            return found.astype(kind).astype(np.int64), "ns"
        if found.dtype.kind not in "iu":
            found = as_numbers(found, lambda row: self.place(topic, row), f"column {column!r}", "time")
        unit, name = self.time_unit(topic, index), self.names(topic)[index]
        bracketed = re.search(r"[\[(]([^\[\]()]+)[\])]\s*$", name)
        named = bracketed[1] if bracketed else "" if request.time_unit else last_word(name)
        return found, unit or (named if seconds_of(named) is not None else None)

    def _joined(self, topic: str | None, columns: Sequence[str | int]) -> Array:
        """Return texts of several columns, joined by blanks."""
        texts = []
        for column in columns:
            index, pick = self.find(topic, column, "time")
            texts.append(self._row(topic, index, pick, None, f"column {column!r}").tolist())
        return np.array([" ".join(map(str, row)) for row in zip(*texts, strict=True)])


def shared_stamps(stamps: Sequence[tuple[str, tuple[Array, str]]]) -> tuple[Array, str]:
    """Return the stamps that named columns share, and their unit.

    Raise Unreadable if they have different ones.
    """
    (first, found), *others = stamps
    for name, (time, unit) in others:
        if unit != found[1] or not np.array_equal(time, found[0]):
            what = f"column {name!r} has other stamps than {first!r}; it needs a signal of its own"
            raise Unreadable("time", what)
    return found


def one_row(array: Array, pick: int | None, rows: int | None, what: str) -> Array:
    """Return a column: a row or column of a matrix, whichever way it is as long as the stamps."""
    array = np.atleast_1d(np.squeeze(array)) if pick is None else np.atleast_1d(array)
    if pick is None:
        if array.ndim > 1:
            shape = " x ".join(map(str, array.shape))
            raise Unreadable("columns", f"{what} is a matrix of {shape}; pick a row of it by [1]")
        return array
    array = array[None, :] if array.ndim == 1 else array
    if array.ndim != 2:
        raise Unreadable("columns", f"{what} has {array.ndim} dimensions; a row is picked from two")
    across = rows is not None and array.shape[1] != rows and array.shape[0] == rows
    found = array.T if across else array
    if pick >= len(found):
        raise Unreadable("columns", f"{what} picks row {pick + 1} of {len(found)}")
    return np.asarray(found[pick])


def as_numbers(array: Array, place: Callable[[int], str], what: str, key: str = "columns") -> Floats:
    """Return a column as doubles; empty texts and masked values are NaN."""
    if isinstance(array, np.ma.MaskedArray):
        array = np.ma.filled(array.astype(float), np.nan)
    if array.dtype.kind in "fiub":
        return np.asarray(array, dtype=float)
    found = np.empty(len(array))
    for row, value in enumerate(array.tolist()):
        try:
            found[row] = np.nan if value is None or str(value).strip() == "" else float(value)
        except (TypeError, ValueError):
            got = repr(value)[:40]
            raise Unreadable(key, f"{place(row)}, {what}: must be a number, got {got}") from None
    return found


def needed(package: str, source: str | Path) -> Any:
    """Return a package that the extra `import` installs.

    Raise InvalidFile with the pip command, if it is missing.
    """
    try:
        return import_module(package)
    except ImportError:
        what = f"needs the package {package.partition('.')[0]}: pip install 'flexarm[import]'"
        raise InvalidFile(source, "file", what) from None
