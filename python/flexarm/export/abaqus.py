"""Super-elements for Abaqus: an input deck with the points, and matrices as *MATRIX INPUT beside it.

`part.inp` names `part_stiffness.mtx`, `part_mass.mtx` and `part_damping.mtx`: row point, component, column
point, component, value of the lower triangle. Internal modes are freedom 1 of internal points, whose
numbers are negative. Freedoms stand along the part's axes. Source: Abaqus 2017, Keywords Reference, *MATRIX
INPUT, *MATRIX ASSEMBLE.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from flexarm.arrays import Floats
from flexarm.export.foreign_form import ForeignForm, foreign_form
from flexarm.output import write_file
from flexarm.superelement import SuperElement
from flexarm.superelement.foreign.labelled import SCALAR, Freedom

_KEYWORDS = {"stiffness": "STIFFNESS", "mass": "MASS", "damping": "VISCOUS DAMPING"}


def write_abaqus(element: SuperElement, path: Path, unit: str) -> list[Path]:
    """Write the deck and its matrices; return the files."""
    form = foreign_form(element, unit)
    lines = ["*HEADING", f"{element.name}, reduced by flexarm, in {unit}"]
    for i, (name, position) in enumerate(zip(element.interfaces, form.positions, strict=True), 1):
        xyz = ", ".join(f"{x:.12g}" for x in position)
        lines += [f"** interface {name}", f"*NODE, NSET=INTERFACE_{i}", f"{i}, {xyz}"]
    files, assembled = [], []
    for role, keyword in _KEYWORDS.items():
        matrix = getattr(form, role)
        if not matrix.any():
            continue
        file = path.with_name(f"{path.stem}_{role}.mtx")
        write_file(file, "\n".join(_entries(matrix, form)) + "\n")
        lines.append(f"*MATRIX INPUT, NAME={role.upper()}, INPUT={file.name}")
        assembled.append(f"{keyword}={role.upper()}")
        files.append(file)
    lines.append(f"*MATRIX ASSEMBLE, {', '.join(assembled)}")
    write_file(path, "\n".join(lines) + "\n")
    return [path, *files]


def _entries(matrix: Floats, form: ForeignForm) -> Iterator[str]:
    for i, row in enumerate(form.freedoms):
        for j, column in enumerate(form.freedoms[: i + 1]):
            if matrix[i, j] != 0:
                yield f"{_label(row)}, {_label(column)}, {matrix[i, j]:.14e}"


def _label(freedom: Freedom) -> str:
    return f"{-freedom.point}, 1" if freedom.component == SCALAR else f"{freedom.point}, {freedom.component}"
