"""One channel of a record and its prediction by the nominal model.

A nominal model misses a part of any motion, the model error. Offsets, turns and delays that are no fault are
the nuisance regressors of `validation.regression`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.sizes import reach
from flexarm.arrays import Floats
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.quantities import channel_names
from flexarm.record import Signal
from flexarm.validation.policy import POLICY
from flexarm.validation.regression import GainFit, fit_at_gain, fit_gain, nuisance_regressors, predicted_at

QUASI_STATIC = ("position", "deflection", "joint_angle", "inclination", "orientation")
"""Quantities that do not ring by as much as they move."""
RINGING = ("motor_torque", "motor_voltage", "strain", "acceleration", "angular_rate")
"""Quantities of which a nominal model misses more."""


@dataclass(frozen=True, eq=False)
class Channel:
    """Hold the readings of a channel and their prediction, without rows that lack a value."""

    record: str
    """Name of the record."""
    signal: Signal
    """With all its channels."""
    index: int
    """Which of them."""
    rows: NDArray[np.intp]
    """Rows of the signal. Shape (n,)."""
    time: Floats
    """Instants in the simulation's time [s], or numbers of poses. Shape (n,)."""
    measured: Floats
    predicted: Floats
    """Readings and the nominal prediction. Shape (n,)."""
    regressors: Floats
    prior_std: Floats
    """c and S. Shape (n, k) and (k,)."""
    noise: float
    model_error: float
    """1 sigma of the readings, as stated or as they scatter, if that is less; model error [SI]."""
    length_scale: float
    """The reach of the arm for lengths [m], else 1."""
    driven: NDArray[np.bool_]
    """True where a drive moves. Elsewhere the arm may rest, while a model without damping rings on. Shape
    (n,)."""

    @property
    def name(self) -> str:
        """Return the name by which effects know the channel: an axis, or "" of a scalar."""
        return channel_names(self.signal.quantity, self.signal.axes)[self.index]

    @property
    def label(self) -> str:
        """Return the signal and the channel as text."""
        return f"{self.signal.name} {self.name}".rstrip()

    def fit(self) -> GainFit:
        """Return the regression of the readings on the prediction."""
        return fit_gain(
            self.measured, self.predicted, self.regressors, self.prior_std, self.noise, self.model_error
        )

    def fit_at_gain(self, gain: float) -> GainFit:
        """Return the same at a given gain."""
        args = (self.measured, self.predicted, self.regressors, self.prior_std, self.noise, self.model_error)
        return fit_at_gain(gain, *args)

    @property
    def least_scatter(self) -> float:
        """Return the least scatter of any hypothesis: noise, and what models miss of the shown motion."""
        shown = float(np.max(np.nanstd(self.signal.values, axis=0)))
        return float(np.hypot(self.noise, missed_share(self.signal) * shown))

    def robust_residual(self) -> Floats:
        """Return the residual of the regression without priors and without the worst tenth of the rows."""
        A = np.column_stack([self.predicted, self.regressors])
        A = A / np.maximum(np.linalg.norm(A, axis=0), 1e-300)
        keep = np.ones(len(A), dtype=bool)
        for _ in range(3):
            found = self.measured - A @ np.linalg.lstsq(A[keep], self.measured[keep], rcond=1e-9)[0]
            keep = np.abs(found) <= np.quantile(np.abs(found), 0.9)
        return np.asarray(found)

    def select(self, keep: NDArray[np.bool_]) -> Channel:
        """Return the channel with some of its rows."""
        arrays = {
            key: getattr(self, key)[keep]
            for key in ("rows", "time", "measured", "predicted", "regressors", "driven")
        }
        return replace(self, **arrays)


def missed_share(signal: Signal) -> float:
    """Return the share of a motion that a nominal model misses of a signal [-]."""
    return POLICY.missed_ringing if signal.quantity in RINGING else POLICY.missed_share


def channels(name: str, simulated: SimulatedRecord, placement: Placement) -> list[Channel]:
    """Return all channels of a record that the simulation predicts and that hold enough values."""
    return [
        channel
        for signal in simulated.evidence.values()
        for channel in _of_signal(name, simulated, placement, signal)
        if len(channel.rows) >= POLICY.min_rows
    ]


def _of_signal(name: str, simulated: SimulatedRecord, placement: Placement, signal: Signal) -> list[Channel]:
    predicted = predicted_at(simulated, signal, placement)
    measured = _matching_quaternions(signal, predicted)
    instants = simulated.instants(signal, placement)
    found = []
    for k, (regressors, prior_std) in enumerate(nuisance_regressors(simulated, signal, placement, predicted)):
        keep = np.isfinite(measured[:, k]) & np.isfinite(predicted[:, k])
        moving = float(np.std(predicted[keep, k])) if keep.any() else 0.0
        stated = float(simulated.effects(signal).noise(signal.noise_std or 0.0)[k])
        noise = min(stated, _successive_scatter(measured[keep, k]))
        found.append(
            Channel(
                name,
                signal,
                k,
                np.flatnonzero(keep),
                instants[keep],
                measured[keep, k],
                predicted[keep, k],
                regressors[keep],
                prior_std,
                noise or 1e-6 * moving,
                _model_error(simulated, signal, moving),
                reach(simulated.arm) if signal.unit == "m" else 1.0,
                _driven(simulated, instants[keep]),
            )
        )
    return found


def _driven(simulated: SimulatedRecord, instants: Floats) -> NDArray[np.bool_]:
    """Return True where a drive exceeds `moving_rate` of its greatest rate; everywhere in poses."""
    if simulated.record.kind == "static":
        return np.ones(len(instants), dtype=bool)
    run = simulated.simulation
    rate = np.abs(np.asarray(run.drive_rate))
    moving = np.any(rate > POLICY.moving_rate * np.max(rate, axis=0), axis=1)
    found: NDArray[np.bool_] = np.interp(instants, run.time, moving.astype(float)) > 0
    return found


def _successive_scatter(y: Floats) -> float:
    """Return the scatter from one reading to the next, an upper bound of the noise."""
    return float(np.std(np.diff(y)) / np.sqrt(2)) if len(y) > 2 else 0.0


def _matching_quaternions(signal: Signal, predicted: Floats) -> Floats:
    """Return the readings; of the two quaternions of one orientation the one nearer to the prediction."""
    if signal.quantity != "orientation":
        return signal.values
    sign = np.sign(np.sum(signal.values * predicted, axis=1))
    return signal.values * np.where(sign == 0, 1.0, sign)[:, None]


def _model_error(simulated: SimulatedRecord, signal: Signal, moving: float) -> float:
    """Return the error of the nominal model of a channel [SI]."""
    size = reach(simulated.arm) if signal.unit == "m" else float(signal.quantity in QUASI_STATIC)
    return float(np.hypot(POLICY.missed_at_rest * size, missed_share(signal) * moving))
