"""Frames and clocks of one name that are not one in two records.

Logs of several days name a station or a clock alike, wherever it stood and whenever it began. A frame or
clock of which neither record knows anything, and that the data bear out as two, gets a name of its own in the
later record, so that it is fitted by itself. What a record states, or an effect of the model, keeps its name.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import count
from typing import NamedTuple

from flexarm.arm import Arm
from flexarm.record import Record


class Unshared(NamedTuple):
    """A frame or clock that is not the same in two records."""

    table: str
    """`frames` or `clocks`."""
    name: str
    one: str
    other: str
    """Its name, and those of the records."""
    difference: str
    advice: str
    """In words."""

    def __str__(self) -> str:
        kind = self.table.removesuffix("s")
        return f"{self.one} and {self.other} do not share the {kind} {self.name}: {self.difference}"

    def is_unknown(self, records: Mapping[str, Record]) -> bool:
        """Return True if neither record knows anything of it."""
        return all(getattr(records[each], self.table)[self.name].unknown for each in (self.one, self.other))


def with_own_names(
    arm: Arm, records: Mapping[str, Record], found: Iterable[Unshared]
) -> tuple[dict[str, Record], list[str]]:
    """Return the records with names of their own for what they do not share, and remarks."""
    named, remarks = dict(records), []
    stated = {effect.at for effect in arm.effects}
    for each in found:
        if any(each.name not in getattr(named[record], each.table) for record in (each.one, each.other)):
            continue  # it has a name of its own already
        if each.name in stated or not each.is_unknown(named):
            remarks.append(f"{each}{each.advice}")
            continue
        taken = {name for record in named.values() for name in getattr(record, each.table)}
        new = next(name for k in count(2) if (name := f"{each.name}-{k}") not in taken)
        named[each.other] = renamed(named[each.other], each.table, each.name, new)
        remarks.append(f"{each}; that of {each.other} is fitted by itself, as {new}")
    return named, remarks


def renamed(record: Record, table: str, old: str, new: str) -> Record:
    """Return a record with another name for a frame or clock, `table` being `frames` or `clocks`."""
    key = table.removesuffix("s")
    places = {new if name == old else name: each for name, each in getattr(record, table).items()}
    signals = [
        signal.replace(**{key: new}) if getattr(signal, key) == old else signal
        for signal in record.signals.values()
    ]
    return record.replace(**{table: places, "signals": signals})
