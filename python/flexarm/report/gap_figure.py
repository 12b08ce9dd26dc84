"""Pictures of a gap: against angle, rate, torque and time, before and after."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from flexarm.errors import InvalidParameter
from flexarm.report.gap_curves import AFTER, BEFORE, NOISE, zero_of
from flexarm.report.state_figures import largest_direction, of_joint, turned_most
from flexarm.wording import scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from flexarm.residual_analysis.localisation import Localisation
    from flexarm.residual_analysis.motion_states import JointStates
    from flexarm.residual_analysis.residual_parts import SignalResidual


def gap_figure(before: Localisation, after: Localisation | None = None, signal: str | None = None) -> Figure:
    """Return the gap of a signal along one direction against the states of a joint and time.

    That of another model, of the same records, is drawn over it. The default signal holds most of the squared
    gap before, over the noise; the direction has the greatest gap; the joint's rotation holds most of the
    gap, or it is the first that moves. Raise InvalidParameter if there is no such signal.
    """
    rows = _named(before, signal or _largest(before))
    drawn = [(rows, BEFORE if after else AFTER, "before" if after else "gap")]
    if after is not None:
        drawn.append((_named(after, rows.signal), AFTER, "after"))
    return _Sheet(rows, largest_direction(rows), turned_most(before, rows), drawn).figure()


@dataclass(frozen=True, eq=False)
class _Sheet:
    """The gap that sets scale and noise, and every gap with its colour and label."""

    rows: SignalResidual
    direction: str
    states: JointStates
    drawn: Sequence[tuple[SignalResidual, str, str]]

    def figure(self) -> Figure:
        """One row against the states, one for each record against time."""
        import matplotlib.pyplot as plt

        kinds = ("angle", "rate", "torque") if self.states.moves else ("angle", "torque")
        records = self.rows.labels[:4] if self.states.moves else ()
        figure = plt.figure(figsize=(9.5, 2.6 * (1 + len(records))), layout="constrained")
        grid = figure.add_gridspec(1 + len(records), 6)
        width = 6 // len(kinds)
        first = [figure.add_subplot(grid[0, width * k : width * (k + 1)]) for k in range(len(kinds))]
        for ax, kind in zip(first, kinds, strict=True):
            self._against_state(ax, kind)
        below = [figure.add_subplot(grid[1 + k, :]) for k in range(len(records))]
        for ax, record in zip(below, records, strict=True):
            self._against_time(ax, record)
        for ax in (first[0], *below):
            ax.set_ylabel(f"gap [{self._scale[1]}]", fontsize="small")
        first[0].legend(loc="best", fontsize="x-small")
        figure.suptitle(f"{self.rows.signal}, {self.direction}: measured - model", fontsize="medium")
        return figure

    def _against_state(self, ax: Axes, kind: str) -> None:
        for gap, colour, label in self.drawn:
            states = of_joint(gap.states, self.states.joint)
            values = self._scale[0] * gap.directions[self.direction]
            ax.plot(getattr(states, kind), values, ".", ms=2.5, color=colour, label=label)
        self._dress(ax, f"{kind} of {self.states.joint} [{self.states.units[kind]}]")

    def _against_time(self, ax: Axes, record: str) -> None:
        for gap, colour, label in self.drawn:
            inside = gap.record == gap.labels.index(record)
            values = self._scale[0] * gap.directions[self.direction][inside]
            time = gap.time[inside]
            zero = zero_of(time)
            ax.plot(time - zero, values, lw=0.8, color=colour, label=label)
        after = f" after {zero:.0f} s" if zero else ""
        self._dress(ax, f"time of {record}{after} [s]" if len(self.rows.labels) > 1 else f"time{after} [s]")

    @cached_property
    def _scale(self) -> tuple[float, str]:
        """Factor and unit of the gap."""
        return scale([float(np.abs(self.rows.directions[self.direction]).max())], self.rows.unit)

    def _dress(self, ax: Axes, label: str) -> None:
        """Noise as a band, zero, and units."""
        sigma = self._scale[0] * float(np.sqrt(np.mean(self.rows.noise[self.direction] ** 2)))
        ax.axhspan(-2 * sigma, 2 * sigma, color=NOISE, lw=0, label="noise, 2σ", zorder=0)
        if ax.get_xlim()[0] < 0 < ax.get_xlim()[1]:
            ax.axvline(0.0, color="0.85", lw=0.6, zorder=0)
        ax.set_xlabel(label, fontsize="small")
        ax.tick_params(labelsize="small")


def _largest(located: Localisation) -> str:
    """Return the signal that holds most of the squared gap, over the noise."""
    if not located.gaps:
        raise InvalidParameter("holds no gap to draw", where="located")
    return max(located.gaps, key=lambda name: float(np.sum(located.gaps[name].whitened ** 2)))


def _named(located: Localisation, signal: str) -> SignalResidual:
    if signal not in located.gaps:
        raise InvalidParameter(f"there is no signal {signal!r}; there are {', '.join(located.gaps)}")
    return located.gaps[signal]
