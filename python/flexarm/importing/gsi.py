"""Leica's GSI of total stations and trackers: a block of words a line, each behind an index of two digits.

    *110001+0000000000000A17 21.322+0000000012345678 81..16+0000000001978603 82..16+0000000002357430

Eight digits a word, or sixteen where the block begins with `*`. The sixth sign of a word is the unit of its
digits: 0 and 1 are thousandths of a metre and a foot, 6 and 7 ten-thousandths, 8 hundred-thousandths of a
metre; 2 and 3 are hundred-thousandths of a gon and a degree, 4 is DDD.MMSS and a digit. Values come in m and
deg, without a unit as texts. Columns have the names below, others their index. East, north and height are
x, y and z.
"""

from __future__ import annotations

import re
from functools import cached_property

import numpy as np

from flexarm.importing.source import Array, Group, Source, Unreadable

NAMES = {
    "11": "point",
    "21": "horizontal",
    "22": "vertical",
    "31": "slope_distance",
    "32": "horizontal_distance",
    "33": "height_difference",
    "81": "x",
    "82": "y",
    "83": "z",
    "84": "station_x",
    "85": "station_y",
    "86": "station_z",
    "87": "reflector_height",
    "88": "instrument_height",
}
"""Index of a word -> name of the column."""
UNITS = {index: "deg" if index in ("21", "22") else "m" for index in NAMES if index != "11"}
"""Index of a word that holds a number -> unit in which its column comes."""
FACTORS = {"0": 1e-3, "1": 0.3048e-3, "6": 1e-4, "7": 0.3048e-4, "8": 1e-5, "2": 0.9e-5, "3": 1e-5}
"""Sign of a unit -> factor of the digits to m or deg."""
_WORD = r"(\d\d)[\d.]{3}([\d.])([+-])(.{%d})(?:\s|$)"
"""Index, unit, sign and digits of a word, or any characters of a name."""


class GsiFile(Source):
    """A file of GSI-8 or GSI-16."""

    @cached_property
    def _columns(self) -> dict[str, list[float | str]]:
        """Columns by name, NaN or an empty text where a block has no such word."""
        rows: list[dict[str, float | str]] = []
        for line in self.path.read_text(encoding="ascii", errors="replace").splitlines():
            if words := re.findall(_WORD % (16 if line.startswith("*") else 8), line):
                rows.append({NAMES.get(word[0], word[0]): _value(*word) for word in words})
        names = dict.fromkeys(name for row in rows for name in row)
        texts = {name for row in rows for name, value in row.items() if isinstance(value, str)}
        return {name: [row.get(name, "" if name in texts else np.nan) for row in rows] for name in names}

    def names(self, topic: str | None) -> list[str]:
        """Return the names of the columns."""
        if topic is not None:
            raise Unreadable("topic", f"a GSI file has no topics, got {topic!r}")
        return list(self._columns)

    def groups(self) -> list[Group]:
        """Return the only table."""
        names = self.names(None)
        units = {NAMES[index]: unit for index, unit in UNITS.items()}
        return [Group(None, tuple(names), units=tuple(units.get(name, "") for name in names))]

    def array(self, topic: str | None, index: int) -> Array:
        """Return a column: numbers in m and deg, or texts."""
        column = self._columns[self.names(topic)[index]]
        return np.array(column, dtype=object if isinstance(column[0], str) else float)


def _value(index: str, unit: str, sign: str, digits: str) -> float | str:
    """Return a value in m or deg, or a text; names of points hold the number of the block, not a unit."""
    if index not in UNITS:
        return digits.strip().lstrip("0").strip() or "0"
    if unit == "4" and digits.isdecimal():
        whole, minutes, seconds = int(digits[:-5]), int(digits[-5:-3]), int(digits[-3:]) / 10
        return (-1 if sign == "-" else 1) * (whole + minutes / 60 + seconds / 3600)
    return int(sign + digits) * FACTORS[unit] if unit in FACTORS and digits.isdecimal() else np.nan
