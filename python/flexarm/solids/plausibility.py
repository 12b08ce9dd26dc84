"""Plausibility rules: values that are allowed in a mesh and yet look wrong."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexarm import _core
from flexarm.errors import Problem
from flexarm.solids.checks import FLAT
from flexarm.solids.core import smallest_jacobians

if TYPE_CHECKING:
    from flexarm.solids.mesh import SolidMesh

#: A part beyond these sizes [m] is no robot's: it was probably drawn in millimetres, or taken for it.
LARGEST, SMALLEST = 50.0, 1e-4
#: A solid part heavier than this [kg] is no arm's: booms of the largest excavators have some tens of tonnes.
#: Cells whose smallest det J is below this part of an ideal cell's are badly distorted.


def validate(mesh: SolidMesh) -> Iterator[Problem]:
    """Yield all plausibility problems of a mesh."""
    yield from _size(mesh)
    yield from _materials(mesh)
    yield from _sets(mesh)
    yield from _distorted(mesh)


def refuse_implausible(mesh: SolidMesh) -> None:
    """Refuse a part whose size or mass no part of an arm has: a unit was left out.

    Raises
    ------
    InvalidParameter
        With size and mass, and how to insist.
    """
    heaviest = 1e5
    size = float((mesh.box[1] - mesh.box[0]).max())
    mass = float(_core.mass_properties(mesh.core())[0])
    if SMALLEST <= size <= LARGEST and mass <= heaviest:
        return
    unit = "m" if size < SMALLEST else "mm"
    raise mesh.error(
        "unit",
        f"the part is {size:.4g} m across and weighs {mass:.4g} kg; allowed are {SMALLEST:g} to "
        f"{LARGEST:g} m, {heaviest:g} kg. Say --unit {unit} (unit = {unit!r}), or "
        "state with --mass what it weighs",
    )


def _size(mesh: SolidMesh) -> Iterator[Problem]:
    if not mesh.n_points:
        return
    size = float((mesh.box[1] - mesh.box[0]).max())
    if size > LARGEST:
        yield Problem("unit", f"the part is {size:.4g} m across; did you mean unit = 'mm'?")
    elif size < SMALLEST:
        yield Problem("unit", f"the part is {size:.4g} m across; did you mean unit = 'm'?")


def _materials(mesh: SolidMesh) -> Iterator[Problem]:
    for name, material in mesh.materials.items():
        if material.youngs_modulus < 1e6:
            yield Problem(
                f"materials.{name}",
                f"E is {material.youngs_modulus:g} Pa, softer than rubber; moduli are in Pa (steel 210e9); "
                "unit = 'mm' converts those of files in MPa",
            )
        if not 50 < material.density < 25e3:
            yield Problem(
                f"materials.{name}",
                f"density is {material.density:g} kg/m3; densities are in kg/m3 (steel 7850); unit = 'mm' "
                "converts those of files in t/mm3",
            )


def _sets(mesh: SolidMesh) -> Iterator[Problem]:
    empty = [name for name, points in mesh.point_sets.items() if not len(points)]
    if empty:
        yield Problem("point sets", f"without points of solid cells: {', '.join(empty)}")


def _distorted(mesh: SolidMesh) -> Iterator[Problem]:
    distorted = 0.05
    for kind, values in smallest_jacobians(mesh).items():
        bad = np.flatnonzero((values > FLAT) & (values < distorted))
        if len(bad):
            worst = bad[values[bad].argmin()]
            yield Problem(
                f"cells.{kind}",
                f"{len(bad)} of {len(values)} cells are badly distorted (det J below {distorted} of an ideal "
                f"cell's); the worst is cell {mesh.cell_numbers[kind][worst]} with {values[worst]:.2g}",
            )
