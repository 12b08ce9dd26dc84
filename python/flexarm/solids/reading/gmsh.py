"""Gmsh meshes (.msh, versions 2.2 and 4.1, text or binary).

A file is a row of sections, `$NAME` to `$EndNAME`, each of counts and numbers; source: Gmsh reference manual,
"MSH file format". meshlane, which has the types of cells and the orders of their nodes, would take up the
memory that counts ask for before it looks whether the file holds as much.

A physical volume is a group of cells; physical surfaces, curves and points are sets of their points. One
without a name is called `volume-1`, `surface-7`, `curve-3`, `point-2`. Version 2.2 writes a cell once for
each physical group that has it; these are made one again.
"""

from __future__ import annotations

import shlex
from collections import Counter
from dataclasses import dataclass, field
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import IO, Any

import numpy as np

from flexarm.arrays import Floats, Ints
from flexarm.errors import InvalidFile
from flexarm.solids.reading.content import Block, Content
from flexarm.solids.reading.through_meshlane import read_by

_DIMENSION = ("point", "curve", "surface", "volume")


def content(path: Path) -> Content:
    """Read the content of a Gmsh file."""
    return read_by(_content, path, "Gmsh mesh")


def _content(path: Path) -> Content:
    with path.open("rb") as file:
        found = _Sections(_Numbers(path, file))
        while line := file.readline():
            found.read(line.strip().decode(errors="replace"))
    if found.nodes is None or not found.cells:
        what = "such a file begins with $MeshFormat, version 2.2 or 4.1, and holds $Nodes and $Elements"
        raise ValueError(what)
    tags, points = found.nodes
    mesh = Content(points, tags, [cells.block(tags) for cells in found.cells], repeats=True)
    for i, cells in enumerate(found.cells):
        for tag, members in cells.groups.items():
            name = found.names.get((cells.dimension, tag), f"{_DIMENSION[cells.dimension]}-{tag}")
            mesh.groups.setdefault(name, {})[i] = members
    return mesh


class _Numbers:
    """The numbers of a file in turn; no more are taken up than it can hold."""

    def __init__(self, path: Path, file: IO[bytes]) -> None:
        self.path, self.file = path, file
        self.bytes = path.stat().st_size
        self.text = True
        self.size = np.dtype(np.uint64)
        """Type of counts and numbers in version 4.1."""

    def take(self, section: str, kind: Any, count: int) -> Any:
        """Return the next numbers.

        Raise InvalidFile if the file is too short for so many, ValueError if it ends before them.
        """
        shortest = 2 if self.text else np.dtype(kind).itemsize  # a digit and a blank
        if not 0 <= count * shortest <= self.bytes - self.file.tell() + 1:
            what = f"declares {count} entries in a file of {self.bytes} bytes"
            raise InvalidFile(self.path, section, what)
        found = np.fromfile(self.file, kind, count, " " if self.text else "")
        if len(found) < count:
            raise ValueError(f"{section} ends after {len(found)} of {count} numbers")
        return found

    def count(self, section: str) -> int:
        """Return the next number, of version 4.1, as a count."""
        return int(self.take(section, self.size, 1)[0])


@dataclass
class _Cells:
    """Cells of one type: their numbers, the numbers of their nodes, and members by physical group."""

    kind: str
    dimension: int
    numbers: Ints
    nodes: Ints
    groups: dict[int, Ints]

    def block(self, tags: Ints) -> Block:
        """Return the cells with indices of nodes, -1 for those that are not there."""
        from meshlane.gmsh.common import _gmsh_to_meshio_order

        order = np.argsort(tags, kind="stable")
        place = np.searchsorted(tags[order], self.nodes, side="right") - 1
        index = np.where(tags[order[place]] == self.nodes, order[place], -1)
        return Block(self.kind, np.asarray(_gmsh_to_meshio_order(self.kind, index)), self.numbers)


