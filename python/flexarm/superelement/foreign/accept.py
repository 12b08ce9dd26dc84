"""A foreign reduced part becomes a super-element, if it passes the checks."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from flexarm.arguments import INDICES, LISTED, PATH, POSITIVE, SHARE, takes
from flexarm.arrays import Floats
from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.superelement.checks import STATED_ORDER
from flexarm.superelement.element import SuperElement
from flexarm.superelement.foreign.grids import Grid, read_grids
from flexarm.superelement.foreign.interfaces import reduction
from flexarm.superelement.foreign.labelled import Freedom, Labelled, ordered, union
from flexarm.superelement.foreign.order import read_order
from flexarm.superelement.foreign.read import choose
from flexarm.superelement.foreign.unit import in_si, system
from flexarm.superelement.mass_checks import unlikely_density
from flexarm.superelement.rigid_motion import PER_INTERFACE
from flexarm.superelement.shape import HUGE, asymmetric_entry


@takes(stiffness=PATH, order=LISTED, interfaces=INDICES, mass=POSITIVE, tolerance=SHARE)
def accept_matrices(
    stiffness: str | Path,
    mass_matrix: str | Path | None = None,
    *,
    grids: str | Path,
    order: str | Path | None = None,
    damping_matrix: str | Path | None = None,
    interfaces: Mapping[str, int | Sequence[int]] | None = None,
    unit: str = "m",
    mass: float | None = None,
    tolerance: float | None = None,
    name: str | None = None,
) -> SuperElement:
    """Import reduced matrices of another program as a super-element, checked before they are accepted.

    Such matrices hold no coordinates, Matrix Market and OP4 no order of freedoms, none of them a unit. All
    three are stated here, and a wrong statement is refused: rigid motion must strain nothing, R^T M R must be
    the inertia of a body of a likely density and, if given, of the stated mass.

    Parameters
    ----------
    stiffness : str or Path
        File of the stiffness, FILE or FILE:NAME where it holds several: Matrix Market, Abaqus or CalculiX
        (.mtx, .sti), Nastran DMIG (.pch, .bdf) or OP4 (.op4).
    mass_matrix, damping_matrix : str or Path, optional
        Files of mass and damping where they do not stand with the stiffness; no damping if there is none.
    grids : str or Path
        Bulk data (GRID, CORD) or input deck (``*NODE``) with the points of the matrices.
    order : str or Path, optional
        Order of the freedoms where the file does not hold it, as a file or a list such as "11, 12,
        101-104.0".
    interfaces : mapping, optional
        Names of interfaces and the numbers of their points; several points are tied rigidly. Points left out
        are named grid_NUMBER.
    unit : {"m", "mm"}
        m: m, kg, s, N. mm: mm, t, s, N, MPa.
    mass : float, optional
        What the part weighs [kg].
    tolerance : float, optional
        Relative error of the numbers; the default 1e-5 suits files of six digits.
    name : str, optional
        Name of the part; that of the stiffness file if left out.

    Raises
    ------
    InvalidFile
        If a file is damaged, or no elastic part could have these matrices.
    """
    length, _ = system(unit)
    chosen = choose(stiffness, mass_matrix, damping_matrix)
    stated = None if order is None else read_order(order)
    freedoms, K, M, C = _aligned(stiffness, chosen.stiffness, chosen.mass, chosen.damping, stated)
    points = {n: Grid(length * grid.position, grid.axes) for n, grid in read_grids(grids).items()}
    wanted = {
        key: [value] if isinstance(value, int) else list(value) for key, value in (interfaces or {}).items()
    }
    with naming_file(stiffness):
        told = {"source": "foreign matrices", "unit_of_source": unit}
        for role, source in (
            ("stiffness", stiffness),
            ("mass", mass_matrix),
            ("damping", damping_matrix),
            ("grids", grids),
        ):
            path = Path(str(source))
            if source is not None and path.is_file():
                told[f"{role}_file"] = path.name
                told[f"{role}_sha256"] = hashlib.sha256(path.read_bytes()).hexdigest()
        if chosen.ignored:
            told["ignored"] = ", ".join(chosen.ignored)
        element = from_matrices(
            K,
            M,
            C,
            freedoms=freedoms,
            grids=points,
            interfaces=wanted,
            unit=unit,
            name=name or Path(str(stiffness)).stem,
            provenance={
                **told,
                "order_of_source": "of the file" if stated is None else STATED_ORDER,
            },
        )
        element.check(mass=mass, tolerance=tolerance)
        for problem in unlikely_density(element) if mass is None else ():  # it alone shows a wrong unit
            raise InvalidParameter(problem.what, where=problem.where)
    return element


def from_matrices(
    stiffness: Floats,
    mass: Floats,
    damping: Floats | None,
    *,
    freedoms: Sequence[Freedom],
    grids: Mapping[int, Grid],
    interfaces: Mapping[str, Sequence[int]],
    unit: str,
    name: str,
    provenance: Mapping[str, str],
) -> SuperElement:
    """Return the super-element of matrices with named freedoms; it is not checked yet.

    Raise InvalidParameter if points and freedoms make no interfaces, or the internal modes have no mass.
    """
    tied = reduction(freedoms, grids, interfaces)
    K, M, C = (
        tied.Q.T @ in_si(matrix, freedoms, unit) @ tied.Q
        if matrix is not None
        else np.zeros((tied.Q.shape[1],) * 2)
        for matrix in (stiffness, mass, damping)
    )
    T, frequency_hz = _modal(K, M, PER_INTERFACE * len(tied.names))
    K, M, C = (T.T @ X @ T for X in (K, M, C))
    K, M, C = ((X + X.T) / 2 for X in (K, M, C))  # asymmetric matrices were refused before
    return SuperElement(
        name=name,
        interfaces=tied.names,
        positions=tied.positions,
        rotations=tied.rotations,
        stiffness=K,
        mass=M,
        damping=C,
        frequency_hz=frequency_hz,
        provenance=provenance,
    )


def _modal(K: Floats, M: Floats, held: int) -> tuple[Floats, Floats]:
    """Turn the internal coordinates into modes of unit mass, lowest first; return T and frequencies [Hz]."""
    from scipy.linalg import LinAlgError, eigh

    T = np.eye(len(K))
    if len(K) == held:
        return T, np.zeros(0)
    try:
        squares, shapes = eigh(*((X[held:, held:] + X[held:, held:].T) / 2 for X in (K, M)))
    except LinAlgError:
        raise InvalidParameter("the internal modes have no positive mass", where="mass") from None
    if squares[0] <= 0:
        what = (
            f"the internal modes must be stiff with all interfaces held, got the eigenvalue {squares[0]:.4g}"
        )
        raise InvalidParameter(what, where="stiffness")
    T[held:, held:] = shapes
    return T, np.sqrt(squares) / (2 * np.pi)


def _aligned(
    source: str | Path, K: Labelled, M: Labelled, C: Labelled | None, stated: tuple[Freedom, ...] | None
) -> tuple[tuple[Freedom, ...], Floats, Floats, Floats | None]:
    """Return all matrices over one order of freedoms."""
    given = [matrix for matrix in (K, M, C) if matrix is not None]
    if stated is None and any(matrix.freedoms is None for matrix in given):
        what = "the file does not say which freedom a row is; state it, such as --order '11, 12, 101-104.0'"
        raise InvalidFile(source, "order", what)
    if stated is not None and all(matrix.freedoms is not None for matrix in given):
        raise InvalidFile(source, "order", "the file names its freedoms; leave --order out")
    roles = [role for matrix, role in zip((K, M, C), ("stiffness", "mass", "damping"), strict=True) if matrix]
    named = []
    for matrix, role in zip(given, roles, strict=True):
        labels = matrix.freedoms if matrix.freedoms is not None else stated
        assert labels is not None
        if len(labels) != len(matrix.matrix):
            what = f"has {len(matrix.matrix)} rows, the stated order {len(labels)} freedoms"
            raise InvalidFile(source, role, what)
        _refuse_asymmetric(source, role, matrix.matrix, labels)
        named.append(Labelled(matrix.matrix, labels))
    freedoms = stated or union(named)
    with naming_file(source):
        full = [ordered(matrix, freedoms, role) for matrix, role in zip(named, roles, strict=True)]
    return freedoms, full[0], full[1], full[2] if len(full) > 2 else None


def _refuse_asymmetric(source: str | Path, role: str, matrix: Floats, freedoms: Sequence[Freedom]) -> None:
    """Refuse half of a matrix, or a damaged one, before anything is done to it."""
    if not (np.abs(matrix) < HUGE).all():
        raise InvalidFile(source, role, f"holds numbers that are not finite and below {HUGE:g}")
    place = asymmetric_entry(matrix)
    if place:
        i, j = place
        places = f"[{freedoms[i]}, {freedoms[j]}]"
        what = f"must be symmetric, got {matrix[i, j]:.8g} at {places} and {matrix[j, i]:.8g} across"
        raise InvalidFile(source, role, what)


@contextmanager
def naming_file(file: str | Path) -> Iterator[None]:
    """Name the file in errors that do not."""
    try:
        yield
    except InvalidFile:
        raise
    except InvalidParameter as error:
        first = error.problems[0]
        raise InvalidFile(file, first.where, first.what, problems=error.problems) from None
