"""Abaqus and CalculiX input as a sequence of keywords with their parameters and rows of data.

    *KEYWORD, PARAMETER=VALUE, FLAG        a line that ends in a comma goes on in the next
    value, value, ..                       rows of data, until the next keyword
    ** comment

Keywords, parameters and names of sets do not distinguish capitals. `*INCLUDE` is followed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from flexarm.decks.cards import MOST
from flexarm.errors import InvalidFile
from flexarm.reading import Includes, any_text


@dataclass
class Keyword:
    """One keyword."""

    name: str
    """Capitals, one blank between words."""
    parameters: dict[str, str]
    """Name in capitals -> value, empty for a flag."""
    file: Path
    line: int
    """Where it stands."""
    rows: list[tuple[int, list[str]]] = field(default_factory=list)
    """Data, blanks and quotes stripped; a comma at the end of a row leaves an empty last value."""

    def error(self, what: str, line: int | None = None) -> InvalidFile:
        """Return an error at this keyword, or at a line of its data."""
        return InvalidFile(self.file, f"line {line or self.line}, *{self.name}", what)

    def needed(self, parameter: str) -> str:
        """Return the value of a parameter that must be there."""
        value = self.parameters.get(parameter, "")
        if not value:
            raise self.error(f"{parameter} is missing")
        return value

    def numbers(self, line: int, values: list[str]) -> list[int]:
        """Return the whole numbers of a row; empty values are left out."""
        try:
            numbers = [int(value) for value in values if value]
        except ValueError:
            raise self.error(f"must be whole numbers, got {', '.join(values)}", line) from None
        if any(abs(number) > MOST for number in numbers):
            raise self.error(f"numbers go up to {MOST}, got {', '.join(values)}", line)
        return numbers

    def span(self, line: int, values: list[str]) -> range:
        """Return the first, last and step of `GENERATE`; the step is 1 if left out."""
        first, last, step = (*self.numbers(line, values), 1, 1)[:3] if values[1:] else (0, 0, 0)
        if step < 1:
            raise self.error(f"must be first, last and a positive step, got {', '.join(values)}", line)
        return range(first, last + 1, step)

    def floats(self, line: int, values: list[str]) -> list[float]:
        """Return the numbers of a row; empty values are zero, as both programs take them."""
        try:
            return [float(value.upper().replace("D", "E") or 0) for value in values]
        except ValueError:
            raise self.error(f"must be numbers, got {', '.join(values)}", line) from None

    def nodes(self) -> Iterator[tuple[int, list[float]]]:
        """Yield number and coordinates of every row of `*NODE`."""
        for line, values in self.rows:
            (number,) = self.numbers(line, values[:1]) or [0]
            xyz = self.floats(line, values[1:4])
            yield number, xyz + [0.0] * (3 - len(xyz))


def keywords(path: Path, includes: Includes | None = None) -> Iterator[Keyword]:
    """Yield every keyword of a file and of those it includes."""
    includes = includes or Includes()
    current: Keyword | None = None
    lines = iter(enumerate(any_text(path).splitlines(), start=1))
    for number, line in lines:
        text = line.strip()
        if not text or text.startswith("**"):
            continue
        if not text.startswith("*"):
            if current is not None:
                current.rows.append((number, [value.strip().strip('"') for value in text.split(",")]))
            continue
        if current is not None:
            yield from _followed(current, includes)
        while text.endswith(","):
            text += next(lines, (0, "*"))[1].strip()  # at the end of the file the comma is not the last
        current = _keyword(text, path, number)
    if current is not None:
        yield from _followed(current, includes)


def _keyword(text: str, path: Path, number: int) -> Keyword:
    name, *rest = text[1:].split(",")
    parameters = {}
    for word in rest:
        key, _, value = word.partition("=")
        parameters[key.strip().upper()] = value.strip().strip('"')
    return Keyword(" ".join(name.upper().split()), parameters, path, number)


def _followed(keyword: Keyword, includes: Includes) -> Iterator[Keyword]:
    if keyword.name != "INCLUDE":
        yield keyword
        return
    name = keyword.needed("INPUT")
    with includes.into(keyword.file, f"line {keyword.line}, *INCLUDE", name) as path:
        yield from keywords(path, includes)
