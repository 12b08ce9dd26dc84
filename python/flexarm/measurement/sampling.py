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
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter

EARLY = 0.05
"""Time before its first step in which a motion keeps its first rate [s]: clocks are late by less."""


MANY = 100_000
"""Instants from which SciPy's evaluation saves more than its import takes."""


class CannotMeasure(InvalidParameter):
    """The simulation does not hold what a sensor measures; says what is missing."""


class Described(Protocol):
    """Attributes that sensors of a model and signals of a record have in common: quantity and place."""

    @property
    def name(self) -> str:
        """Name of the signal."""

    @property
    def quantity(self) -> str:
        """A key of `flexarm.quantities.QUANTITIES`."""

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
    def axes(self) -> Sequence[str] | None:
        """Directions of the channels."""

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
    if np.array_equal(instants, time):
        return values.copy()
    if len(time) < 2:
        return np.where(_column(instants <= time[-1], values), values[0], np.nan)
    inside = np.clip(instants, time[0], time[-1])
    dense = len(instants) > max(len(time), MANY)
    last = len(time) - 2
    k = np.arange(last + 1) if dense else np.clip(np.searchsorted(time, inside, side="right") - 1, 0, last)
    v_0, v_1 = (_slope(time, values, at) if rates is None else rates[at] for at in (k, k + 1))
    h, jump = _column(time[k + 1] - time[k], values), values[k + 1] - values[k]
    d, c = (v_0 + v_1 - 2 * jump / h) / h**2, (3 * jump / h - 2 * v_0 - v_1) / h  # eq. (1), by powers of t
    if dense:
        from scipy.interpolate import PPoly

        found = PPoly.construct_fast(np.stack([d, c, v_0, values[k]]), time)(inside)
    else:
        t = _column(inside - time[k], values)
        found = ((d * t + c) * t + v_0) * t + values[k]
    found[inside == time[-1]] = values[-1]  # to the last digit, as at the other instants of the run
    if rates is not None:
        found = found + _column(np.clip(instants - time[0], -EARLY, 0.0), values) * rates[0]
    late = instants > time[-1] + 1e-9 * max(1.0, abs(float(time[-1])))
    return np.where(_column(late, values), np.nan, found)


def _slope(time: Floats, values: Floats, i: NDArray[np.intp]) -> Floats:
    """Return differences at steps i alone, central and exact of a parabola; one-sided at both ends."""
    if len(time) < 3:
        return np.asarray(np.gradient(values, time, axis=0)[i])
    j = np.clip(i, 1, len(time) - 2)  # the middle one of three
    h_0, h_1 = _column(time[j] - time[j - 1], values), _column(time[j + 1] - time[j], values)
    v_0, v_1 = (values[j] - values[j - 1]) / h_0, (values[j + 1] - values[j]) / h_1
    at = _column(i - j, values)
    inside = (h_1 * v_0 + h_0 * v_1) / (h_0 + h_1)
    found: Floats = np.where(at == 0, inside, np.where(at < 0, v_0, v_1))
    return found


def _column(values: NDArray[Any], like: Floats) -> NDArray[Any]:
    """Return `values` with as many trailing axes as `like` has beyond its first."""
    return values.reshape(-1, *[1] * (like.ndim - 1))


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
