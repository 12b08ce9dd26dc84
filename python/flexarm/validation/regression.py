r"""Regression of a channel on its prediction, with nuisance regressors.

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

from flexarm.arm.sizes import reach
from flexarm.arrays import Floats
from flexarm.comparison.alignment_parameters import drive_clock
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.predict import read
from flexarm.measurement.sampling import sample
from flexarm.quantities import channel_names
from flexarm.record import Signal
from flexarm.validation.policy import POLICY

ROUNDS = 8


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


def effective_samples(count: int) -> int:
    """Return N of (2)."""
    return min(count, POLICY.independent_samples)


def fit_gain(
    y: Floats, p: Floats, regressors: Floats, prior_std: Floats, noise: float, model_error: float
) -> GainFit:
    """Estimate the gain s of (1) between readings y and prediction p, both (n,).

    `regressors` (n, k) are c of (1); `prior_std` (k,) is S of (1), infinite where nothing is known; offsets
    and turns of a channel in another unit are as much larger as its gain is. `noise` and `model_error` are of
    (3).
    """
    A = np.column_stack([p, regressors])
    gain, std, sigma, rms, penalty = 1.0, np.inf, float(np.hypot(noise, model_error)), np.inf, 0.0
    for _ in range(ROUNDS):
        last, prior = gain, prior_std * max(1.0, abs(gain))
        x, spread = _posterior(A, y, np.append(0.0, 1 / prior**2), sigma)
        gain, std = float(x[0]), float(np.sqrt(spread[0]))
        rms, penalty = float(np.sqrt(np.mean((y - A @ x) ** 2))), _penalty(x[1:], prior)
        sigma = max(rms, float(np.hypot(noise, gain * model_error)))
        if abs(gain - last) < 1e-3 * max(abs(gain), std):
            break
    return GainFit(gain, std, sigma, abs(gain) * float(np.std(p)), noise, rms, penalty)


def fit_at_gain(
    gain: float, y: Floats, p: Floats, regressors: Floats, prior_std: Floats, noise: float, model_error: float
) -> GainFit:
    """Estimate (1) at a given gain."""
    rest, prior = y - gain * p, prior_std * max(1.0, abs(gain))
    least = float(np.hypot(noise, gain * model_error))
    sigma, rms, penalty = least, np.inf, 0.0
    for _ in range(3):
        x = _posterior(regressors, rest, 1 / prior**2, sigma)[0]
        rms, penalty = float(np.sqrt(np.mean((rest - regressors @ x) ** 2))), _penalty(x, prior)
        sigma = max(rms, least)
    return GainFit(gain, 0.0, sigma, abs(gain) * float(np.std(p)), noise, rms, penalty)


def _penalty(x: Floats, prior: Floats) -> float:
    return float(0.5 * np.sum((x / prior) ** 2))


def _posterior(A: Floats, y: Floats, weight: Floats, sigma: float) -> tuple[Floats, Floats]:
    """Return the mode of (2) and its variances; regressors are scaled, as their units differ."""
    scale = np.sqrt(np.sum(A**2, axis=0))
    scale[scale == 0] = 1.0
    B = A / scale
    w = effective_samples(len(y)) / (len(y) * sigma**2) if sigma > 0 else 1.0
    H = w * (B.T @ B) + np.diag(weight / scale**2)
    H += 1e-12 * np.trace(H) / len(H) * np.eye(len(H))
    inverse = np.linalg.inv(H)
    return inverse @ (w * (B.T @ y)) / scale, np.diag(inverse) / scale**2


SHORT = 5e-3
"""Half the difference of time for dp/dt of (6) [s]."""


def predicted_at(
    simulated: SimulatedRecord, signal: Signal, placement: Placement, shift: float = 0.0
) -> Floats:
    """Return the prediction of a signal whose clock is late by `shift` [s] more."""
    instants = np.minimum(simulated.instants(signal, placement) - shift, simulated.simulation.time[-1])
    return simulated.effects(signal).reading(
        read(simulated.simulation, signal, instants, simulated.frame(signal, placement)), rounded=False
    )


def nuisance_regressors(
    simulated: SimulatedRecord, signal: Signal, placement: Placement, predicted: Floats
) -> Iterator[tuple[Floats, Floats]]:
    """Return the regressors c and deviations S of (4) to (7) for each channel of a signal."""
    axes, names = _axes(simulated, signal, placement, predicted), channel_names(signal.quantity, signal.axes)
    moving = simulated.record.kind == "motion"
    if moving:
        ahead, behind = (predicted_at(simulated, signal, placement, shift) for shift in (-SHORT, SHORT))
        delayed = (behind - ahead) / (2 * SHORT)  # eq. (6)
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
                prior_std += [3 * float(np.nanstd(predicted[:, k]))] * 2
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
    bare = simulated.arm.replace(effects=(), uncertainty={})  # axes that were not measured have none
    clean = replace(simulated, arm=bare)
    return dict(zip("xyz", np.nan_to_num(predicted_at(clean, whole, placement)).T, strict=True))


def _friction(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> list[Floats]:
    """Return sgn v and v of the joint, scaled to 1."""
    run = simulated.simulation
    rate = np.asarray(run.drive_rate)[:, run.joints.index(signal.joint)]
    v = sample(run.time, rate, np.minimum(simulated.instants(signal, placement), run.time[-1]))
    fastest = float(np.max(np.abs(v), initial=0.0)) or 1.0
    return [np.tanh(v / (1e-2 * fastest)), v / fastest]
