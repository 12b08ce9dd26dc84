"""One channel of one record beside the nominal model: readings, prediction, and what a model misses of it.

A part of the motion is missed by any nominal model: `floor`. What is no fault is in `validation.regression`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.sizes import reach
from flexarm.arrays import Floats
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.quantities import channel_names
from flexarm.validation.regression import Fit, columns_of, fit_at, slope_of, values_at

if TYPE_CHECKING:
    from flexarm.record import Signal


MISSED = {"motor_torque": 0.1, "motor_voltage": 0.1, "strain": 0.1, "acceleration": 0.1, "angular_rate": 0.1}
"""Share of the motion that a nominal model misses, by quantity; else `MISSED_ELSE`."""
MISSED_ELSE = 0.03
AMISS = {"position": 1e-3, "deflection": 1e-3, "joint_angle": 1e-3, "inclination": 1e-3, "orientation": 1e-3}
"""What it misses whatever the motion: a share of the reach of the arm, or an angle [rad]."""


@dataclass(frozen=True, eq=False)
class Channel:
    """Readings of a channel, rows without a value left out.

    Attributes
    ----------
    record : str
        Name of the record.
    signal : Signal
        With all its channels.
    index : int
        Which of them.
    rows : ndarray of int, shape (n,)
        Rows of the signal.
    time : ndarray, shape (n,)
        Instants in the simulation's time [s], or numbers of poses.
    measured, predicted : ndarray, shape (n,)
        Readings and what the nominal model says.
    columns, sizes : ndarray, shapes (n, k) and (k,)
        c and S.
    noise, floor : float
        1 sigma of the readings, as stated, if they scatter by as much; what the nominal model misses [SI].
    size : float
        The reach of the arm for lengths [m], else 1.
    driven : ndarray of bool, shape (n,)
        Whether a drive moves; where none does, an arm may be at rest, and a model without damping rings on.
    """

    record: str
    signal: Signal
    index: int
    rows: NDArray[np.intp]
    time: Floats
    measured: Floats
    predicted: Floats
    columns: Floats
    sizes: Floats
    noise: float
    floor: float
    size: float
    driven: NDArray[np.bool_]

    @property
    def name(self) -> str:
        """As effects name channels: an axis, or "" of a scalar."""
        return channel_names(self.signal.quantity, self.signal.axes)[self.index]

    @property
    def label(self) -> str:
        """For a person: the signal, and which channel of several."""
        return f"{self.signal.name} {self.name}".rstrip()

    def fit(self) -> Fit:
        """How the readings follow the prediction."""
        return slope_of(self.measured, self.predicted, self.columns, self.sizes, self.noise, self.floor)

    def fit_at(self, slope: float) -> Fit:
        """The same by a slope that is given."""
        args = (self.measured, self.predicted, self.columns, self.sizes, self.noise, self.floor)
        return fit_at(slope, *args)

    @property
    def least(self) -> float:
        """What any hypothesis leaves: noise, and the share of what its signal shows that models miss [SI]."""
        shown = float(np.max(np.nanstd(self.signal.values, axis=0)))
        return float(np.hypot(self.noise, missed(self.signal) * shown))

    def left(self) -> Floats:
        """Residual of the best slope and columns without priors; a tenth of the rows does not count."""
        A = np.column_stack([self.predicted, self.columns])
        A = A / np.maximum(np.linalg.norm(A, axis=0), 1e-300)
        keep = np.ones(len(A), dtype=bool)
        for _ in range(3):
            found = self.measured - A @ np.linalg.lstsq(A[keep], self.measured[keep], rcond=1e-9)[0]
            keep = np.abs(found) <= np.quantile(np.abs(found), 0.9)
        return np.asarray(found)

    def part(self, keep: NDArray[np.bool_]) -> Channel:
        """Some of its rows."""
        arrays = {
            key: getattr(self, key)[keep]
            for key in ("rows", "time", "measured", "predicted", "columns", "driven")
        }
        return replace(self, **arrays)


LEAST_ROWS = 6
STANDS = 0.05
"""Part of a drive's greatest rate below which it stands."""


def missed(signal: Signal) -> float:
    """Share of a motion that a nominal model misses of a signal [-]."""
    return MISSED.get(signal.quantity, MISSED_ELSE)


def channels(name: str, simulated: SimulatedRecord, placement: Placement) -> list[Channel]:
    """All channels of a record that the simulation predicts and that hold enough values."""
    return [
        channel
        for signal in simulated.evidence.values()
        for channel in _of_signal(name, simulated, placement, signal)
        if len(channel.rows) >= LEAST_ROWS
    ]


def _of_signal(name: str, simulated: SimulatedRecord, placement: Placement, signal: Signal) -> list[Channel]:
    predicted = values_at(simulated, signal, placement)
    measured = _nearer_sign(signal, predicted)
    instants = simulated.instants(signal, placement)
    found = []
    for k in range(measured.shape[1]):
        keep = np.isfinite(measured[:, k]) & np.isfinite(predicted[:, k])
        columns, sizes = columns_of(simulated, signal, placement, predicted, k)
        moving = float(np.std(predicted[keep, k])) if keep.any() else 0.0
        stated = float(simulated.effects(signal).noise(signal.noise_std or 0.0)[k])
        noise = min(stated, _step_to_step(measured[keep, k]))
        found.append(
            Channel(
                name,
                signal,
                k,
                np.flatnonzero(keep),
                instants[keep],
                measured[keep, k],
                predicted[keep, k],
                columns[keep],
                sizes,
                noise or 1e-6 * moving,
                _floor(simulated, signal, moving),
                reach(simulated.arm) if signal.unit == "m" else 1.0,
                _driven(simulated, instants[keep]),
            )
        )
    return found


def _driven(simulated: SimulatedRecord, instants: Floats) -> NDArray[np.bool_]:
    """Where some drive moves by more than a part `STANDS` of its greatest rate; everywhere in poses."""
    if simulated.record.kind == "static":
        return np.ones(len(instants), dtype=bool)
    run = simulated.simulation
    rate = np.abs(np.asarray(run.drive_rate))
    moving = np.any(rate > STANDS * np.max(rate, axis=0), axis=1)
    found: NDArray[np.bool_] = np.interp(instants, run.time, moving.astype(float)) > 0
    return found


def _step_to_step(y: Floats) -> float:
    """Scatter from one reading to the next: no sensor has more noise, whatever is stated."""
    return float(np.std(np.diff(y)) / np.sqrt(2)) if len(y) > 2 else 0.0


def _nearer_sign(signal: Signal, predicted: Floats) -> Floats:
    """Readings; of the two quaternions of one orientation the one nearer to the prediction."""
    if signal.quantity != "orientation":
        return signal.values
    sign = np.sign(np.sum(signal.values * predicted, axis=1))
    return signal.values * np.where(sign == 0, 1.0, sign)[:, None]


def _floor(simulated: SimulatedRecord, signal: Signal, moving: float) -> float:
    """What a nominal model misses of a channel [SI]."""
    absolute = AMISS.get(signal.quantity, 0.0)
    if signal.unit == "m":
        absolute = AMISS["position"] * reach(simulated.arm)
    return float(np.hypot(absolute, missed(signal) * moving))
