"""Malformed records: each value of record.toml in turn, each CSV file with rows, columns or cells spoilt."""

from __future__ import annotations

import random
import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from torture.campaign import Campaign
from torture.campaigns.models import MISSING, NAMES, NUMBERS, WRONG, as_toml, at, leaves, replaced
from torture.sandbox import Case, command

Rows = list[list[str]]
"""Of a CSV file, its header first; the first column is time."""


def rows_of(text: str) -> Rows:
    return [line.split(",") for line in text.splitlines()]


def text_of(rows: Rows) -> bytes:
    return "\n".join(",".join(row) for row in rows).encode() + b"\n"


def from_to(start: float, end: float) -> Callable[[Rows], Rows]:
    """Keeps the rows of a share of the file."""
    return lambda rows: [rows[0], *rows[1 + int(start * (len(rows) - 1)) : 1 + int(end * (len(rows) - 1))]]


def without(start: float, end: float) -> Callable[[Rows], Rows]:
    """Leaves out the rows of a share of the file."""
    return lambda rows: [*from_to(0, start)(rows), *from_to(end, 1)(rows)[1:]]


def column(index: int, change: Callable[[str], str], rows: slice = slice(None)) -> Callable[[Rows], Rows]:
    """Changes cells of a column."""

    def changed(table: Rows) -> Rows:
        for row in table[1:][rows]:
            row[index] = change(row[index])
        return table

    return changed


def times(factor: float, plus: float = 0.0) -> Callable[[str], str]:
    return lambda cell: repr(float(cell or "nan") * factor + plus)


def cells(value: str) -> Callable[[str], str]:
    return lambda cell: value


def swapped(table: Rows) -> Rows:
    return [table[0], *(list(reversed(row)) for row in table[1:])]


DAMAGE: dict[str, Callable[[Rows], Rows]] = {
    "no rows": from_to(0, 0),
    "one row": lambda rows: rows[:2],
    "two rows": lambda rows: rows[:3],
    "three rows": lambda rows: rows[:4],
    "no header": lambda rows: rows[1:],
    "empty": lambda rows: [],
    "backwards": lambda rows: [rows[0], *reversed(rows[1:])],
    "doubled": lambda rows: rows + rows[1:],
    "a row twice": lambda rows: [*rows[:9], rows[8], *rows[9:]],
    "two rows swapped": lambda rows: [*rows[:5], rows[6], rows[5], *rows[7:]],
    "columns swapped": swapped,
    "a column more": lambda rows: [[*row, "0"] for row in rows],
    "a column less": lambda rows: [row[:-1] for row in rows],
    "a long row": lambda rows: [*rows[:7], ["1"] * 100_000, *rows[7:]],
    "a long header": lambda rows: [["x" * 1_000_000, *rows[0][1:]], *rows[1:]],
    "one cell": lambda rows: [["9" * 1_000_000]],
    "comments": lambda rows: [["#"]] * 100_000 + rows,
    "time in ms": column(0, times(1e3)),
    "time in us": column(0, times(1e-6)),
    "time of day": column(0, times(1, 1.7e9)),
    "time of day in ns": column(0, times(1e9, 1.7e18)),
    "time negative": column(0, times(1, -1e3)),
    "time huge": column(0, times(1e300)),
    "time tiny": column(0, times(1e-300)),
    "time denormal": column(0, times(1e-320)),
    "time at a stand": column(0, cells("1.0")),
    "time nan": column(0, cells("nan")),
    "time missing": column(0, cells(""), slice(5, 7)),
    "time jumps": column(0, times(1, 1e6), slice(20, None)),
    "time jumps far": column(0, times(1, 1e12), slice(20, None)),
    "last time huge": column(0, cells("1e308"), slice(-1, None)),
    "values nan": column(-1, cells("nan")),
    "values missing": column(-1, cells("")),
    "half missing": column(-1, cells(""), slice(None, None, 2)),
    "end missing": column(-1, cells(""), slice(15, None)),
    "begin missing": column(-1, cells(""), slice(None, 15)),
    "all but one missing": column(-1, cells(""), slice(1, None)),
    "values constant": column(-1, cells("0.3")),
    "values zero": column(-1, cells("0")),
    "values in mm or mrad": column(-1, times(1e3)),
    "values in degrees": column(-1, times(57.29578)),
    "values negated": column(-1, times(-1)),
    "values off": column(-1, times(1, 5)),
    "values huge": column(-1, times(1e150)),
    "values tiny": column(-1, times(1e-150)),
    "a huge value": column(-1, cells("1e308"), slice(9, 10)),
    "huge values": column(-1, cells("-1.7e308"), slice(9, None, 2)),
    "many digits": column(-1, cells("0." + "3" * 5000), slice(9, 10)),
    "an integer of many digits": column(-1, cells("3" * 5000), slice(9, 10)),
    "infinite": column(-1, cells("inf"), slice(9, 10)),
    "a text": column(-1, cells("abc"), slice(9, 10)),
    "control characters": column(-1, cells("\x1b[2J"), slice(9, 10)),
    "right to left": column(-1, cells("\u202e12"), slice(9, 10)),
    "a quote": column(-1, cells('"'), slice(9, 10)),
    "hexadecimal": column(-1, cells("0x10"), slice(9, 10)),
    "underscores": column(-1, cells("1_0"), slice(9, 10)),
    "other digits": column(-1, cells("١٢"), slice(9, 10)),
    "spikes": column(-1, times(1, 1e3), slice(None, None, 11)),
    "a step": column(-1, times(1, 3), slice(20, None)),
    "quantised": column(-1, lambda cell: f"{float(cell):.0f}"),
}
SPANS: dict[str, Callable[[Rows], Rows]] = {
    **{f"stops at {share:.0%}": from_to(0, share) for share in (0.02, 0.1, 0.25, 0.5, 0.8)},
    **{f"begins at {share:.0%}": from_to(share, 1) for share in (0.2, 0.5, 0.75, 0.98)},
    **{
        f"pauses from {start:.0%}": without(start, end) for start, end in ((0.1, 0.4), (0.3, 0.9), (0.6, 0.8))
    },
}
"""A drive that does not cover the record: it is refused, or a warning says so."""
RAW = {
    "bytes": b"\x00\xff\xfe\x01" * 50,
    "UTF-16": "time_s,x\n0,1\n".encode("utf-16"),
    "a mark": b"\xef\xbb\xbftime_s,x\n0,1\n",
    "old line ends": b"time_s,x\r0,1\r1,2\r",
    "semicolons": b"time_s;x\n0;1\n1;2\n",
    "tabs": b"time_s\tx\n0\t1\n",
    "a page": b"<!DOCTYPE html><html></html>",
}
RECORDS = {
    "slow": ("hinge.csv", "torque.csv", "tip.csv", "mid.csv"),
    "poses": ("poses.csv",),
    "responses": ("frf.csv",),
}
"""Records that are spoilt, and their CSV files."""
CLOCKS = (
    '"unknown"',
    "-1",
    "1e300",
    "1e-300",
    "nan",
    "{ offset = 1e300 }",
    "{ offset = 0, sigma = inf }",
    "{}",
    "[]",
)


