"""Abaqus and CalculiX input files (.inp).

Read are *NODE, *ELEMENT, *NSET, *ELSET, *SURFACE, *SOLID SECTION, *MATERIAL with *ELASTIC and *DENSITY,
*PART, *INSTANCE, *ASSEMBLY and *INCLUDE. Element sets of solids are groups; node sets, surfaces and element
sets of shells are sets of points. In an assembly of several instances the names of a part's sets begin with
that of the instance, `lever-1.bore`; of one instance, where the assembly has a set of the same name.

Solids are named after their number of nodes: C3D4, C3D10, C3D8, C3D20, with letters for the formulation
behind (C3D8R, C3D8I, C3D10M, ..), which flexarm replaces by its own. Their nodes are in the order of VTK.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import deepcopy
from dataclasses import replace
from pathlib import Path

from flexarm.decks.keywords import Keyword, keywords
from flexarm.errors import Problem
from flexarm.solids.cell_types import BY_MESHIO_NAME
from flexarm.solids.reading.abaqus_flat import Flat
from flexarm.solids.reading.abaqus_scope import Key, Names, Scope, Section, placement
from flexarm.solids.reading.content import Content, Elastic

#: What makes nodes or cells out of others, or moves them: leaving it out would change the part.
_REFUSED = ("SYSTEM", "NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY")
#: What joins parts beside their mesh; leaving it out is allowed and said.
_SAID = (
    "TIE",
    "EQUATION",
    "MPC",
    "CONTACT PAIR",
    "COUPLING",
    "KINEMATIC COUPLING",
    "RIGID BODY",
    "EMBEDDED ELEMENT",
)


def content(path: Path) -> Content:
    """Read the content of an Abaqus or CalculiX file."""
    reader = _Reader()
    for keyword in keywords(path):
        reader.take(keyword)
    return reader.finished(path)


class _Reader:
    def __init__(self) -> None:
        self.scope = self.assembly = Scope()
        self.parts: dict[str, Scope] = {}
        self.instances: list[str] = []
        self.instance: Keyword | None = None
        self.materials: Names[Elastic] = Names()
        self.material: Elastic | None = None
        self.notes: list[Problem] = []
        self.left: dict[str, int] = {}
        self.said: dict[str, list[int]] = {}
        self.steps: Mapping[str, Callable[[Keyword], None]] = {
            "NODE": self._nodes,
            "ELEMENT": self._cells,
            "NSET": self._node_set,
            "ELSET": self._cell_set,
            "SURFACE": self._surface,
            "SOLID SECTION": self._section,
            "MATERIAL": self._material,
            "ELASTIC": self._elastic,
            "DENSITY": self._density,
            "PART": self._part,
            "END PART": self._end_part,
            "INSTANCE": self._instance,
            "END INSTANCE": self._end_instance,
        }

    def take(self, keyword: Keyword) -> None:
        """Read one keyword."""
        if keyword.name in _REFUSED:
            raise keyword.error(
                "is not read; write the file from a preprocessor, with all nodes and cells in it"
            )
        if keyword.name in _SAID:
            self.said.setdefault(keyword.name, []).append(keyword.line)
        step = self.steps.get(keyword.name)
        if step:
            step(keyword)

    def _nodes(self, keyword: Keyword) -> None:
        if keyword.parameters.get("SYSTEM", "R").upper() != "R":
            raise keyword.error(
                f"SYSTEM={keyword.parameters['SYSTEM']} is not read; give rectangular coordinates"
            )
        nodes = {("", number): xyz for number, xyz in keyword.nodes()}
        self.scope.nodes.update(nodes)
        _extend(self.scope.node_sets, keyword.parameters.get("NSET", ""), nodes)

    def _cells(self, keyword: Keyword) -> None:
        name = keyword.needed("TYPE").upper()
        kind, keys = kind_of(name), []
        if not kind:
            self.left[name] = self.left.get(name, 0) + len(keyword.rows)
            _extend(self.scope.cell_sets, keyword.parameters.get("ELSET", ""), [])
            return
        for number, *nodes in rows_of(keyword, name):
            own = [("", node) for node in nodes]
            missing = [node for _, node in own if ("", node) not in self.scope.nodes]
            if missing:
                raise keyword.error(f"cell {number} names node {missing[0]}, which is not defined before")
            self.scope.cells["", number] = (kind, own)
            keys.append(("", number))
        _extend(self.scope.cell_sets, keyword.parameters.get("ELSET", ""), keys)

    def _node_set(self, keyword: Keyword) -> None:
        found = self._members(keyword, self.scope.node_sets, self.scope.nodes)
        cells = keyword.parameters.get("ELSET")
        if cells:
            found += [node for key in self._cell_keys(cells, keyword) for node in self.scope.cells[key][1]]
        _extend(self.scope.node_sets, keyword.needed("NSET"), found)

    def _members(self, keyword: Keyword, known: Names[list[Key]], there: Mapping[Key, object]) -> list[Key]:
        return self.scope.members(keyword, known, there, keyword.parameters.get("INSTANCE", ""))

    def _cell_set(self, keyword: Keyword) -> None:
        found = self._members(keyword, self.scope.cell_sets, self.scope.cells)
        _extend(self.scope.cell_sets, keyword.needed("ELSET"), found)

    def _cell_keys(self, name: str, keyword: Keyword) -> list[Key]:
        found = self.scope.cell_sets.get(name)
        if found is None:
            raise keyword.error(f"there is no element set {name!r} before this line")
        return [key for key in found if key in self.scope.cells]

    def _surface(self, keyword: Keyword) -> None:
        name, nodes = keyword.needed("NAME"), []
        by_node = keyword.parameters.get("TYPE", "ELEMENT").upper() == "NODE"
        for line, (what, *face) in keyword.rows:
            row = replace(keyword, rows=[(line, [what])])
            if by_node:
                nodes += self._members(row, self.scope.node_sets, self.scope.nodes)
                continue
            label = face[0].upper() if face else ""
            for key in self._members(row, self.scope.cell_sets, self.scope.cells):
                if key in self.scope.cells:
                    nodes += self._face(keyword, line, key, label)
        _extend(self.scope.surfaces, name, nodes)

    def _face(self, keyword: Keyword, line: int, key: Key, label: str) -> list[Key]:
        kind, nodes = self.scope.cells[key]
        if kind in ("polygon", "line"):
            return nodes
        if kind not in BY_MESHIO_NAME:
            return []  # refused later, with all of its type
        faces = BY_MESHIO_NAME[kind].faces
        if not (label[:1] == "S" and label[1:].isdigit() and 1 <= int(label[1:]) <= len(faces)):
            raise keyword.error(f"face must be one of S1 to S{len(faces)} of a solid, got {label!r}", line)
        return [nodes[i] for i in BY_MESHIO_NAME[kind].face_nodes(int(label[1:]) - 1)]

    def _section(self, keyword: Keyword) -> None:
        section = Section(keyword.needed("ELSET"), keyword.needed("MATERIAL"), f"line {keyword.line}")
        self.scope.sections.append(section)

    def _material(self, keyword: Keyword) -> None:
        name = keyword.needed("NAME")
        self.material = Elastic(f"line {keyword.line}, *MATERIAL {name}")
        self.materials.set(name, self.material)

    def _elastic(self, keyword: Keyword) -> None:
        kind = keyword.parameters.get("TYPE", "ISOTROPIC").upper()
        if self.material is None or not keyword.rows:
            return
        if not kind.startswith("ISO"):
            what = f"*ELASTIC, TYPE={kind} is not read, isotropic is"
            self.notes.append(Problem(f"line {keyword.line}", what))
            return
        values = keyword.floats(*keyword.rows[0])
        self.material.youngs_modulus, self.material.poisson_ratio = [*values, 0.0][:2]

    def _density(self, keyword: Keyword) -> None:
        if self.material is not None and keyword.rows:
            self.material.density = keyword.floats(*keyword.rows[0])[0]

    def _part(self, keyword: Keyword) -> None:
        self.scope = self.parts[keyword.needed("NAME").upper()] = Scope()

    def _end_part(self, _: Keyword) -> None:
        self.scope = self.assembly

    def _instance(self, keyword: Keyword) -> None:
        """Begin an instance, which may add nodes and cells of its own to those of its part."""
        part = keyword.parameters.get("PART", "").upper()
        if part and part not in self.parts:
            raise keyword.error(f"there is no *PART {part!r} before")
        self.instance, self.scope = keyword, deepcopy(self.parts[part]) if part else Scope()

    def _end_instance(self, keyword: Keyword) -> None:
        if self.instance is None:
            raise keyword.error("there is no *INSTANCE before")
        name = self.instance.needed("NAME")
        rows = placement(self.instance)
        self.scope.copied(name, rows, self.assembly)
        self.instances.append(name)
        self.instance, self.scope = None, self.assembly

    def finished(self, path: Path) -> Content:
        """Return all that was read."""
        if not self.instances:
            for name, part in self.parts.items():  # parts that no assembly places stand where they are
                part.copied(name, [], self.assembly)
                self.instances.append(name)
        for name, count in self.left.items():
            self.notes.append(Problem("cells", f"{count} of type {name} are not read"))
        for name, lines in self.said.items():
            often = f" and {len(lines) - 1} more" if len(lines) > 1 else ""
            what = f"*{name} is not read and joins nothing here"
            self.notes.append(Problem(f"line {lines[0]}{often}", what))
        return Flat(self.assembly, self.instances, self.notes).content(path, self.materials)


def _extend(sets: Names[list[Key]], name: str, keys: Iterable[Key]) -> None:
    """Extend a set: one that is given again grows, as in both programs."""
    if name:
        sets.set(name, [*(sets.get(name) or []), *keys])


_SOLID = re.compile(r"D?C3D(\d+)")
_KINDS = {
    4: "tetra",
    5: "pyramid",
    6: "wedge",
    8: "hexahedron",
    10: "tetra10",
    13: "pyramid13",
    15: "wedge15",
    20: "hexahedron20",
}
#: Beginnings of the names of shells, membranes, surfaces and plane cells, and of trusses and beams.
_FACES = re.compile(r"D?(S|STRI|M3D|CPS|CPE|CAX|SFM3D|R3D|F3D)\d")
_LINES = re.compile(r"(T[23]D|B[23]|D1D|R2D2|PIPE)\d?")


def kind_of(name: str) -> str:
    """Return meshio's name of a type; empty for springs, masses, connectors and the like."""
    solid = _SOLID.match(name)
    if solid:
        return _KINDS.get(int(solid.group(1)), name)
    if _FACES.match(name):
        return "polygon"
    if _LINES.match(name):
        return "line"
    return "" if not name.startswith(("SC", "CSS", "AC3D", "COH3D", "GK3D", "EC3D")) else name


def rows_of(keyword: Keyword, name: str) -> Iterator[list[int]]:
    """Yield number and nodes of each cell.

    A solid has as many nodes as its name says, on as many lines as it takes; what else stands in the last of
    them is left out, as both programs do. Other cells go on in the next line where one ends in a comma.
    """
    solid = _SOLID.match(name)
    length = int(solid.group(1)) + 1 if solid else 0
    row: list[int] = []
    for line, values in keyword.rows:
        row += keyword.numbers(line, values)
        if solid and len(row) >= length:
            yield row[:length]
            row = []
        elif not solid and values[-1]:
            yield row
            row = []
    if row and solid:
        raise keyword.error(
            f"cell {row[0]} has {len(row) - 1} nodes, {name} has {length - 1}", keyword.rows[-1][0]
        )
    if row:
        yield row
