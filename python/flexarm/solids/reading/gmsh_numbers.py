"""Numbers of the cells in a Gmsh file, in the order in which they stand there.

Layout of the sections: Gmsh reference manual, "MSH file format" (4.1) and "MSH file format version 2".
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import IO

import numpy as np

from flexarm.arrays import Ints
from flexarm.errors import InvalidFile


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
