"""Matrix Market files (.mtx): real matrices, symmetric or general, without names of freedoms.

    %%MatrixMarket matrix coordinate|array real|integer general|symmetric
    % comments
    rows columns [entries]
    row column value          coordinate: only what is not zero; symmetric: one triangle
    value                     array: column after column; symmetric: each from its diagonal down

Read line by line, since SciPy's reader crashes the process on damaged files. Source: [Boisvert1996].
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidFile
from flexarm.reading import any_text
from flexarm.superelement.foreign.labelled import Labelled, MatrixFile

BANNER = "%%MatrixMarket"


def read_matrix_market(path: Path) -> MatrixFile:
    """Read the one matrix of a Matrix Market file.

    Raise InvalidFile if the file is damaged, or its matrix not real and square.
    """
    numbered = enumerate(any_text(path).splitlines(), 1)
    lines = ((number, line.strip()) for number, line in numbered if line.strip())
    first, banner = next(lines, (1, ""))
    words = banner.lower().split()
    if len(words) != 5 or words[0] != BANNER.lower() or words[1] != "matrix":
        raise InvalidFile(path, "banner", f"must begin with {BANNER} matrix, got {banner!r}", line=first)
    layout, field, symmetry = words[2:]
    if layout not in ("coordinate", "array") or field not in ("real", "integer", "double"):
        raise InvalidFile(path, "banner", f"must be real, coordinate or array, got {banner!r}", line=first)
    if symmetry not in ("general", "symmetric"):
        raise InvalidFile(path, "banner", f"must be general or symmetric, got {symmetry!r}", line=first)
    content = ((number, line) for number, line in lines if not line.startswith("%"))
    n, count = _sizes(path, content, layout)
    rows, columns, values = _entries(path, content, layout, symmetry, n)
    expected = count if layout == "coordinate" else len(rows)
    if len(values) != expected:
        raise InvalidFile(path, "matrix", f"must hold {expected} entries as it says, got {len(values)}")
    matrix = np.zeros((n, n))
    np.add.at(matrix, (rows, columns), values)
    if symmetry == "symmetric":
        matrix = matrix + matrix.T - np.diag(np.diag(matrix))
    return MatrixFile({"": Labelled(matrix, None)})


def _sizes(path: Path, content: Iterator[tuple[int, str]], layout: str) -> tuple[int, int]:
    largest = 10_000  # rows that a dense matrix may have: 800 MB
    number, line = next(content, (1, ""))
    words = line.split()
    if len(words) != (3 if layout == "coordinate" else 2) or not all(word.isdecimal() for word in words):
        raise InvalidFile(path, "size", f"must hold rows, columns and entries, got {line!r}", line=number)
    sizes = [int(word) for word in words]
    if sizes[0] != sizes[1] or not 0 < sizes[0] <= largest:
        what = f"must be square with at most {largest} rows, got {sizes[0]} x {sizes[1]}"
        raise InvalidFile(path, "size", what, line=number)
    return sizes[0], sizes[-1]


def _entries(
    path: Path, content: Iterator[tuple[int, str]], layout: str, symmetry: str, n: int
) -> tuple[list[int], list[int], Floats]:
    """Return the row, column and value of every entry, counted from 0."""
    table = [(number, line, line.split()) for number, line in content]
    width = 3 if layout == "coordinate" else 1
    rows, columns, values = [], [], []
    for number, line, words in table:
        try:
            place = [int(word) for word in words[:-1]]
            values.append(float(words[-1]))
        except ValueError:
            place = []
        if len(words) != width or len(place) != width - 1 or not all(1 <= i <= n for i in place):
            wanted = f"row, column (1 to {n}) and value" if width == 3 else "one value"
            raise InvalidFile(path, "matrix", f"must hold {wanted}, got {line!r}", line=number)
        rows += [place[0] - 1] if place else []
        columns += [place[1] - 1] if place else []
    if layout == "array":
        lower, all_ = np.triu_indices(n), np.indices((n, n)).reshape(2, -1)
        down, across = (lower[1], lower[0]) if symmetry == "symmetric" else (all_[1], all_[0])
        rows, columns = down.tolist(), across.tolist()
    return rows, columns, np.array(values)
