"""Gmsh meshes (.msh, versions 2.2 and 4.1, text or binary).

meshlane reads points, cells and physical groups. Two things it leaves out are read here: numbers of cells, so
that messages name those of the file (sections as in the reference manual, "MSH file format"), and names that
physical groups of two dimensions share. Version 2.2 writes a cell once for each physical group it is in;
these are made one again. A physical volume is a group of cells; physical surfaces, curves and points are sets
of their points. One without a name is called `volume-1`, `surface-7`, `curve-3`, `point-2`.
"""

from __future__ import annotations

import shlex
from collections import Counter
from functools import partial
from pathlib import Path
from typing import IO, Any

import numpy as np

from flexarm.arrays import Ints
from flexarm.errors import InvalidFile
from flexarm.solids.reading.content import Content
from flexarm.solids.reading.through_meshlane import blocks_of, read_by

#: What a failure of the reader means, by a part of its message.
_REMEDIES = {
    "gmsh:physical": "some cells are in no physical group: save without 'Save all elements'",
    "parametric": "save without 'Save parametric coordinates'",
    "ReadError": "such a file begins with $MeshFormat, version 2.2 or 4.1, and holds $Nodes and $Elements",
}
_DIMENSION = ("point", "curve", "surface", "volume")


def content(path: Path) -> Content:
    """Read the content of a Gmsh file."""
    return read_by(_content, path, "Gmsh mesh", _REMEDIES)


def _content(path: Path) -> Content:
    import meshlane

    check_counts(path)
    _refuse_shared_names(path)
    mesh = meshlane.gmsh.read(str(path))
    blocks = blocks_of(mesh)
    numbers = cell_numbers(path)
    if numbers is not None and len(numbers) == sum(len(block.nodes) for block in blocks):
        for block in blocks:
            block.numbers, numbers = numbers[: len(block.nodes)], numbers[len(block.nodes) :]
    found = Content(np.asarray(mesh.points, float), np.arange(1, len(mesh.points) + 1), blocks, repeats=True)
    found.groups = _groups(mesh)
    return found


def _groups(mesh: Any) -> dict[str, dict[int, Ints]]:
    """Return the physical groups: by name where there is one, by number otherwise."""
    groups: dict[str, dict[int, Ints]] = {}
    for name, members in mesh.cell_sets.items():
        if not name.startswith("gmsh:"):
            groups[name] = {i: np.asarray(cells) for i, cells in enumerate(members) if cells is not None}
    named = {(int(d), int(n)): name for name, (n, d) in mesh.field_data.items()}
    for i, tags in enumerate(mesh.cell_data.get("gmsh:physical", [])):
        dimension = int(mesh.cells[i].dim)
        for tag in np.unique(tags):
            name = named.get((dimension, int(tag)), f"{_DIMENSION[dimension]}-{tag}")
            if tag > 0 and name not in mesh.cell_sets:
                groups.setdefault(name, {})[i] = np.flatnonzero(np.asarray(tags) == tag)
    return groups


def _refuse_shared_names(path: Path) -> None:
    """Refuse a volume and a surface of one name, of which meshlane would keep one."""
    with path.open("rb") as file:
        for line in file:
            if line.strip() == b"$PhysicalNames":
                break
        else:
            return
        rows = [shlex.split(next(file).decode(errors="replace")) for _ in range(int(next(file)))]
    twice = [name for name, count in Counter(row[2] for row in rows).items() if count > 1]
    if twice:
        kinds = ", ".join(f"{_DIMENSION[int(row[0])]} {row[1]}" for row in rows if row[2] == twice[0])
        what = f"{twice[0]!r} is the name of {kinds}; every physical group needs its own"
        raise InvalidFile(path, "$PhysicalNames", what)


def cell_numbers(path: Path) -> Ints | None:
    """Return the number of each cell, or None where the file's version has another layout."""
    with path.open("rb") as file:
        if not _forward_to(file, b"$MeshFormat"):
            return None
        version, binary, _ = file.readline().decode().split()
        if not _forward_to(file, b"$Elements"):
            return None
        if version.startswith("2"):
            return _version_2_binary(file) if binary == "1" else _version_2_text(file)
        return _version_4(file, "" if binary == "1" else " ") if version in ("4", "4.1") else None


def check_counts(path: Path) -> None:
    """Raise InvalidFile if a file says that it holds more nodes or cells than bytes."""
    size = path.stat().st_size
    with path.open("rb") as file:
        if not _forward_to(file, b"$MeshFormat"):
            return
        version, binary, _ = file.readline().decode().split()
        for section in ("$Nodes", "$Elements"):
            file.seek(0)
            if not _forward_to(file, section.encode()):
                return
            if version.startswith("2"):
                counts = [int(file.readline())]
            else:
                counts = np.fromfile(file, np.uint64, 4, "" if binary == "1" else " ")[:2].tolist()
            if not all(0 <= count <= size for count in counts):
                raise InvalidFile(path, section, f"declares {max(counts)} entries in a file of {size} bytes")


def _forward_to(file: IO[bytes], section: bytes) -> bool:
    return any(line.strip() == section for line in file)


def _version_2_text(file: IO[bytes]) -> Ints:
    return np.array([int(file.readline().split(maxsplit=1)[0]) for _ in range(int(file.readline()))])


def _version_2_binary(file: IO[bytes]) -> Ints:
    """Read batches of (type, count, number of tags), then for each cell its number, tags, nodes."""
    left, numbers = int(file.readline()), [np.empty(0, np.int64)]
    while left > 0:
        kind, count, n_tags = np.fromfile(file, np.intc, 3)
        width = 1 + int(n_tags) + _n_nodes(int(kind))
        rows = np.fromfile(file, np.intc, int(count) * width).reshape(-1, width)
        numbers.append(rows[:, 0].astype(np.int64))
        left -= int(count)
    return np.concatenate(numbers)


def _version_4(file: IO[bytes], separator: str) -> Ints:
    """Read blocks of (dimension, entity, type), count, then for each cell its number and nodes."""
    read = partial(np.fromfile, file, sep=separator)
    numbers = [np.empty(0, np.int64)]
    for _ in range(int(read(np.uint64, 4)[0])):
        kind = int(read(np.intc, 3)[2])
        count = int(read(np.uint64, 1)[0])
        width = 1 + _n_nodes(kind)
        numbers.append(read(np.uint64, count * width).reshape(-1, width)[:, 0].astype(np.int64))
    return np.concatenate(numbers)


def _n_nodes(kind: int) -> int:
    from meshlane._common import num_nodes_per_cell
    from meshlane.gmsh.common import _gmsh_to_meshio_type

    return int(num_nodes_per_cell[_gmsh_to_meshio_type[kind]])
