"""A closed loop beside EXUDYN: a slider-crank with a flexible rod, driven by a torque on its crank.

    python benchmarks/slider_crank.py [--exudyn-python PYTHON] [--rounds 5]

A rigid crank A-B, a rod of steel B-E and a slider of 4 kg on the x axis, no gravity, at rest at the start.
Torque, errors and settings are those of `four_bar.py`; the result is the place of the middle of the rod.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from four_bar import START, Exudyn, bar, beam, compare, hinge, simulated

CRANK, ROD, SIDE = 0.3, 0.9, 0.012
"""Lengths, and the side of the rod [m]."""
SLIDER = 4.0
"""Mass of the slider [kg]."""


def places() -> tuple[np.ndarray, np.ndarray]:
    """Places of B and of the slider at the start [m]."""
    b = CRANK * np.array([math.cos(START), math.sin(START)])
    return b, np.array([b[0] + math.sqrt(ROD**2 - b[1] ** 2), 0.0])


def with_flexarm(elements: int, steps: int, consistent_forces: bool = False) -> dict[str, Any]:
    """CPU seconds and places of the rod's middle, of a run in flexarm."""
    b, e = places()
    slide = {"name": "S", "type": "prismatic", "parent": "base", "child": "slider", "axis": [1, 0, 0]}
    slider = {"name": "slider", "type": "rigid", "mass": SLIDER, "com": [0, 0, 0], "inertia": [1e-3] * 3}
    eye = {"name": "E", "type": "revolute", "axis": [0, -1, 0], "a": "rod", "a_at": "end", "b": "slider"}
    model = {
        "name": "slider-crank",
        "gravity": [0, 0, 0],
        "links": [bar("crank", CRANK), beam("rod", ROD, SIDE, 2 * elements), slider],
        "joints": [hinge("A", "base", "crank", 0.0), hinge("B", "crank", "rod", CRANK), slide],
        "closures": [eye],
        "points": [{"name": "middle", "link": "rod", "position": [ROD / 2, 0, 0]}],
        "assembly": {"A": START, "B": -math.asin(b[1] / ROD) - START, "S": float(e[0])},
    }
    return simulated(model, "middle", steps, consistent_forces)


def with_exudyn(elements: int, steps: int) -> dict[str, Any]:
    """The same in EXUDYN."""
    mechanism = Exudyn(CRANK)
    mbs, item = mechanism.mbs, mechanism.item
    b, e = places()
    rod = mechanism.beam(b, e, SIDE, 2 * elements)
    node = mbs.AddNode(item.NodePoint2D(referenceCoordinates=[*e]))
    mbs.AddObject(item.ObjectMassPoint2D(nodeNumber=node, mass=SLIDER))
    still = mbs.AddNode(item.NodePointGround())
    across, fixed = (
        mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=number, coordinate=k))
        for number, k in ((node, 1), (still, 0))
    )
    mbs.AddObject(item.ObjectConnectorCoordinate(markerNumbers=[fixed, across]))
    mechanism.pinned(mechanism.ends[1], mechanism.at(rod[0]))
    mechanism.pinned(mechanism.at(rod[-1]), mechanism.at(node))
    return mechanism.solved(rod[len(rod) // 2], elements, steps)


if __name__ == "__main__":
    compare("slider_crank.py", __doc__, with_flexarm, with_exudyn)
