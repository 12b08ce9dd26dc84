"""Pictures of a gap: against angle, rate, torque and time, before and after."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from flexarm.errors import InvalidParameter

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from flexarm.diagnosis.gap_rows import GapRows
    from flexarm.diagnosis.locate import Located

Floats = NDArray[np.float64]

BEFORE, AFTER = "0.65", "C0"
RECORDS = 4
"""Most records that are drawn against time."""
Thing = TypeVar("Thing")


def gap_figure(
    before: Located,
    after: Located | None = None,
    signal: str | None = None,
    direction: str | None = None,
    joint: str | None = None,
) -> Figure:
    """The gap of a signal along one direction against the states of a joint and time.

    Parameters
    ----------
    before : Located
        With the nominal model.
    after : Located, optional
        With another one, of the same records, drawn over it.
    signal : str, optional
        Default: the one that holds most of the squared gap before, over the noise.
    direction : str, optional
        Default: the one with the greatest gap before.
    joint : str, optional
        Default: the one whose rotation holds most of the gap, else the first that moves.

    Raises
    ------
    InvalidParameter
        If there is no such signal, direction or joint.
    """
    import matplotlib.pyplot as plt

    rows = _named(before.gaps, signal or _largest(before), "signal")
    name = direction or max(rows.directions, key=lambda key: float(np.sum(rows.directions[key] ** 2)))
    _named(rows.directions, name, "direction")
    states = {each.joint: each for each in rows.states}
    chosen = _named(states, joint or _turned_most(before, states), "joint")
    drawn = [(rows, BEFORE if after else AFTER, "before" if after else "gap")]
    if after is not None:
        drawn.append((_named(after.gaps, rows.signal, "signal"), AFTER, "after"))
    kinds = ("angle", "rate", "torque") if chosen.moves else ("angle", "torque")
    shown = rows.labels[:RECORDS] if chosen.moves else ()
    figure = plt.figure(figsize=(9.5, 2.6 * (1 + len(shown))), layout="constrained")
    grid = figure.add_gridspec(1 + len(shown), 6)
    width = 6 // len(kinds)
    axes = [figure.add_subplot(grid[0, width * k : width * (k + 1)]) for k in range(len(kinds))]
    for ax, kind in zip(axes, kinds, strict=True):
        for gap, colour, label in drawn:
            of = next(each for each in gap.states if each.joint == chosen.joint)
            ax.plot(getattr(of, kind), gap.directions[name], ".", ms=2.5, color=colour, label=label)
        _dress(ax, rows, name, f"{kind} of {chosen.joint} [{chosen.units[kind]}]")
    for k, record in enumerate(shown):
        ax = figure.add_subplot(grid[1 + k, :])
        for gap, colour, label in drawn:
            inside = gap.record == gap.labels.index(record)
            ax.plot(gap.time[inside], gap.directions[name][inside], lw=0.8, color=colour, label=label)
        _dress(ax, rows, name, f"time of {record} [s]" if len(rows.labels) > 1 else "time [s]")
    for ax in (axes[0], *axes[len(kinds) :]):
        ax.set_ylabel(f"gap [{rows.unit}]", fontsize="small")
    axes[0].legend(loc="best", fontsize="x-small")
    figure.suptitle(f"{rows.signal}, {name}: measured - model", fontsize="medium")
    return figure


def _dress(ax: Axes, rows: GapRows, direction: str, label: str) -> None:
    """Noise as a band, zero, and units."""
    sigma = float(np.sqrt(np.mean(rows.noise[direction] ** 2)))
    ax.axhspan(-2 * sigma, 2 * sigma, color="C2", alpha=0.3, lw=0, label="noise, 2 sigma", zorder=0)
    if ax.get_xlim()[0] < 0 < ax.get_xlim()[1]:
        ax.axvline(0.0, color="0.85", lw=0.6, zorder=0)
    ax.set_xlabel(label, fontsize="small")
    ax.ticklabel_format(axis="y", style="sci", scilimits=(-2, 3))
    ax.tick_params(labelsize="small")


def _largest(located: Located) -> str:
    """The signal that holds most of the squared gap, over the noise."""
    if not located.gaps:
        raise InvalidParameter("holds no gap to draw", where="located")
    return max(located.gaps, key=lambda name: float(np.sum(located.gaps[name].whitened ** 2)))


def _turned_most(located: Located, states: Mapping[str, object]) -> str:
    """The joint whose equivalent rotation holds most of the gap."""
    ranked = [each.joint for each in located.rotations.joints] if located.rotations else []
    return next((joint for joint in ranked if joint in states), next(iter(states)))


def _named(found: Mapping[str, Thing], name: str, kind: str) -> Thing:
    if name not in found:
        raise InvalidParameter(f"there is no {kind} {name!r}; there are {', '.join(found)}")
    return found[name]
