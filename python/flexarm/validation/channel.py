r"""One channel of a record, its prediction by the nominal model, and the regression on that prediction.

A nominal model misses a part of any motion, the model error. Offsets, turns and delays that are no fault are
nuisance regressors.

.. math:: y_i = s\,p_i + \sum_j a_j c_{ij} + e_i, \quad a_j \sim N(0, S_j^2), \; e_i \sim N(0, \sigma^2)
   (1)

y are the readings, p the nominal prediction, s the gain: 1 in order, -1 for a sign error, a factor for
another unit, 0 if dead. The estimate maximises the posterior,

.. math:: \frac{N}{n} \sum_i e_i^2/\sigma^2 + \sum_j a_j^2/S_j^2 \to \min                            (2)

with N independent samples among the n rows, as residuals of a missing effect last as long as the motion that
causes them. \sigma is the scatter found, and no less than

.. math:: \sigma_0^2 = \text{noise}^2 + s^2\,\text{model error}^2                                     (3)

The regressors c describe deviations of sensors and arms that are no fault. Their S are far wider than any
record states, so that a missing effect is not taken for a fault:

    offset       1                    a sensor's or frame's                                           (4)
    turn         the other axes       frame, sensor or arm lean by up to `turn_std`                   (5)
    delay        -dp/dt               at least `delay_std`, and three sigma of the clock              (6)
    friction     sgn v, v             of torques: as large as the torque itself                       (7)

Units: those of the channel.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import hypot

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.sizes import reach
from flexarm.arrays import Floats
from flexarm.comparison.alignment_parameters import drive_clock
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.sampling import sample
from flexarm.quantities import channel_names
from flexarm.record import Signal
from flexarm.validation.policy import POLICY


@dataclass(frozen=True)
class GainFit:
    """Hold the estimate of (2)."""

    gain: float
    std: float
    """s and its standard deviation [-]."""
    scatter: float
    """Root mean square of e, no less than (3)."""
    moving: float
    """Standard deviation of s p."""
    noise: float
    """1 sigma of the readings."""
    rms: float
    """Root mean square of e, however small."""
    penalty: float
    """Half the sum of a^2/S^2 in (2) [nats]."""

    @property
    def unexplained_share(self) -> float:
        """Return the share of the motion that is neither explained nor noise [-]."""
        rms = np.sqrt(max(self.rms**2 - self.noise**2, 0.0))
        return float(rms / self.moving) if self.moving > 0 else np.inf


def independent_samples(count: int) -> int:
    """Return N of (2), of so many rows."""
    return min(count, POLICY.independent_samples)


def _penalty(x: Floats, prior: Floats) -> float:
    return float(0.5 * np.sum((x / prior) ** 2))


class _Regression:
    """Squares and products of regressors A (n, k) and readings y (n,), summed once."""

    def __init__(self, A: Floats, y: Floats) -> None:
        self.A, self.y = A, y
        self._squares, self._along = A.T @ A, A.T @ y

    def posterior(self, weight: Floats, sigma: float) -> tuple[Floats, Floats]:
        """Return the mode of (2) and its variances; regressors are scaled, as their units differ."""
        count = len(self.y)
        w = independent_samples(count) / (count * sigma**2) if sigma > 0 else 1.0
        H = w * self._squares + np.diag(np.minimum(weight, 1e200))
        scale = np.sqrt(np.diag(H))
        scale[scale == 0] = 1.0
        inverse = np.linalg.inv(H / np.outer(scale, scale) + 1e-12 * np.eye(len(H)))
        return inverse @ (w * self._along / scale) / scale, np.diag(inverse) / scale**2

    def rms(self, x: Floats) -> float:
        """Return the root mean square of e of (1)."""
        return float(np.sqrt(np.mean((self.y - self.A @ x) ** 2)))


def predicted_at(
    simulated: SimulatedRecord, signal: Signal, placement: Placement, shift: float = 0.0
) -> Floats:
    """Return the prediction of a signal whose clock is late by `shift` [s] more."""
    instants = np.minimum(simulated.instants(signal, placement) - shift, simulated.simulation.time[-1])
    seen = simulated if shift == 0.0 else replace(simulated)
    return seen.reading(signal, instants, placement)


def nuisance_regressors(
    simulated: SimulatedRecord, signal: Signal, placement: Placement, predicted: Floats
) -> Iterator[tuple[Floats, Floats]]:
    """Return the regressors c and deviations S of (4) to (7) for each channel of a signal."""
    axes, names = _axes(simulated, signal, placement, predicted), channel_names(signal.quantity, signal.axes)
    moving = simulated.record.kind == "motion"
    if moving:
        ahead, behind = (
            predicted_at(simulated, signal, placement, shift)
            for shift in (-POLICY.short_delay, POLICY.short_delay)
        )
        delayed = (behind - ahead) / (2 * POLICY.short_delay)  # eq. (6)
        both = [simulated.record.clocks[name] for name in {signal.clock, drive_clock(simulated.record)}]
        sigma = 0.05 if any(clock.unknown for clock in both) else hypot(*(clock.sigma for clock in both))
    for k in range(predicted.shape[1]):
        regressors, prior_std = [np.ones(len(predicted))], [_offset(simulated, signal)]  # eq. (4)
        for axis, other in axes.items():
            if axis != names[k]:
                regressors.append(other)
                prior_std.append(POLICY.turn_std)  # eq. (5)
        if moving:
            regressors.append(delayed[:, k])
            prior_std.append(max(POLICY.delay_std, 3 * sigma))
            if signal.quantity in ("motor_torque", "motor_voltage"):
                regressors += _friction(simulated, signal, placement)  # eq. (7)
                prior_std += [max(3 * float(np.nanstd(predicted[:, k])), signal.noise_std or 1e-9)] * 2
        yield np.column_stack(regressors), np.array(prior_std)


def _offset(simulated: SimulatedRecord, signal: Signal) -> float:
    """Return S of (4)."""
    if signal.quantity == "position":
        frame = simulated.record.frame_of(signal)
        own = POLICY.frame_offset_std * reach(simulated.arm)
        return float("inf") if frame.unknown else max(own, 5 * float(np.max(frame.translation)))
    return float("inf") if signal.unit == "m" else POLICY.offset_std.get(signal.quantity, float("inf"))


def _axes(
    simulated: SimulatedRecord, signal: Signal, placement: Placement, predicted: Floats
) -> dict[str, Floats]:
    """Return predictions of all axes of a vector, or of the channels of an orientation; none of a scalar."""
    if signal.quantity == "orientation":
        return dict(zip("xyzw", np.nan_to_num(predicted).T, strict=True))
    if signal.quantity not in ("position", "acceleration", "angular_rate"):
        return {}
    whole = signal.replace(axes=("x", "y", "z"), channels=(), values=np.zeros((len(signal), 3)))
    bare = simulated.arm.replace(effects=(), uncertainty={})  # effects name measured axes only
    clean = replace(simulated, arm=bare)
    return dict(zip("xyz", np.nan_to_num(predicted_at(clean, whole, placement)).T, strict=True))


def _friction(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> list[Floats]:
    """Return sgn v and v of the joint, scaled to 1."""
    run = simulated.simulation
    rate = np.asarray(run.drive_rate)[:, run.joints.index(signal.joint)]
    v = sample(run.time, rate, np.minimum(simulated.instants(signal, placement), run.time[-1]))
    fastest = float(np.max(np.abs(v), initial=0.0)) or 1.0
    return [np.tanh(v / (1e-2 * fastest)), v / fastest]


QUASI_STATIC = ("position", "joint_angle", "inclination", "orientation")
"""Quantities that do not ring by as much as they move."""
RINGING = ("motor_torque", "motor_voltage", "strain", "deflection", "acceleration", "angular_rate")
"""Quantities of which a nominal model misses more."""


@dataclass(frozen=True, eq=False)
class Channel:
    """Hold the readings of a channel and their prediction, without rows that lack a value."""

    record: str
    """Name of the record."""
    signal: Signal
    """Signal with all its channels."""
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
        """Return the estimate of (1); offsets and turns in another unit are as much larger as the gain."""
        regression = _Regression(np.column_stack([self.predicted, self.regressors]), self.measured)
        gain, std, sigma, rms, penalty = 1.0, np.inf, self._least_sigma(1.0), np.inf, 0.0
        for _ in range(POLICY.gain_rounds):
            last, prior = gain, self.prior_std * max(1.0, abs(gain))
            x, spread = regression.posterior(np.append(0.0, 1 / prior**2), sigma)
            gain, std = float(x[0]), float(np.sqrt(spread[0]))
            rms, penalty = regression.rms(x), _penalty(x[1:], prior)
            sigma = max(rms, self._least_sigma(gain))
            if abs(gain - last) < 1e-3 * max(abs(gain), std):
                break
        return GainFit(gain, std, sigma, abs(gain) * float(np.std(self.predicted)), self.noise, rms, penalty)

    def fit_at_gain(self, gain: float) -> GainFit:
        """Return the estimate of (1) at a given gain."""
        regression = _Regression(self.regressors, self.measured - gain * self.predicted)
        prior = self.prior_std * max(1.0, abs(gain))
        sigma, rms, penalty = self._least_sigma(gain), np.inf, 0.0
        for _ in range(3):
            x = regression.posterior(1 / prior**2, sigma)[0]
            rms, penalty = regression.rms(x), _penalty(x, prior)
            sigma = max(rms, self._least_sigma(gain))
        moving = abs(gain) * float(np.std(self.predicted))
        return GainFit(gain, 0.0, sigma, moving, self.noise, rms, penalty)

    def _least_sigma(self, gain: float) -> float:
        """Return sigma_0 of (3)."""
        return float(np.hypot(self.noise, gain * self.model_error))

    @property
    def least_scatter(self) -> float:
        """Return the least scatter of any hypothesis: noise, and what models miss of the shown motion."""
        shown = float(np.max(np.nanstd(self.signal.values, axis=0)))
        return float(np.hypot(self.noise, missed_share(self.signal) * shown))

    def robust_residual(self) -> Floats:
        """Return the residual of the regression without priors and without the worst tenth of the rows."""
        Q = orthonormal_columns(np.column_stack([self.predicted, self.regressors]))
        squares, along = Q.T @ Q, Q.T @ self.measured  # of most rows: of all, less those left out
        left_out: NDArray[np.intp] = np.zeros(0, dtype=np.intp)
        for _ in range(3):
            few, y = Q[left_out], self.measured[left_out]
            x = np.linalg.lstsq(squares - few.T @ few, along - few.T @ y, rcond=1e-15)[0]
            found = self.measured - Q @ x
            size = np.abs(found)
            left_out = np.flatnonzero(size > np.quantile(size, 0.9))
        return np.asarray(found)

    def select(self, keep: NDArray[np.bool_]) -> Channel:
        """Return the channel with some of its rows."""
        arrays = {
            key: getattr(self, key)[keep]
            for key in ("rows", "time", "measured", "predicted", "regressors", "driven")
        }
        return replace(self, **arrays)


def orthonormal_columns(A: Floats) -> Floats:
    """Return orthonormal columns that span those of A, without directions that are rounding."""
    squares = A.T @ A
    length = np.sqrt(np.diag(squares))
    length[length == 0] = 1.0
    sizes, axes = np.linalg.eigh(squares / np.outer(length, length))
    firm = sizes > 1e-14 * sizes[-1]
    return np.asarray(A @ (axes[:, firm] / length[:, None] / np.sqrt(sizes[firm])))


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
    predicted, measured = predicted_at(simulated, signal, placement), signal.values
    if signal.quantity == "orientation":  # the nearer one of the two quaternions of the same orientation
        same_side = np.sum(measured * predicted, axis=1, keepdims=True) >= 0
        measured = np.where(same_side, measured, -measured)
    instants = simulated.instants(signal, placement)
    found = []
    for k, (regressors, prior_std) in enumerate(nuisance_regressors(simulated, signal, placement, predicted)):
        keep = np.isfinite(measured[:, k]) & np.isfinite(predicted[:, k])
        moving = float(np.std(predicted[keep, k])) if keep.any() else 0.0
        stated = float(simulated.effects(signal).noise(signal.noise_std or 0.0)[k])
        steps = np.diff(measured[keep, k])  # their scatter is an upper bound of the noise
        noise = min(stated, float(np.std(steps) / np.sqrt(2)) if len(steps) > 1 else 0.0)
        rows = slice(None) if keep.all() else keep
        size = reach(simulated.arm) if signal.unit == "m" else 1.0
        at_rest = POLICY.missed_at_rest * size if signal.quantity in QUASI_STATIC else 0.0
        found.append(
            Channel(
                name,
                signal,
                k,
                np.flatnonzero(keep),
                instants[rows],
                measured[rows, k],
                predicted[rows, k],
                regressors[rows],
                prior_std,
                noise or 1e-6 * moving,
                float(np.hypot(at_rest, missed_share(signal) * moving)),
                size,
                _driven(simulated, instants[rows]),
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
