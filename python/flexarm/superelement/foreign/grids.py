"""Positions of the points of a matrix, and the axes of their freedoms.

The points stand in Nastran bulk data (`flexarm.decks.coordinate_systems`) or in *NODE of Abaqus and CalculiX,
whose freedoms point along the global axes.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexarm.arrays import Floats
from flexarm.decks.cards import cards
from flexarm.decks.coordinate_systems import Grids
from flexarm.decks.keywords import keywords
from flexarm.errors import InvalidFile
from flexarm.reading import any_text


@dataclass(frozen=True, eq=False)
class Grid:
    """A point: its position in the part's frame, in the file's unit, and its freedoms' axes as columns."""

    position: Floats
    axes: Floats


def read_grids(path: str | Path) -> dict[int, Grid]:
    """Read the points of a bulk data file or an input deck.

    Raise InvalidFile if the file cannot be read, holds no points, or refers to systems that it does not
    define.
    """
    path = Path(path)
    found = _nodes(path) if "*NODE" in any_text(path).upper() else _bulk(path)
    if not found:
        raise InvalidFile(path, "grids", "holds no GRID entry and no *NODE")
    return found


def _bulk(path: Path) -> dict[int, Grid]:
    grids = Grids()
    for card in cards(path):
        grids.take(card)
    return {number: Grid(grids.position(number), grids.axes(number)) for number in grids.cards}


def _nodes(path: Path) -> dict[int, Grid]:
    found: dict[int, Grid] = {}
    for keyword in keywords(path):
        if keyword.name == "TRANSFORM":
            raise keyword.error("turned freedoms are not read; state none")
        if keyword.name == "NODE":
            found |= {number: Grid(np.array(xyz), np.eye(3)) for number, xyz in keyword.nodes()}
    return found
