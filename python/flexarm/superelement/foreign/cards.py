"""Entries of Nastran bulk data: eight fields of eight characters, four of sixteen (`*`), or split by commas.

Source: MSC Nastran Quick Reference Guide, "Format of Bulk Data Entries".
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidFile


@dataclass(frozen=True)
class Card:
    """One entry: its name and fields, the name being field 0; continuations are joined."""

    path: Path
    line: int
    fields: list[str]

    @property
    def name(self) -> str:
        """Name of the entry, such as GRID."""
        return self.fields[0].strip("* ").upper()

    def blank(self, i: int) -> bool:
        """Return True if a field is empty or not there."""
        return i >= len(self.fields) or not self.fields[i]

    def integer(self, i: int, default: int | None = None) -> int:
        """Return a whole number; without a default it must be there."""
        if self.blank(i) and default is not None:
            return default
        try:
            return int(self.fields[i])
        except (ValueError, IndexError):
            self._refuse(i, "a whole number")
            raise

    def vector(self, i: int) -> Floats:
        """Return three real numbers from field i on; blank ones are zero."""
        return np.array([0.0 if self.blank(k) else self._real(k) for k in range(i, i + 3)])

    def _real(self, i: int) -> float:
        text = self.fields[i].upper().replace("D", "E")
        text = re.sub(r"(?<=[\d.])([+-]\d+)$", r"E\1", text)  # 1.5+3 is 1.5E+3
        try:
            return float(text)
        except ValueError:
            self._refuse(i, "a real number")
            raise

    def _refuse(self, i: int, wanted: str) -> None:
        got = self.fields[i] if i < len(self.fields) else ""
        raise InvalidFile(
            self.path, self.name, f"field {i + 1} must be {wanted}, got {got!r}", line=self.line
        )


def cards_of(path: Path, text: str) -> Iterator[Card]:
    """Yield all entries of a bulk data file; comments and the sections before BEGIN BULK are skipped."""
    begin = re.search(r"^\s*BEGIN\s+BULK.*$", text, re.IGNORECASE | re.MULTILINE)
    skipped = text.count("\n", 0, begin.end()) if begin else 0
    card: Card | None = None
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.split("$")[0].rstrip()
        if number <= skipped + (begin is not None) or not bare.strip():
            continue
        fields = _split(bare)
        if card is not None and (not fields[0] or fields[0][0] in "+*"):
            card.fields.extend(fields[1:])
            continue
        if card is not None:
            yield card
        card = Card(path, number, fields)
    if card is not None:
        yield card


def _split(line: str) -> list[str]:
    """Return the fields of a line, padded, without that for the continuation at its end."""
    line = line.expandtabs(8)
    if "," in line:
        fields = [field.strip() for field in line.split(",")]
        data = 4 if fields[0].endswith("*") or fields[0].startswith("*") else 8
    else:
        head = line[:8].strip()
        data, width = (4, 16) if "*" in head else (8, 8)
        fields = [head] + [line[k : k + width].strip() for k in range(8, 8 + data * width, width)]
    fields = fields[: data + 1]
    return fields + [""] * (data + 1 - len(fields))
