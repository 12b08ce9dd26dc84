"""The content of a mesh file, in its own units and not yet a part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from flexarm.arrays import Floats, Ints
from flexarm.errors import Problem


@dataclass
class Block:
    """Cells of one type, as they follow one another in the file."""

    kind: str
    """meshio's name of the type (`tetra10`, `triangle`, ..)."""
    nodes: Ints
    """Ints of points, in meshio's order, shape (n, n_nodes)."""
    numbers: Ints
    """The cells' numbers in the file, shape (n,)."""


@dataclass
class Elastic:
    """A material as the file gives it, in the file's units; None where the file leaves a value out.

    `where` is its name in the file, or its line.
    """

    where: str
    youngs_modulus: float | None = None
    poisson_ratio: float | None = None
    density: float | None = None


@dataclass
class Content:
    """All of a file that concerns a part."""

    points: Floats
    """In the file's unit of length, shape (n, 3)."""
    numbers: Ints
    """The points' numbers in the file, shape (n,)."""
    blocks: list[Block]
    """Cells of every dimension."""
    groups: dict[str, dict[int, Ints]] = field(default_factory=dict)
    """Name -> {index of a block: indices of its cells}, in any order, repeated or not."""
    point_sets: dict[str, Ints] = field(default_factory=dict)
    """Name -> indices of points, in any order, repeated or not."""
    materials: Mapping[str, Elastic] = field(default_factory=dict)
    """Name of a group -> its material."""
    notes: list[Problem] = field(default_factory=list)
    """What was not read."""
    repeats: bool = False
    """The format writes a cell once for each of its groups."""
