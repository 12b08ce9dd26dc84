"""Matrices as Abaqus and CalculiX write them in text.

Three forms, told apart by what they hold:

* *user element* (`*SUBSTRUCTURE MATRIX OUTPUT, OUTPUT FILE=USER DEFINED` of both programs): the points follow
  `** ELEMENT NODES` in comments; after them stand the components of the first point and, with a position in
  the list of points before them, changes of that list from this position on (CalculiX lists each point once
  for each of its freedoms). `*MATRIX, TYPE=STIFFNESS` or `MASS` is followed by the columns of the upper
  triangle, each down to its diagonal.
* *matrix input* (`*MATRIX OUTPUT, FORMAT=MATRIX INPUT` or `LABELS` of Abaqus, `OUTPUT FILE=MATRIX` of
CalculiX):
  row point, row component, column point, column component, value; one triangle or both.
* *storage* (`*FREQUENCY, SOLVER=MATRIXSTORAGE` of CalculiX): row, column, value in `.sti` and `.mas`, and
  point.component, line by line, in `.dof` beside them.

Points below zero are Abaqus's internal ones, which have no place: they are taken for internal modes.
Sources: Abaqus 2017, Keywords Reference, *USER ELEMENT, *MATRIX INPUT; CalculiX 2.20 manual,
*SUBSTRUCTURE MATRIX OUTPUT, *FREQUENCY.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidFile
from flexarm.reading import any_text
from flexarm.superelement.foreign.labelled import SCALAR, Freedom, Labelled, MatrixFile

_ROLES = {"STIFFNESS": "stiffness", "MASS": "mass", "VISCOUSDAMPING": "damping"}
_USER_ELEMENT = re.compile(r"^\*USER ELEMENT", re.IGNORECASE | re.MULTILINE)
_TYPE = re.compile(r"TYPE\s*=\s*([A-Z ]+)", re.IGNORECASE)


def read_abaqus(path: Path) -> MatrixFile:
    """Read matrices in the form of a user element or of matrix input.

    Raise InvalidFile if the file is neither, or a number is missing or damaged.
    """
    text = any_text(path)
    return _user_element(path, text) if _USER_ELEMENT.search(text) else _matrix_input(path, text)


def _user_element(path: Path, text: str) -> MatrixFile:
    points: list[int] = []
    changes: dict[int, list[int]] = {}
    entries: dict[str, list[float]] = {}
    ignored: list[str] = []
    place = ""
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.strip()
        if bare.startswith("**"):
            if re.match(r"\*\*\s*ELEMENT NODES", bare, re.IGNORECASE):
                place = "points"
            elif place == "points" and (found := _integers(bare[2:])) is not None:
                points += found
            elif place in entries and bare.strip(
                "* "
            ):  # another table, such as recovery, under its own title
                place = ""
        elif bare.startswith("*"):
            place = _section(bare, entries, ignored)
        elif bare and place == "points":
            _components(path, number, bare, changes)
        elif bare and place in entries:
            entries[place] += _floats(path, number, bare)
    freedoms = _freedoms_of_points(path, points, changes)
    matrices = {
        role: Labelled(_triangle(path, role, values, len(freedoms)), freedoms)
        for role, values in entries.items()
    }
    return MatrixFile(matrices, tuple(ignored))


def _section(keyword: str, entries: dict[str, list[float]], ignored: list[str]) -> str:
    """Return the section that a keyword begins: the entries of a matrix, points, or nothing that is read."""
    if keyword.upper().startswith("*USER ELEMENT"):
        return "points"
    match = _TYPE.search(keyword)
    if not keyword.upper().startswith("*MATRIX") or match is None:
        return ""
    kind = match[1].upper().replace(" ", "")
    if kind not in _ROLES:
        ignored.append(f"*MATRIX, TYPE={match[1].strip()}")
        return ""
    entries[_ROLES[kind]] = []
    return _ROLES[kind]


def _components(path: Path, number: int, line: str, changes: dict[int, list[int]]) -> None:
    """Note the components of the first point, or from the point at a position on."""
    found = _integers(line)
    position = 1 if not changes else (found or [0])[0]
    components = (found or [])[0 if not changes else 1 :]
    if position < 1 or not components or not set(components) <= set(range(1, 7)):
        what = "must list components 1 to 6, after the first line with a point's position before them"
        raise InvalidFile(path, "*USER ELEMENT", f"{what}; got {line!r}", line=number)
    changes[position] = components


def _freedoms_of_points(path: Path, points: list[int], changes: dict[int, list[int]]) -> tuple[Freedom, ...]:
    if not points or not changes:
        what = "names no points (** ELEMENT NODES) or no components after *USER ELEMENT"
        raise InvalidFile(path, "*USER ELEMENT", what)
    freedoms, components = [], changes[1]
    for position, point in enumerate(points, 1):
        components = changes.get(position, components)
        freedoms += [Freedom(point, c) for c in components]
    return tuple(freedoms)


def _triangle(path: Path, role: str, values: list[float], n: int) -> Floats:
    """Fill a symmetric matrix; column j holds rows 1 to j."""
    if len(values) != n * (n + 1) // 2:
        what = f"{n} freedoms need {n * (n + 1) // 2} numbers in a triangle, got {len(values)}"
        raise InvalidFile(path, role, what)
    matrix = np.zeros((n, n))
    columns, rows = np.tril_indices(n)
    matrix[rows, columns] = values
    matrix[columns, rows] = values
    return matrix


def _matrix_input(path: Path, text: str) -> MatrixFile:
    table = []
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.strip()
        if bare and not bare.startswith("*"):
            row = _floats(path, number, bare)
            if len(row) != 5 or any(v != int(v) for v in row[:4] if np.isfinite(v)):
                what = "must hold row point, component, column point, component, value"
                raise InvalidFile(path, "matrix", f"{what}; got {bare!r}", line=number)
            table.append(row)
    if not table:
        raise InvalidFile(path, "matrix", "holds no entries")
    pairs = [(_freedom(r[0], r[1]), _freedom(r[2], r[3])) for r in table]
    freedoms = tuple(sorted({f for pair in pairs for f in pair}))
    place = {freedom: i for i, freedom in enumerate(freedoms)}
    triplets = ((place[a], place[b], r[4]) for (a, b), r in zip(pairs, table, strict=True))
    return MatrixFile({"": Labelled(_symmetric(path, triplets, len(freedoms)), freedoms)})


def _freedom(point: float, component: float) -> Freedom:
    """Return a freedom; internal points have no place and count as modes, each component one."""
    if point < 0:
        return Freedom(int(point) * 10 - int(component), SCALAR)
    return Freedom(int(point), int(component))


def _symmetric(path: Path, triplets: Iterator[tuple[int, int, float]], n: int) -> Floats:
    """Fill a symmetric matrix from one triangle, or from both if they agree."""
    matrix = np.full((n, n), np.nan)
    for i, j, value in triplets:
        for a, b in ((i, j), (j, i)):
            if not np.isnan(matrix[a, b]) and abs(matrix[a, b] - value) > 1e-6 * abs(value):
                what = f"gives {matrix[a, b]:.8g} and {value:.8g} for one place of a symmetric matrix"
                raise InvalidFile(path, "matrix", what)
            matrix[a, b] = value
    return np.asarray(np.nan_to_num(matrix, nan=0.0))


def read_storage(path: Path) -> MatrixFile:
    """Read a matrix that CalculiX stored: `.sti` or `.mas`, with the `.dof` file next to it.

    Raise InvalidFile if one of the files is missing or damaged.
    """
    order = path.with_suffix(".dof")
    if not order.is_file():
        raise InvalidFile(order, "file", f"does not exist; it holds the order of freedoms of {path.name}")
    freedoms = []
    for number, line in enumerate(any_text(order).splitlines(), 1):
        match = re.fullmatch(r"\s*(\d+)\.([1-6])\s*", line)
        if match is None:
            raise InvalidFile(order, "freedom", f"must be POINT.COMPONENT, got {line!r}", line=number)
        freedoms.append(Freedom(int(match[1]), int(match[2])))
    n = len(freedoms)
    triplets = []
    for number, line in enumerate(any_text(path).splitlines(), 1):
        row = _floats(path, number, line.replace(",", " "))
        if len(row) != 3 or not (1 <= row[0] <= n and 1 <= row[1] <= n):
            what = f"must hold row, column (1 to {n}) and value, got {line!r}"
            raise InvalidFile(path, "matrix", what, line=number)
        triplets.append((int(row[0]) - 1, int(row[1]) - 1, row[2]))
    role = "stiffness" if path.suffix == ".sti" else "mass"
    return MatrixFile({role: Labelled(_symmetric(path, iter(triplets), n), tuple(freedoms))})


def _integers(line: str) -> list[int] | None:
    """Return the integers of a line, or None if it holds anything else."""
    words = re.split(r"[\s,]+", line.strip(" ,\t"))
    return [int(w) for w in words] if all(re.fullmatch(r"[+-]?\d+", w) for w in words) else None


def _floats(path: Path, number: int, line: str) -> list[float]:
    words = re.split(r"[\s,]+", line.strip(" ,\t"))
    try:
        return [float(w.replace("D", "E").replace("d", "e")) for w in words if w]
    except ValueError:
        raise InvalidFile(path, "matrix", f"must hold numbers, got {line.strip()!r}", line=number) from None