@dataclass
class _Sections:
    """What the sections of a file hold, as they are read one after the other."""

    numbers: _Numbers
    version: str = ""
    names: dict[tuple[int, int], str] = field(default_factory=dict)
    """Dimension and number of a physical group -> its name."""
    physical: dict[tuple[int, int], Ints] = field(default_factory=dict)
    """Dimension and number of an entity of version 4.1 -> the numbers of its physical groups."""
    nodes: tuple[Ints, Floats] | None = None
    """Numbers, and places, of shapes (n,) and (n, 3)."""
    cells: list[_Cells] = field(default_factory=list)

    def read(self, section: str) -> None:
        """Read a section that concerns a part; its first line was read already."""
        readers = {
            "$PhysicalNames": (self._names, self._names),
            "$Entities": (lambda: None, self._entities),
            "$PartitionedEntities": (lambda: None, self._partitioned),
            "$Nodes": (self._nodes_2, self._nodes_4),
            "$Elements": (self._cells_2, self._cells_4),
        }
        if section == "$MeshFormat":
            self._format()
        elif self.version and section in readers:
            readers[section][self.version[0] == "4"]()

    def _format(self) -> None:
        self.version, binary, size = self._line().split()
        if self.version not in ("2", "2.2", "4.1"):
            what = f"must be version 2.2 or 4.1, got {self.version}; Gmsh saves either"
            raise InvalidFile(self.numbers.path, "$MeshFormat", what)
        self.numbers.text = binary == "0"
        self.numbers.size = np.dtype(f"u{size}")
        if not self.numbers.text and self.numbers.take("$MeshFormat", np.intc, 1)[0] != 1:
            what = "holds numbers in another order of bytes; save it on this machine"
            raise InvalidFile(self.numbers.path, "$MeshFormat", what)

    def _line(self) -> str:
        if not (line := self.numbers.file.readline()):
            raise ValueError("ends in the middle of a section")
        return line.decode(errors="replace")

    def _names(self) -> None:
        rows = [shlex.split(self._line()) for _ in range(int(self._line()))]
        twice = [name for name, count in Counter(row[2] for row in rows).items() if count > 1]
        if twice:
            kinds = ", ".join(f"{_DIMENSION[int(row[0])]} {row[1]}" for row in rows if row[2] == twice[0])
            what = f"{twice[0]!r} is the name of {kinds}; every physical group needs its own"
            raise InvalidFile(self.numbers.path, "$PhysicalNames", what)
        self.names = {(int(dimension), int(tag)): name for dimension, tag, name, *_ in rows}

    def _partitioned(self) -> None:
        """Read parts of entities, as a mesh cut for parallel programs has them, behind ghosts."""
        section, take = "$PartitionedEntities", self.numbers.take
        self.numbers.count(section)
        take(section, np.intc, 2 * self.numbers.count(section))
        self._entities(section)

    def _entities(self, section: str = "$Entities") -> None:
        """Read entities: number, box, physical groups, and for all but points what bounds them.

        A partition's has, after its number, that of its whole and a list of partitions. A negative number of
        a group says that its entity is reversed.
        """
        take = self.numbers.take
        for dimension, count in enumerate(take(section, self.numbers.size, 4)):
            for _ in range(int(count)):
                tag = int(take(section, np.intc, 1)[0])
                if section == "$PartitionedEntities":
                    take(section, np.intc, 2)
                    take(section, np.intc, self.numbers.count(section))
                take(section, np.double, 3 if dimension == 0 else 6)
                self.physical[dimension, tag] = take(section, np.intc, self.numbers.count(section))
                if dimension > 0:
                    take(section, np.intc, self.numbers.count(section))

    def _nodes_2(self) -> None:
        """Read rows of a number and x, y, z."""
        row = np.dtype([("tag", np.intc), ("x", np.double, 3)])
        section, count = "$Nodes", int(self._line())
        if self.numbers.text:
            rows = self.numbers.take(section, np.double, 4 * count).reshape(count, 4)
            self.nodes = rows[:, 0].astype(np.int64), rows[:, 1:]
        else:
            found = self.numbers.take(section, row, count)
            self.nodes = found["tag"].astype(np.int64), found["x"].copy()

    def _nodes_4(self) -> None:
        """Read blocks of an entity, a count, then all numbers, then all places."""
        section, take = "$Nodes", self.numbers.take
        n_blocks, total, _, _ = take(section, self.numbers.size, 4).tolist()
        tags, places = [np.empty(0, np.int64)], [np.empty((0, 3))]
        for _ in range(n_blocks):
            if take(section, np.intc, 3)[2]:
                what = "holds parametric coordinates; save without 'Save parametric coordinates'"
                raise InvalidFile(self.numbers.path, section, what)
            count = self.numbers.count(section)
            tags.append(take(section, self.numbers.size, count).astype(np.int64))
            places.append(take(section, np.double, 3 * count).reshape(count, 3))
        self.nodes = np.concatenate(tags), np.concatenate(places)
        self._refuse_other(section, total, len(self.nodes[0]))

    def _refuse_other(self, section: str, declared: int, held: int) -> None:
        if declared != held:
            what = f"declares {declared} entries, its blocks hold {held}"
            raise InvalidFile(self.numbers.path, section, what)

    def _cells_2(self) -> None:
        """Read cells: number, type, count of tags, tags, nodes; the first tag is the physical group."""
        self.cells = []
        count = int(self._line())
        if not self.numbers.text:
            return self._batches(count)
        rows = (list(map(int, self._line().split())) for _ in range(count))
        for kind, alike in groupby(rows, itemgetter(1)):
            width = self._type(kind)[1]
            cells = [(row[0], row[3] if row[2] else 0, row[3 + row[2] :]) for row in alike]
            if wrong := next((number for number, _, nodes in cells if len(nodes) != width), None):
                raise ValueError(f"$Elements: cell {wrong} must have {width} nodes")
            numbers, tags, nodes = (np.array(each, np.int64) for each in zip(*cells, strict=True))
            self._add(kind, numbers, nodes, _by_tag(tags))
        return None

    def _batches(self, left: int) -> None:
        """Read batches of a type, a count and the count of tags, then the rows of so many cells."""
        section = "$Elements"
        while left > 0:
            kind, count, n_tags = self.numbers.take(section, np.intc, 3).tolist()
            width = 1 + n_tags + self._type(kind)[1]
            rows = self.numbers.take(section, np.intc, count * width).reshape(count, width).astype(np.int64)
            tags = rows[:, 1] if n_tags else np.zeros(count, np.int64)
            self._add(kind, rows[:, 0], rows[:, 1 + n_tags :], _by_tag(tags))
            left -= max(1, count)

    def _cells_4(self) -> None:
        """Read blocks of an entity, a type and a count, then number and nodes of each cell."""
        self.cells = []
        section, take = "$Elements", self.numbers.take
        n_blocks, total, _, _ = take(section, self.numbers.size, 4).tolist()
        for _ in range(n_blocks):
            dimension, entity, kind = take(section, np.intc, 3).tolist()
            count, width = self.numbers.count(section), 1 + self._type(kind)[1]
            rows = take(section, self.numbers.size, count * width).reshape(count, width).astype(np.int64)
            tags = self.physical.get((dimension, entity), ())
            self._add(kind, rows[:, 0], rows[:, 1:], {abs(int(tag)): np.arange(count) for tag in tags if tag})
        self._refuse_other(section, total, sum(len(cells.numbers) for cells in self.cells))

    def _add(self, kind: int, numbers: Ints, nodes: Ints, groups: dict[int, Ints]) -> None:
        from meshlane._mesh import topological_dimension

        name = self._type(kind)[0]
        self.cells.append(_Cells(name, topological_dimension[name], numbers, nodes, groups))

    def _type(self, kind: int) -> tuple[str, int]:
        """Return meshio's name of a type of cells, and how many nodes they have."""
        from meshlane._common import num_nodes_per_cell
        from meshlane.gmsh.common import _gmsh_to_meshio_type

        if kind not in _gmsh_to_meshio_type:
            raise InvalidFile(self.numbers.path, "$Elements", f"holds cells of the unknown type {kind}")
        name = _gmsh_to_meshio_type[kind]
        return name, int(num_nodes_per_cell[name])


def _by_tag(tags: Ints) -> dict[int, Ints]:
    return {int(tag): np.flatnonzero(np.abs(tags) == tag) for tag in np.unique(np.abs(tags)) if tag > 0}
