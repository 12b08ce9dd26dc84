"""A stated order of freedoms, for formats that hold none.

Words are separated by spaces, commas or line ends. `11` stands for the six freedoms of point 11 in their
order, `11.123` for some of them, `101.0` for a scalar point, that is an internal mode, `101-120.0` for twenty
of them in a row. What follows `#` or `$` on a line is a comment.

The points come in the same sequence for every component. Exchanging rotations about one axis between two
points leaves the rigid motions as they are, so that no check of them could find it; no program writes such an
order, and none can be stated.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.superelement.foreign.labelled import SCALAR, Freedom
from flexarm.tables.toml import read_text

_WORD = re.compile(r"(\d+)(?:-(\d+))?(?:\.(0|[1-6]{1,6}))?")


def read_order(order: str | Path) -> tuple[Freedom, ...]:
    """Read the order of freedoms from a list, or from a file that holds one.

    Raise InvalidFile or InvalidParameter if a word is not of the form above, or a freedom is listed twice.
    """
    text, file = str(order), None
    if isinstance(order, Path) or Path(text).is_file():
        file = Path(order)
        text = read_text(file)
    freedoms: list[Freedom] = []
    seen: set[Freedom] = set()
    for number, line in enumerate(text.splitlines(), 1):
        for word in re.split(r"[\s,;]+", re.split(r"[#$]", line)[0].strip()):
            for freedom in _freedoms(word, file, number) if word else ():
                if freedom in seen:
                    _refuse(f"freedom {freedom} is listed twice", file, number)
                seen.add(freedom)
                freedoms.append(freedom)
    if not freedoms:
        _refuse("lists no freedom", file, 1)
    _refuse_other_sequence(freedoms, file)
    return tuple(freedoms)


def _refuse_other_sequence(freedoms: list[Freedom], file: Path | None) -> None:
    first: dict[int, int] = {}
    for freedom in freedoms:
        first.setdefault(freedom.point, len(first))
    for component in range(1, 7):
        points = [freedom.point for freedom in freedoms if freedom.component == component]
        for a, b in pairwise(points):
            if first[a] > first[b]:
                what = f"component {component} has point {a} before {b}, other components have {b} before {a}"
                _refuse(f"{what}; the points must come in one sequence", file, 1)


def _freedoms(word: str, file: Path | None, line: int) -> Iterator[Freedom]:
    match = _WORD.fullmatch(word)
    if match is None:
        _refuse(f"{word!r} is none of POINT, POINT.COMPONENTS, POINT.0, FIRST-LAST.0", file, line)
        return
    first, last = int(match[1]), int(match[2] or match[1])
    if last < first or last - first > 100_000:
        _refuse(f"{word!r} does not count upwards", file, line)
    components = [SCALAR] if match[3] == "0" else [int(c) for c in match[3] or "123456"]
    for point in range(first, last + 1):
        for component in components:
            yield Freedom(point, component)


def _refuse(what: str, file: Path | None, line: int) -> None:
    if file is not None:
        raise InvalidFile(file, "order", what, line=line)
    raise InvalidParameter(what, where="order")
