"""A part as a mesh of solid cells: points, cells, groups of cells, sets of points, materials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexarm.arguments import ARRAY, GROUPS, INDICES, MATERIAL, MATERIALS, NUMBER, SOLID, VECTOR, holds, takes
from flexarm.arrays import Floats, Ints
from flexarm.errors import InvalidFile, InvalidParameter, Problem
from flexarm.material import Material
from flexarm.output import output_file
from flexarm.solids.assigned import known_names
from flexarm.solids.cell_types import CELL_TYPES

CellGroup = Mapping[str, Ints]

if TYPE_CHECKING:
    from flexarm import _core


@holds(points=ARRAY, cells=INDICES, cell_groups=GROUPS, point_sets=INDICES, materials=MATERIALS)
@dataclass(frozen=True, eq=False)
class SolidMesh:
    """A part as solid finite elements.

    Arrays are copied and read-only. Ints count from 0; what messages show are the numbers of the file.

    Parameters
    ----------
    points : (n_points, 3)
        Coordinates in the part's frame [m].
    cells : mapping
        `tet4`, `tet10`, `hex8`, `hex20` -> (n_cells, n_nodes) indices of points, in the node order of VTK.
    cell_groups : mapping, optional
        Name -> {type: indices of cells of that type}. Groups may overlap.
    point_sets : mapping, optional
        Name -> indices of points: the places where a part is held, loaded or joined.
    materials : mapping, optional
        Name of a group -> its material, SI. `with_materials(material)` gives one to all cells that lack it.
    file : str
        Where the mesh comes from, as messages name it.
    cell_numbers, point_numbers : optional
        Numbers in that file, for messages: type -> (n_cells,), and (n_points,). Default: 1, 2, ...
    notes : tuple of Problem
        What reading left out or changed.
    """

    points: Floats
    cells: Mapping[str, Ints]
    cell_groups: Mapping[str, CellGroup] = field(default_factory=dict)
    point_sets: Mapping[str, Ints] = field(default_factory=dict)
    materials: Mapping[str, Material] = field(default_factory=dict)
    file: str = ""
    cell_numbers: Mapping[str, Ints] = field(default_factory=dict)
    point_numbers: Ints | None = None
    notes: tuple[Problem, ...] = ()

    def __post_init__(self) -> None:
        points = _frozen(self.points, np.float64)
        if points.ndim != 2 or points.shape[1] != 3:
            raise self.error("points", f"must have the shape (n, 3), got {points.shape}")
        cells = {name: self._connectivity(name, nodes, len(points)) for name, nodes in self.cells.items()}
        cells = {name: nodes for name, nodes in cells.items() if len(nodes)}
        sizes = {name: len(nodes) for name, nodes in cells.items()}
        values = {
            "points": points,
            "cells": cells,
            "cell_groups": {
                name: self._group(name, group, sizes) for name, group in self.cell_groups.items()
            },
            "point_sets": {
                name: self._indices(f"point set {name!r}", indices, len(points))
                for name, indices in self.point_sets.items()
            },
            "materials": dict(self.materials),
            "cell_numbers": {
                name: _frozen(self.cell_numbers.get(name, np.arange(1, n + 1)), np.int64)
                for name, n in sizes.items()
            },
            "point_numbers": _frozen(
                np.arange(1, len(points) + 1) if self.point_numbers is None else self.point_numbers, np.int64
            ),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _connectivity(self, name: str, nodes: ArrayLike, n_points: int) -> Ints:
        if name not in CELL_TYPES:
            raise self.error("cells", f"unknown type {name!r}; allowed are {', '.join(CELL_TYPES)}")
        array, width = np.asarray(nodes), CELL_TYPES[name].n_nodes
        if array.ndim != 2 or array.shape[1] != width:
            raise self.error(f"cells.{name}", f"must have the shape (n, {width}), got {array.shape}")
        return self._indices(f"cells.{name}", array, n_points)

    def _group(self, name: str, group: CellGroup, sizes: Mapping[str, int]) -> dict[str, Ints]:
        return {
            kind: self._indices(f"cell group {name!r}", indices, sizes.get(kind, 0))
            for kind, indices in group.items()
            if len(indices)
        }

    def _indices(self, where: str, indices: ArrayLike, size: int) -> Ints:
        array = np.asarray(indices)
        if array.size and (array.min() < 0 or array.max() >= size):
            wrong = int(array.min() if array.min() < 0 else array.max())
            raise self.error(where, f"refers to index {wrong}; there are {size}, counted from 0")
        return _frozen(array, np.int32)

    def error(self, where: str, what: str) -> InvalidParameter:
        """Return an error that names the file if there is one."""
        return InvalidFile(self.file, where, what) if self.file else InvalidParameter(what, where=where)

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.points)

    @property
    def n_cells(self) -> int:
        """Number of cells of all types."""
        return sum(len(nodes) for nodes in self.cells.values())

    @property
    def n_dof(self) -> int:
        """Degrees of freedom: three a point."""
        return 3 * self.n_points

    @property
    def box(self) -> Floats:
        """Smallest and largest coordinates [m], shape (2, 3)."""
        return np.array([self.points.min(axis=0), self.points.max(axis=0)])

    @property
    def warnings(self) -> tuple[Problem, ...]:
        """Notes of the reader, and values that are allowed and yet look wrong."""
        from flexarm.solids.checks import validate

        return (*self.notes, *validate(self))

    def point_set(self, name: str) -> Ints:
        """Return the indices of the points of a set.

        Raises
        ------
        InvalidParameter
            If there is no such set or it is empty; the message lists those there are.
        """
        if name not in self.point_sets:
            raise self.error(
                f"point set {name!r}",
                f"does not exist; {known_names(name, self.point_sets, 'the mesh has no point sets')}",
            )
        if not len(self.point_sets[name]):
            raise self.error(f"point set {name!r}", "is empty; an interface needs at least one point")
        return self.point_sets[name]

    def material_indices(self) -> tuple[list[Material], dict[str, Ints]]:
        """Return the materials and, for each type, the index of each cell's material.

        Raises
        ------
        InvalidParameter
            If a cell has no material, or two different ones.
        """
        from flexarm.solids.assigned import material_indices

        return material_indices(self)

    def core(self) -> _core.SolidMesh:
        """Return the mesh as the solver takes it."""
        from flexarm.solids.core import core_mesh

        return core_mesh(self, *self.material_indices())

    def check(self) -> Self:
        """Return this mesh if nothing in it spoils a computation.

        Raises
        ------
        InvalidParameter
            `InvalidFile` if the mesh comes from a file; `problems` lists all that is wrong.
        """
        from flexarm.solids.checks import problems

        found = tuple(problems(self))
        if found and self.file:
            raise InvalidFile(self.file, found[0].where, found[0].what, problems=found)
        if found:
            raise InvalidParameter(found[0].what, where=found[0].where, problems=found)
        return self

    @takes()
    def moved(self, rotation: ArrayLike | None = None, translation: ArrayLike = (0.0, 0.0, 0.0)) -> Self:
        """Return the part in another place: x -> R x + t, R a rotation matrix, t in m."""
        turn = np.eye(3) if rotation is None else np.asarray(rotation, dtype=float)
        return replace(self, points=self.points @ turn.T + np.asarray(translation, dtype=float))

    @takes(materials=MATERIAL)
    def with_materials(self, materials: Mapping[str, Material] | Material) -> SolidMesh:
        """Return the mesh with these materials: by group, or one for all cells that have none."""
        from flexarm.solids.assigned import with_materials

        return with_materials(self, materials)

    @takes()
    def with_point_set(self, name: str, points: ArrayLike) -> Self:
        """Return the mesh with one more set of points."""
        return replace(self, point_sets={**self.point_sets, name: np.asarray(points)})

    @takes(lower=VECTOR, upper=VECTOR)
    def points_in_box(self, lower: ArrayLike, upper: ArrayLike) -> Ints:
        """Return the points with lower <= (x, y, z) <= upper [m]; `-inf` and `inf` leave a side open.

        >>> from flexarm.solids import ring
        >>> inf = float("inf")
        >>> part = ring(0.1, 0.2, 0.1, size=0.1)
        >>> part = part.with_point_set("foot", part.points_in_box([-inf, -inf, 0], [inf, inf, 1e-6]))
        """
        inside = (self.points >= np.asarray(lower)) & (self.points <= np.asarray(upper))
        return np.flatnonzero(inside.all(axis=1))

    @takes(tolerance=NUMBER)
    def merged(self, tolerance: float) -> SolidMesh:
        """Merge points closer than `tolerance` [m]."""
        from flexarm.solids.joining import merge_points

        return merge_points(self, tolerance)

    @takes(other=SOLID, tolerance=NUMBER)
    def joined(self, other: SolidMesh, tolerance: float = 0.0) -> SolidMesh:
        """Join this mesh and another; merge points closer than `tolerance` [m]."""
        from flexarm.solids.joining import join

        return join(self, other, tolerance)

    def describe(self) -> str:
        """Return size, cells, groups with their materials, sets: one thing a line."""
        counts = ", ".join(f"{len(nodes)} {kind}" for kind, nodes in self.cells.items()) or "no cells"
        size = " x ".join(f"{x:.4g}" for x in self.box[1] - self.box[0]) if self.n_points else "empty"
        lines = [
            f"{self.file or 'mesh'}: {self.n_points} points, {self.n_dof} degrees of freedom, {counts}",
            f"  size  {size} m",
        ]
        for name, group in self.cell_groups.items():
            lines.append(f"  group {name}: {sum(len(indices) for indices in group.values())} cells")
            if m := self.materials.get(name):
                lines[-1] += (
                    f", E = {m.youngs_modulus:.4g} Pa, nu = {m.poisson_ratio:g}, rho = {m.density:g} kg/m3"
                )
        lines += [f"  set   {name}: {len(points)} points" for name, points in self.point_sets.items()]
        return "\n".join(lines)

    @takes()
    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Write points, cells, groups and sets as VTU (ParaView opens it; `read_mesh` reads it back).

        Sets and groups are masks on points and cells. Materials are not written: VTU has none.
        """
        import meshlane

        file, kinds = Path(path), list(self.cells)
        if file.suffix.lower() != ".vtu":
            raise InvalidParameter(f"must end in .vtu, got {file.name!r}", where="path")
        if file.exists() and not force:
            raise InvalidParameter(f"{file} exists; force = True replaces it", where="path")
        written = meshlane.Mesh(
            self.points,
            [(CELL_TYPES[kind].meshio, self.cells[kind]) for kind in kinds],
            point_data={name: _mask(self.n_points, points) for name, points in self.point_sets.items()},
            cell_data={
                name: [_mask(len(self.cells[kind]), group.get(kind, np.empty(0, int))) for kind in kinds]
                for name, group in self.cell_groups.items()
            },
        )
        with output_file(file) as partial:
            meshlane.vtu.write(str(partial), written)
        return file


def _mask(n: int, indices: Ints) -> NDArray[np.int8]:
    mask = np.zeros(n, dtype=np.int8)
    mask[indices] = 1
    return mask


def _frozen(values: ArrayLike, kind: Any) -> NDArray[Any]:
    array: NDArray[Any] = np.array(values, dtype=kind)
    array.setflags(write=False)
    return array
