"""Nastran bulk data as a sequence of cards with their fields.

A card is a name and fields: in columns of 8 (ten to a line), or of 8, 16, 16, 16, 16, 8 where the name ends
in `*`, or separated by commas. It goes on in a line that begins with `+`, `*` or blanks.
`$` begins a comment. `SET n = ..` of the case control, before `BEGIN BULK`, is a card too. `INCLUDE` is
followed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidFile
from flexarm.reading import Includes, any_text

MOST = 999_999_999
"""Largest number of a grid or cell that Nastran allows."""


@dataclass
class Card:
    """One card."""

    name: str
    """Capitals, without `*` and `_` at its end."""
    fields: list[str]
    """What follows the name, blanks stripped; an empty field is a default."""
    file: Path
    line: int
    """Where it begins."""

    def error(self, what: str) -> InvalidFile:
        """Return an error at this card."""
        return InvalidFile(self.file, f"line {self.line}, {self.name}", what)

    def text(self, index: int) -> str:
        """Return a field, empty if the card ends before."""
        return self.fields[index] if index < len(self.fields) else ""

    def integer(self, index: int, otherwise: int | None = None) -> int:
        """Return a whole number; `otherwise` for an empty field."""
        text = self.text(index)
        if not text and otherwise is not None:
            return otherwise
        try:
            number = int(text)
        except ValueError:
            raise self.error(f"field {index + 2} must be a whole number, got {text!r}") from None
        if abs(number) > MOST:
            raise self.error(f"field {index + 2} goes up to {MOST}, got {text}")
        return number

    def number(self, index: int) -> float:
        """Return a real number, 0 for an empty field; `7.-3` is 0.007."""
        text = re.sub(r"(?<=[\d.])([+-]\d+)$", r"E\1", self.text(index).upper().replace("D", "E"))
        try:
            return float(text or 0)
        except ValueError:
            raise self.error(f"field {index + 2} must be a number, got {self.text(index)!r}") from None

    def vector(self, index: int) -> Floats:
        """Return three real numbers from a field on."""
        return np.array([self.number(i) for i in (index, index + 1, index + 2)])


def cards(path: Path, includes: Includes | None = None) -> Iterator[Card]:
    """Yield every card of a file and of those it includes."""
    includes = includes or Includes()
    lines = list(enumerate(any_text(path).expandtabs(8).splitlines(), start=1))
    begin = next(
        (i for i, (_, text) in enumerate(lines) if text.strip().upper().startswith("BEGIN BULK")), -1
    )
    yield from _case_sets(lines[: max(begin, 0)], path)
    current: Card | None = None
    for number, line in lines[begin + 1 :]:
        text = line.split("$")[0].rstrip()
        if not text.strip():
            continue
        if text.upper().startswith("ENDDATA"):
            break
        if text.upper().startswith("INCLUDE"):
            name = text[7:].strip().strip("'\"")
            with includes.into(path, f"line {number}, INCLUDE", name) as file:
                yield from cards(file, includes)
            continue
        name, fields = _split(text)
        if current is not None and (not name or name[0] in "+*"):
            current.fields += fields
            continue
        if current is not None:
            yield current
        current = Card(name.upper().rstrip("*_"), fields, path, number)  # meshio writes CHEXA_ for 20 nodes
    if current is not None:
        yield current


def _split(line: str) -> tuple[str, list[str]]:
    """Name and fields of one line, without the field that only announces a continuation."""
    name, *fields = (field.strip() for field in (line.split(",") if "," in line else [line[:8]]))
    width, step = (4, 16) if name.endswith("*") or name.startswith("*") else (8, 8)
    if "," not in line:
        fields = [line[i : i + step].strip() for i in range(8, min(len(line), 72), step)]
    return name, (fields + [""] * width)[:width]


def _case_sets(lines: list[tuple[int, str]], path: Path) -> Iterator[Card]:
    """Read `SET n = 1, 2, 5 THRU 9`, which goes on while a line ends in a comma."""
    rest = iter(lines)
    for number, line in rest:
        words = line.split("$")[0].replace("=", " = ").split()
        if len(words) > 3 and words[0].upper() == "SET" and words[2] == "=":
            text = " ".join(words[3:])
            while text.endswith(","):
                text += next(rest, (0, ""))[1].split("$")[0].strip() or " "
            yield Card("SET", [words[1], *text.replace(",", " ").split()], path, number)
