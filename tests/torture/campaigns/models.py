"""Malformed models: each value of a right model in turn replaced by wrong ones, and wrong structures."""

from __future__ import annotations

import copy
import random
import re
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import tomlkit

from torture.campaign import Campaign
from torture.campaigns.processes import COMMANDS, WRITES, needed
from torture.sandbox import Case, command

MISSING, HUGE = object(), "@HUGE@"
NUMBERS = (0, -1, 1e-300, 1e-75, 1e-12, 1e12, 1e20, 1e130, 1.7e308, float("nan"), float("inf"), HUGE, 2.5)
WRONG = (MISSING, "text", "", True, [], {}, [1, "x"], [[]], "1.0")
NAMES = (
    "base",
    "rod",
    "hinge",
    "load",
    "tip",
    "nobody",
    "x" * 5000,
    "a\u202eb",
    "a\x1b[2Jb",
    "a.b",
    "a/b",
    "ä\x00",
)
EXTRA: dict[str, str] = {
    "nothing": "",
    "a table twice": "\n[uncertainty]\n",
    "an unknown table": '\n[[nonsense]]\nname = "x"\n',
    "deep arrays": "\nname2 = " + "[" * 20000 + "]" * 20000,
    "deep tables": "\n[" + ".".join(["a"] * 5000) + "]\n",
    "bytes": "\x00\x01",
    "a long line": "\n# " + "x" * 3_000_000,
    "many tables": "".join(f'\n[[points]]\nname = "p{i}"\nlink = "rot"\n' for i in range(3000)),
    "a gear of itself": '\n[[gears]]\nname = "g"\ninput = "hinge"\noutput = "hinge"\nratio = 2\n',
    "gears that contradict": '\n[[gears]]\nname = "g"\ninput = "waist"\noutput = "elbow"\nratio = 2\n'
    '[[gears]]\nname = "h"\ninput = "waist"\noutput = "elbow"\nratio = 3\n',
    "gears in a ring": '\n[[gears]]\nname = "g"\ninput = "waist"\noutput = "elbow"\nratio = 2\n'
    '[[gears]]\nname = "h"\ninput = "elbow"\noutput = "waist"\nratio = 3\n',
    "a gear twice": '\n[[gears]]\nname = "g"\ninput = "waist"\noutput = "elbow"\nratio = 2\n' * 2,
    "a urdf of its own": '\nurdf = "arm.toml"\n',
    "a urdf elsewhere": '\nurdf = "/dev/zero"\n',
    "a part elsewhere": '\n[[links]]\nname = "part"\ntype = "superelement"\nfile = "/dev/zero"\n',
}
MODELS = {"crane.toml": "hinge", "three_joints.toml": "waist", "telescopic_crane.toml": "boom_pin"}
"""What is spoiled, and the joint that its drive moves."""
OTHERS = ("study.toml", "log.toml")
"""Tables of other commands: those of `COMMANDS` that name them."""


def leaves(value: Any, path: tuple = ()) -> Iterator[tuple]:
    """Paths of all values in tables and lists, of lists themselves as well."""
    if path:
        yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield from leaves(item, (*path, key))


def at(data: Any, path: tuple) -> Any:
    for key in path:
        data = data[key]
    return data


def replaced(data: dict[str, Any], path: tuple, value: Any) -> dict[str, Any]:
    """A copy with one value replaced, or left out."""
    data = copy.deepcopy(data)
    parent = at(data, path[:-1])
    if value is MISSING:
        del parent[path[-1]]
    else:
        parent[path[-1]] = value
    return data


def as_toml(data: dict[str, Any]) -> bytes:
    """TOML in UTF-8, with integers that no machine word holds."""
    return tomlkit.dumps(data).replace(f'"{HUGE}"', "9" * 5000).encode("utf-8", "surrogatepass")


@cache
def spoilt(seeds: Path) -> list[tuple[str, str, tuple, Any]]:
    """File, what is done, where and with which value; in an order that mixes them."""
    found: list[tuple[str, str, tuple, Any]] = []
    for file in (*MODELS, *OTHERS):
        data = tomllib.loads(text_of(file, seeds))
        for path in leaves(data):
            old = at(data, path)
            if isinstance(old, bool) or not isinstance(old, int | float | str):
                values: tuple = (*WRONG, "copy") if isinstance(path[-1], int) else WRONG
            else:
                values = (*WRONG, *(NAMES if isinstance(old, str) else NUMBERS))
            found += [(file, "value", path, value) for value in values]
        found += [(file, "text", (name,), text) for name, text in EXTRA.items()]
    text = (seeds / "arm.urdf").read_text()
    places = [match.span(2) for match in re.finditer(r'(\w+)="([^"]*)"', text)]
    values = (
        "",
        "text",
        "nan",
        "1e308",
        "-1",
        "0",
        "0 0 0",
        "${x}",
        "9" * 400,
        "base",
        "upper",
        "hinge",
        "&amp;",
    )
    found += [("arm.urdf", "attribute", place, value) for place in places for value in values]
    elements = [match.span() for match in re.finditer(r"<(?!\?|/|robot)\w+[^>]*/>", text)]
    found += [("arm.urdf", "element", place, copies) for place in elements for copies in (0, 2)]
    random.Random(0).shuffle(found)
    return found


def text_of(file: str, seeds: Path) -> str:
    """The right text of a file that is spoiled."""
    return needed(seeds)[file].decode() if file in OTHERS else (seeds / file).read_text()


def case(number: int, rng: random.Random, seeds: Path) -> Case:
    found = spoilt(seeds)
    file, how, place, value = found[number % len(found)]
    content = text_of(file, seeds)
    if how == "value":
        data = tomllib.loads(content)
        if value == "copy":
            at(data, place[:-1]).append(at(data, place))
            changed = as_toml(data)
        else:
            changed = as_toml(replaced(data, place, value))
        told = f"{file}: {'.'.join(map(str, place))} = {'left out' if value is MISSING else repr(value)[:60]}"
    elif how == "text":
        changed, told = (
            (value + content if value.startswith("\nurdf") else content + value).encode(),
            f"{file}: {place[0]}",
        )
    else:
        start, end = place
        piece = value if how == "attribute" else content[start:end] * value
        changed = (content[:start] + piece + content[end:]).encode()
        told = f"{file}: {content[max(0, start - 20) : end]!r} becomes {piece[:60]!r}"
    if file in OTHERS:
        words = next(words for _, words in COMMANDS.values() if file in words)
        return Case(told, (command(*words, writes=WRITES),), needed(seeds) | {file: changed})
    name = "arm.urdf" if file == "arm.urdf" else "arm.toml"
    drive = (seeds / "drive.csv").read_text().replace("hinge", MODELS.get(file, "hinge"))
    steps = (
        command("check", name),
        command("static", name),
        command("modes", name, "--count", "3"),
        command("simulate", name, "--drive", "drive.csv", "--step", "0.005", "--out", "run", writes=("run",)),
    )
    return Case(told, steps, {name: changed, "drive.csv": drive.encode()})


CAMPAIGN = Campaign("models", "malformed models, maps and studies", case, 8000, 120)
