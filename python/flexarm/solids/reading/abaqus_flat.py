"""An Abaqus assembly, numbers by instance, as points and blocks that count from 0."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flexarm.arrays import Ints
from flexarm.errors import InvalidFile, Problem
from flexarm.solids.reading.abaqus_scope import Key, Names, Scope
from flexarm.solids.reading.content import Block, Content, Elastic


class Flat:
    """The assembly with indices instead of numbers, as `Content` holds it."""

    def __init__(self, scope: Scope, instances: list[str], notes: list[Problem]) -> None:
        self.scope, self.notes = scope, notes
        self.prefix = f"{instances[0]}." if len(instances) == 1 else ""
        self.index = {key: i for i, key in enumerate(scope.nodes)}
        self.place: dict[Key, tuple[int, int]] = {}

    def content(self, path: Path, materials: Names[Elastic]) -> Content:
        """Return the content; `path` names the file in errors."""
        blocks = self._blocks()
        found = Content(
            points=np.array(list(self.scope.nodes.values()), float).reshape(-1, 3),
            numbers=np.array([number for _, number in self.scope.nodes], int),
            blocks=blocks,
            notes=self.notes,
        )
        for name, keys in self.scope.cell_sets.items():
            found.groups[self._short(name, self.scope.cell_sets)] = self._members(keys)
        for name, keys in self.scope.node_sets.items():
            found.point_sets[self._short(name, self.scope.node_sets)] = self._points(name, keys)
        for name, keys in self.scope.surfaces.items():
            short = self._short(name, self.scope.surfaces)
            free = short if short not in found.point_sets else f"{short}-surface"
            found.point_sets[free] = self._points(name, keys)
        found.materials = self._materials(path, materials)
        return found

    def _blocks(self) -> list[Block]:
        rows: dict[tuple[str, int], list[tuple[Key, list[int]]]] = {}
        for key, (kind, nodes) in self.scope.cells.items():
            row = [self.index[node] for node in nodes]
            rows.setdefault((kind, len(row)), []).append((key, row))
        blocks: list[Block] = []
        for (kind, _), cells in rows.items():
            self.place.update({key: (len(blocks), i) for i, (key, _) in enumerate(cells)})
            numbers = np.array([number for (_, number), _ in cells])
            blocks.append(Block(kind, np.array([row for _, row in cells], int), numbers))
        return blocks

    def _short(self, name: str, names: Names[list[Key]]) -> str:
        """Drop the name of the only instance, unless the assembly has a set of the short name."""
        short = name.removeprefix(self.prefix)
        return name if short in names else short

    def _members(self, keys: list[Key]) -> dict[int, Ints]:
        members: dict[int, list[int]] = {}
        for block, i in (self.place[key] for key in keys if key in self.place):
            members.setdefault(block, []).append(i)
        return {block: np.array(cells) for block, cells in members.items()}

    def _points(self, name: str, keys: list[Key]) -> Ints:
        there = [self.index[key] for key in keys if key in self.index]
        if len(there) < len(keys):
            number = next(number for key in keys if key not in self.index for number in key[1:])
            what = f"names {len(keys) - len(there)} nodes that do not exist, such as {number}"
            self.notes.append(Problem(f"set {name!r}", what))
        return np.array(there, int)

    def _materials(self, path: Path, materials: Names[Elastic]) -> dict[str, Elastic]:
        sets, found = self.scope.cell_sets, {}
        groups = {name.upper(): self._short(name, sets) for name, _ in sets.items()}
        for section in self.scope.sections:
            material = materials.get(section.material)
            if material is None:
                what = f"*SOLID SECTION: there is no *MATERIAL {section.material!r}"
                raise InvalidFile(path, section.where, what)
            name = section.cells.removeprefix(self.prefix)
            meant = (section.cells, f"{self.prefix}{name}")
            group = next((groups[each.upper()] for each in meant if each in sets), None)
            if group is None:
                raise InvalidFile(path, section.where, f"*SOLID SECTION: there is no element set {name!r}")
            found[group] = material
        return found
