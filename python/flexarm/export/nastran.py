"""Super-elements as Nastran bulk data: GRID and SPOINT, and DMIG entries KAAX, MAAX and BAAX.

A run takes them by K2GG = KAAX, M2GG = MAAX and B2GG = BAAX in case control. The freedoms of a grid stand
along the axes of its interface, by a CORD2R entry where those are turned. Source: MSC Nastran Quick
Reference Guide, DMIG.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexarm.arrays import Floats
from flexarm.export.foreign_form import ForeignForm, foreign_form
from flexarm.output import write_file
from flexarm.superelement import SuperElement
from flexarm.superelement.foreign.labelled import SCALAR


def write_nastran(element: SuperElement, path: Path, unit: str) -> list[Path]:
    """Write points and matrices into one file; return it."""
    form = foreign_form(element, unit, element.rotations)
    lines = [
        f"$ {element.name}, reduced by flexarm, in {unit}",
        "$ case control: K2GG = KAAX, M2GG = MAAX, B2GG = BAAX",
        *_points(element, form),
    ]
    for name, matrix in (("KAAX", form.stiffness), ("MAAX", form.mass), ("BAAX", form.damping)):
        if matrix.any():
            lines += _dmig(name, matrix, form)
    write_file(path, "\n".join(lines) + "\n")
    return [path]


def _points(element: SuperElement, form: ForeignForm) -> Iterator[str]:
    for i, (name, position, axes) in enumerate(
        zip(element.interfaces, form.positions, form.axes, strict=True), 1
    ):
        yield f"$ interface {name}"
        system = 0 if np.array_equal(axes, np.eye(3)) else i
        if system:
            # Points A, B and C of a system: its origin, one on its z axis, one in its x-z plane
            yield from _large("CORD2R", [i, 0, *np.zeros(3), *axes[:, 2], *axes[:, 0]])
        yield from _large("GRID", [i, 0, *position, system])
    for freedom in form.freedoms:
        if freedom.component == SCALAR:
            yield f"{'SPOINT':<8}{freedom.point:8d}"


def _large(card: str, fields: list[float | int]) -> Iterator[str]:
    """Yield a card of wide fields, four a line."""
    for k in range(0, len(fields), 4):
        start = f"{card + '*':<8}" if k == 0 else f"{'*':<8}"
        yield start + "".join(_field(field) for field in fields[k : k + 4])


def _field(value: float | int) -> str:
    """Return a field of 16 characters: a whole number, or nine digits and an exponent."""
    return f"{value:16d}" if isinstance(value, int) else f"{value:16.9E}"


def _dmig(name: str, matrix: Floats, form: ForeignForm) -> Iterator[str]:
    """Yield a symmetric real matrix of double precision, by the columns of its lower triangle."""
    yield f"{'DMIG':<8}{name:<8}{0:8d}{6:8d}{2:8d}{0:8d}"
    for j, column in enumerate(form.freedoms):
        rows = [i for i in range(j, len(matrix)) if matrix[i, j] != 0]
        if rows:
            yield f"{'DMIG*':<8}{name:<16}{column.point:16d}{column.component:16d}"
        for i in rows:
            row = form.freedoms[i]
            value = f"{matrix[i, j]:16.9E}".replace("E", "D")
            yield f"{'*':<8}{row.point:16d}{row.component:16d}{value}"
