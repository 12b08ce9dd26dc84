"""Interpolation of a simulated motion at the instants of a sensor, between the steps of the simulation.

In a step h from t_0 to t_1, with s = (t - t_0)/h, values x and rates v,

    x(t) = (1 + 2 s)(1 - s)^2 x_0 + s (1 - s)^2 h v_0 + s^2 (3 - 2 s) x_1 - s^2 (1 - s) h v_1        (1)

is exact for cubic motion; its error h^4 x''''/384 is below 1e-9 m for a mode of 3 Hz and 1 cm at 2 ms.
Quantities whose rates the simulation does not hold take central differences for v.

Before the first step the arm rests where it starts, or goes on as it moves there; after the last nothing is
known (NaN).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from flexarm import _core
from flexarm.arm.sensor_effect import Measured
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter

EARLY = 0.05
"""Time before its first step in which a motion keeps its first rate [s]: clocks are late by less."""


class CannotMeasure(InvalidParameter):
    """The simulation does not hold what a sensor measures; says what is missing."""


class Described(Measured, Protocol):
    """Attributes that sensors of a model and signals of a record have in common: quantity and place."""

    @property
    def joint(self) -> str | None:
        """Joint where it is measured."""

    @property
    def point(self) -> str | None:
        """Point where it is measured."""

    @property
    def link(self) -> str | None:
        """Link where it is measured."""

    @property
    def side(self) -> str | None:
        """Before the reducer (motor) or after it (output)."""

    @property
    def position(self) -> float | None:
        """Place along the link [m]."""

    @property
    def fibre(self) -> Sequence[float] | None:
        """Fibre [y, z] in the section [m]."""


def sample(time: Floats, values: Floats, instants: Floats, rates: Floats | None = None) -> Floats:
    """Return the values, (n, ...), at instants [s], (m,), by (1), with rates at the steps if these are given.

    After the last step they are NaN; before the first one its value, for up to `EARLY` with its rate.
    """
    if instants is time:
        return values.copy()
    columns = values.reshape(len(values), -1)
    slopes = columns[:0] if rates is None else rates.reshape(columns.shape)
    found: Floats = _core.sample_motion(time, columns, slopes, instants, EARLY)
    return found.reshape(len(instants), *values.shape[1:])


def stored(simulation: Any, name: str, what: Described) -> Floats:
    """Return an array of the simulation.

    Raise CannotMeasure if the simulation does not hold it.
    """
    found = getattr(simulation, name, None)
    if found is None:
        raise CannotMeasure(
            f"signal {what.name!r} ({what.quantity}) needs {name.replace('_', ' ')}, "
            "which this simulation does not hold"
        )
    return np.asarray(found, dtype=float)


def point_index(simulation: Any, what: Described, point: str | None = None) -> int:
    """Return the index of the signal's point, or of another one that it needs, in the simulation's arrays."""
    return _index(simulation.points, point or what.point, "point", what)


def joint_index(simulation: Any, what: Described) -> int:
    """Return the index of the signal's joint in the simulation's arrays."""
    return _index(simulation.joints, what.joint, "joint", what)


def _index(names: Sequence[str], name: str | None, kind: str, what: Described) -> int:
    if name is None or name not in names:
        raise CannotMeasure(
            f"signal {what.name!r} ({what.quantity}) is at the {kind} {name!r}, which this "
            f"simulation does not hold; it holds {', '.join(names) or 'none'}"
        )
    return list(names).index(name)


def columns(axes: Sequence[str] | None) -> list[int]:
    """Return the indices of axes named x, y, z; all three where none are named."""
    return ["xyz".index(axis) for axis in axes or "xyz"]