@cache
def spoilt(seeds: Path) -> list[tuple[str, str, str, Any, Any]]:
    """Record, file, what is done, where and with which value; in an order that mixes them."""
    found: list[tuple[str, str, str, Any, Any]] = []
    for record, files in RECORDS.items():
        data = tomllib.loads((seeds / "example" / record / "record.toml").read_text())
        for path in leaves(data):
            old = at(data, path)
            plain = not isinstance(old, bool) and isinstance(old, int | float | str)
            values = (*WRONG, *(NAMES if isinstance(old, str) else NUMBERS)) if plain else (*WRONG, "copy")
            found += [(record, "record.toml", "value", path, value) for value in values]
        found += [(record, file, "rows", name, change) for file in files for name, change in DAMAGE.items()]
        found += [(record, file, "raw", name, content) for file in files for name, content in RAW.items()]
    clocks = ("controller", "tracker")
    found += [("slow", "record.toml", "clock", name, value) for name in clocks for value in CLOCKS]
    found += [("slow", "hinge.csv", "span", name, change) for name, change in SPANS.items()] * 2
    random.Random(0).shuffle(found)
    return found


def case(number: int, rng: random.Random, seeds: Path) -> Case:
    found = spoilt(seeds)
    record, file, how, place, value = found[number % len(found)]
    directory = seeds / "example" / record
    files = {f"{record}/{path.name}": path.read_bytes() for path in directory.iterdir()}
    content = files[f"{record}/{file}"].decode()
    told = f"{record}/{file}: {how} {place}"
    if how == "value":
        data = tomllib.loads(content)
        if value == "copy" and isinstance(place[-1], int):
            at(data, place[:-1]).append(at(data, place))
            changed = as_toml(data)
        else:
            changed = as_toml(replaced(data, place, value))
        told = (
            f"{record}: {'.'.join(map(str, place))} = {'left out' if value is MISSING else repr(value)[:60]}"
        )
    elif how == "clock":
        lines = [
            f"{place} = {value}" if line.startswith(f"{place} =") else line for line in content.splitlines()
        ]
        changed, told = "\n".join(lines).encode(), f"{record}: clock {place} = {value}"
    else:
        changed = value if how == "raw" else text_of(value(rows_of(content)))
    files |= {f"{record}/{file}": changed, "arm.toml": (seeds / "example" / "arm.toml").read_bytes()}
    steps = [
        command("check", record),
        command("check", "arm.toml", record, must_tell=how == "span"),
        command("compare", "arm.toml", record, must_tell=how == "span"),
    ]
    if how == "span" or number % 50 == 0:
        why = ("--jobs", "1", "--out", "why")
        steps.append(
            command("diagnose", "arm.toml", record, *why, writes=("why",), must_tell=how == "span", cpu=120)
        )
    return Case(told, tuple(steps), files, wall=300)


CAMPAIGN = Campaign("records", "malformed records", case, 2400, 60)
