r"""Super-elements in the files of other programs, chosen by the ending of the name.

Points are numbered from 1 in the order of the interfaces, internal modes after them. Freedoms stand along
the axes A of each point; with S of `superelement.foreign.unit`, the inverse of its eq. (1),

.. math:: X = S^{-1} A^T X_{SI} A S^{-1} / e                                                          (1)
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np

from flexarm.arguments import Kind, takes
from flexarm.arrays import Floats
from flexarm.errors import InvalidFile
from flexarm.output import refuse_existing, write_file
from flexarm.superelement import SuperElement
from flexarm.superelement.foreign.labelled import SCALAR, Freedom
from flexarm.superelement.foreign.unit import in_si, system
from flexarm.superelement.rigid_motion import PER_INTERFACE

NASTRAN = (".bdf", ".dat", ".nas")
ENDINGS = (".mat", *NASTRAN, ".inp")
"""Simscape, Nastran, Abaqus."""
PART = Kind("a SuperElement, such as SuperElement.load gives", lambda value: isinstance(value, SuperElement))


@takes(element=PART)
def export_part(element: SuperElement, out: str | Path, unit: str = "m", force: bool = True) -> list[Path]:
    """Write a super-element for Simscape (.mat), Nastran (.bdf, .dat, .nas) or Abaqus (.inp).

    Parameters
    ----------
    element : SuperElement
        The part.
    out : str or Path
        The file; Abaqus's matrices stand in files beside it.
    unit : {"m", "mm"}
        m: m, kg, s, N. mm: mm, t, s, N, MPa. Simscape takes m.
    force : bool
        Replace a file that exists.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    InvalidFile, InvalidParameter
        If the ending or the unit is not known, or a file cannot be written.
    """
    path = Path(out)
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        what = f"must end in {', '.join(ENDINGS)} (Simscape, Nastran, Abaqus), got {path.name!r}"
        raise InvalidFile(path, "output", what)
    if ending == ".mat":
        if unit != "m":
            raise InvalidFile(path, "unit", f"must be m for Simscape, got {unit!r}")

        return write_simscape(element, path, force)
    if ending in NASTRAN:
        return write_nastran(element, path, unit, force)

    return write_abaqus(element, path, unit, force)


def write_simscape(element: SuperElement, path: Path, force: bool = True) -> list[Path]:
    """Write a MAT file (level 5) in SI units for the block Reduced Order Flexible Solid; return it.

        origins      (n, 3)      interface frames' positions in the part's frame [m]
        quaternions  (n, 4)      their orientations, scalar first
        K, M, C      (dof, dof)  matrices [N/m, kg, N s/m and those of rotations]
        interfaces, frequency_hz, name

    The block takes, for each frame, translations then rotations along the reference frame's axes, and the
    modes last: the order of a super-element. Source: MathWorks, Simscape Multibody, Reduced Order Flexible
    Solid.
    """
    from scipy.io import savemat
    from scipy.spatial.transform import Rotation

    cells = np.empty((element.n_interfaces, 1), dtype=object)
    cells[:, 0] = element.interfaces
    image = BytesIO()
    savemat(
        image,
        {
            "name": element.name,
            "interfaces": cells,
            "origins": element.positions,
            "quaternions": np.roll(Rotation.from_matrix(element.rotations).as_quat(), 1, axis=1),
            "K": element.stiffness,
            "M": element.mass,
            "C": element.damping,
            "frequency_hz": element.frequency_hz[:, None],
        },
    )
    write_file(path, image.getbuffer(), force=force)
    return [path]


_KEYWORDS = {"stiffness": "STIFFNESS", "mass": "MASS", "damping": "VISCOUS DAMPING"}


def write_abaqus(element: SuperElement, path: Path, unit: str, force: bool = True) -> list[Path]:
    """Write an input deck with the points, and matrices as *MATRIX INPUT beside it; return the files.

    `part.inp` names `part_stiffness.mtx`, `part_mass.mtx` and `part_damping.mtx`: row point, component,
    column point, component, value of the lower triangle. Internal modes are freedom 1 of internal points,
    whose numbers are negative. Freedoms stand along the part's axes. Source: Abaqus 2017, Keywords Reference,
    *MATRIX INPUT, *MATRIX ASSEMBLE.
    """
    form = foreign_form(element, unit)
    matrices = {role: matrix for role in _KEYWORDS if (matrix := getattr(form, role)).any()}
    files = {role: path.with_name(f"{path.stem}_{role}.mtx") for role in matrices}
    for file in (path, *files.values()):
        refuse_existing(file, force)
    lines = ["*HEADING", f"{element.name}, reduced by flexarm, in {unit}"]
    for i, (name, position) in enumerate(zip(element.interfaces, form.positions, strict=True), 1):
        xyz = ", ".join(f"{x:.12g}" for x in position)
        lines += [f"** interface {name}", f"*NODE, NSET=INTERFACE_{i}", f"{i}, {xyz}"]
    for role, file in files.items():
        write_file(file, "\n".join(_entries(matrices[role], form)) + "\n", force=force)
        lines.append(f"*MATRIX INPUT, NAME={role.upper()}, INPUT={file.name}")
    lines.append("*MATRIX ASSEMBLE, " + ", ".join(f"{_KEYWORDS[role]}={role.upper()}" for role in files))
    write_file(path, "\n".join(lines) + "\n", force=force)
    return [path, *files.values()]


def _entries(matrix: Floats, form: ForeignForm) -> Iterator[str]:
    for i, row in enumerate(form.freedoms):
        for j, column in enumerate(form.freedoms[: i + 1]):
            if matrix[i, j] != 0:
                yield f"{_label(row)}, {_label(column)}, {matrix[i, j]:.14e}"


def _label(freedom: Freedom) -> str:
    return f"{-freedom.point}, 1" if freedom.component == SCALAR else f"{freedom.point}, {freedom.component}"


def write_nastran(element: SuperElement, path: Path, unit: str, force: bool = True) -> list[Path]:
    """Write bulk data: GRID and SPOINT, and DMIG entries KAAX, MAAX and BAAX; return the file.

    A run takes them by K2GG = KAAX, M2GG = MAAX and B2GG = BAAX in case control. The freedoms of a grid stand
    along the axes of its interface, by a CORD2R entry where those are turned. Source: MSC Nastran Quick
    Reference Guide, DMIG.
    """
    form = foreign_form(element, unit, element.rotations)
    lines = [
        f"$ {element.name}, reduced by flexarm, in {unit}",
        "$ case control: K2GG = KAAX, M2GG = MAAX, B2GG = BAAX",
        *_points(element, form),
    ]
    for name, matrix in (("KAAX", form.stiffness), ("MAAX", form.mass), ("BAAX", form.damping)):
        if matrix.any():
            lines += _dmig(name, matrix, form)
    write_file(path, "\n".join(lines) + "\n", force=force)
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
        yield start + "".join(
            f"{field:16d}" if isinstance(field, int) else f"{field:16.9E}" for field in fields[k : k + 4]
        )


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


@dataclass(frozen=True, eq=False)
class ForeignForm:
    """Points [unit], axes as columns, freedoms and matrices (1)."""

    positions: Floats
    axes: Floats
    freedoms: tuple[Freedom, ...]
    stiffness: Floats
    mass: Floats
    damping: Floats


def foreign_form(
    element: SuperElement, unit: str, axes: Sequence[Floats] | Floats | None = None
) -> ForeignForm:
    """Return a super-element for another program.

    Unit "m" is m, kg, s, N, and "mm" is mm, t, s, N, MPa. `axes`, shape (n, 3, 3), are those of the points'
    freedoms, as columns; the part's own by default.

    Raise InvalidParameter if the unit is not known.
    """
    length, _ = system(unit)
    n = element.n_interfaces
    turned = np.tile(np.eye(3), (n, 1, 1)) if axes is None else np.asarray(axes)
    freedoms = [Freedom(i + 1, c) for i in range(n) for c in range(1, PER_INTERFACE + 1)]
    freedoms += [Freedom(n + 1 + k, SCALAR) for k in range(element.n_modes)]
    A = np.eye(element.n_dof)
    for i in range(n):
        for start in (PER_INTERFACE * i, PER_INTERFACE * i + 3):
            A[start : start + 3, start : start + 3] = turned[i]
    scale = in_si(np.ones((element.n_dof,) * 2), freedoms, unit)
    K, M, C = (A.T @ X @ A / scale for X in (element.stiffness, element.mass, element.damping))  # eq. (1)
    return ForeignForm(element.positions / length, turned, tuple(freedoms), K, M, C)
