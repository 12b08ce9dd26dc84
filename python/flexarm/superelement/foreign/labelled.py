"""Matrices with names of freedoms: a point and a component, as finite element programs number them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter

SCALAR = 0
"""Component of a scalar point: an internal mode. Components 1 to 3 are translations, 4 to 6 rotations."""


@dataclass(frozen=True, order=True)
class Freedom:
    """One freedom of a foreign matrix: the number of its point and the component there."""

    point: int
    component: int

    def __str__(self) -> str:
        return f"{self.point}.{self.component}"


@dataclass(frozen=True, eq=False)
class Labelled:
    """A square matrix and the freedoms of its rows; None where the file does not say."""

    matrix: Floats
    freedoms: tuple[Freedom, ...] | None


@dataclass(frozen=True, eq=False)
class MatrixFile:
    """The matrices of a file by role or name, and the names of those left unread."""

    matrices: dict[str, Labelled]
    """Keys are the file's names, or "stiffness", "mass", "damping" where the format says which is which."""
    ignored: tuple[str, ...] = field(default=())
    """Names of matrices that flexarm has no use for."""


def ordered(matrix: Labelled, freedoms: Sequence[Freedom], what: str) -> Floats:
    """Return the matrix with its rows as in `freedoms`; freedoms that the file leaves out are zero.

    Raise InvalidParameter if a freedom occurs twice, or the matrix has one that is not in the list.
    """
    assert matrix.freedoms is not None
    place = {freedom: i for i, freedom in enumerate(freedoms)}
    if len(set(matrix.freedoms)) != len(matrix.freedoms):
        twice = next(f for f in matrix.freedoms if matrix.freedoms.count(f) > 1)
        raise InvalidParameter(f"freedom {twice} is named twice", where=what)
    if unknown := [f for f in matrix.freedoms if f not in place]:
        raise InvalidParameter(f"freedom {unknown[0]} is not among those of the stiffness", where=what)
    rows = [place[f] for f in matrix.freedoms]
    full = np.zeros((len(freedoms), len(freedoms)))
    full[np.ix_(rows, rows)] = matrix.matrix
    return full


def union(matrices: Iterable[Labelled]) -> tuple[Freedom, ...]:
    """Return all freedoms in rising order; a matrix file names only those where it is not zero."""
    return tuple(sorted({f for matrix in matrices for f in matrix.freedoms or ()}))
