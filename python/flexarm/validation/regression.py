r"""How a channel follows its prediction, whatever else is small between the two.

.. math:: y_i = s\,p_i + \sum_j a_j c_{ij} + e_i, \quad a_j \sim N(0, S_j^2), \; e_i \sim N(0, \sigma^2)
   (1)

y are the readings, p the nominal model's prediction, c what sensors and arms do without being at fault: an
offset, a small turn, a late clock, friction. s is 1 for a sensor that is in order, -1 for one that counts the
other way, the factor for one in another unit, and 0 for a dead one. The estimate maximises the posterior,

.. math:: \frac{N}{n} \sum_i e_i^2/\sigma^2 + \sum_j a_j^2/S_j^2 \to \min                            (2)

with N independent samples among the n rows, as residuals of a missing effect are no noise: they last as long
as the motion that causes them. \sigma is the scatter found, and no less than

.. math:: \sigma_0^2 = \text{noise}^2 + s^2\,\text{floor}^2                                           (3)

where floor is what the nominal model misses anyway. Units: those of the channel.

What sensors and arms do without being at fault, as columns beside a channel's prediction.

They enter `validation.regression` as columns c with sizes S, far wider than any record states, so that a
missing effect is not taken for a faulty sensor:

    offset       1                    a sensor's or frame's                                           (1)
    turn         the other axes       frame, sensor or arm lean by up to 0.05 rad                     (2)
    delay        -dp/dt               at least 0.03 s, and three sigma of the clock                   (3)
    friction     sgn v, v             of torques: as large as the torque itself                       (4)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.sizes import reach
from flexarm.arrays import Floats
from flexarm.comparison.alignment_parameters import drive_clock
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.predict import read
from flexarm.measurement.sampling import sample

if TYPE_CHECKING:
    from flexarm.record import Signal


INDEPENDENT = 20
"""N of (2) at most: a motion of half a minute swings about ten times to and fro."""
ROUNDS = 8


@dataclass(frozen=True)
class Fit:
    """Outcome of (2).

    Attributes
    ----------
    slope, std : float
        s and its standard deviation [-].
    scatter : float
        Root mean square of e, no less than (3).
    moving : float
        Standard deviation of s p, what the channel would show of the motion.
    noise : float
        1 sigma of the readings.
    left : float
        Root mean square of e, however small.
    strain : float
        Half the sum of a^2/S^2 in (2): how far what is no fault had to go [nats].
    """

    slope: float
    std: float
    scatter: float
    moving: float
    noise: float
    left: float
    strain: float

    @property
    def missed(self) -> float:
        """Share of the motion that is neither explained nor noise [-]: 0 is a perfect image."""
        left = np.sqrt(max(self.left**2 - self.noise**2, 0.0))
        return float(left / self.moving) if self.moving > 0 else np.inf


def independent(count: int) -> int:
    """N of (2)."""
    return min(count, INDEPENDENT)


def slope_of(y: Floats, p: Floats, columns: Floats, sizes: Floats, noise: float, floor: float) -> Fit:
    """The slope s of (1).

    Parameters
    ----------
    y, p : ndarray, shape (n,)
        Readings and prediction.
    columns : ndarray, shape (n, k)
        c of (1).
    sizes : ndarray, shape (k,)
        S of (1), infinite where nothing is known; offsets and turns of a channel in another unit are as much
        larger as its slope is.
    noise, floor : float
        Of (3).
    """
    A = np.column_stack([p, columns])
    slope, std, sigma, left, strain = 1.0, np.inf, float(np.hypot(noise, floor)), np.inf, 0.0
    for _ in range(ROUNDS):
        last, prior = slope, sizes * max(1.0, abs(slope))
        x, spread = _posterior(A, y, np.append(0.0, 1 / prior**2), sigma)
        slope, std = float(x[0]), float(np.sqrt(spread[0]))
        left, strain = float(np.sqrt(np.mean((y - A @ x) ** 2))), _strain(x[1:], prior)
        sigma = max(left, float(np.hypot(noise, slope * floor)))
        if abs(slope - last) < 1e-3 * max(abs(slope), std):
            break
    return Fit(slope, std, sigma, abs(slope) * float(np.std(p)), noise, left, strain)


def fit_at(
    slope: float, y: Floats, p: Floats, columns: Floats, sizes: Floats, noise: float, floor: float
) -> Fit:
    """(1) with a slope that is given."""
    rest, prior = y - slope * p, sizes * max(1.0, abs(slope))
    least = float(np.hypot(noise, slope * floor))
    sigma, left, strain = least, np.inf, 0.0
    for _ in range(3):
        x = _posterior(columns, rest, 1 / prior**2, sigma)[0]
        left, strain = float(np.sqrt(np.mean((rest - columns @ x) ** 2))), _strain(x, prior)
        sigma = max(left, least)
    return Fit(slope, 0.0, sigma, abs(slope) * float(np.std(p)), noise, left, strain)


def _strain(x: Floats, prior: Floats) -> float:
    return float(0.5 * np.sum((x / prior) ** 2))


def _posterior(A: Floats, y: Floats, weight: Floats, sigma: float) -> tuple[Floats, Floats]:
    """Mode of (2) and the variances of its unknowns; columns are scaled, as they come in many units."""
    scale = np.sqrt(np.sum(A**2, axis=0))
    scale[scale == 0] = 1.0
    B = A / scale
    w = independent(len(y)) / (len(y) * sigma**2) if sigma > 0 else 1.0
    H = w * (B.T @ B) + np.diag(weight / scale**2)
    H += 1e-12 * np.trace(H) / len(H) * np.eye(len(H))
    inverse = np.linalg.inv(H)
    return inverse @ (w * (B.T @ y)) / scale, np.diag(inverse) / scale**2


TURN = 0.05
"""S of (2) [rad]."""
LATE = 0.03
"""S of (3) [s] where the clock is known better."""
SHORT = 5e-3
"""Half the difference of time for dp/dt of (3) [s]."""
OFFSETS = {"joint_angle": 0.1, "inclination": 0.05, "orientation": 0.05, "angular_rate": 0.05}
"""S of (1) [SI]; positions: 2 % of the reach; accelerations: 0.5 m/s2; infinite where none is given."""


def values_at(simulated: SimulatedRecord, signal: Signal, placement: Placement, shift: float = 0.0) -> Floats:
    """What the simulation says of a signal whose clock is late by `shift` [s] more."""
    instants = np.minimum(simulated.instants(signal, placement) - shift, simulated.simulation.time[-1])
    return simulated.effects(signal).reading(
        read(simulated.simulation, signal, instants, simulated.frame(signal, placement)), rounded=False
    )


def columns_of(
    simulated: SimulatedRecord, signal: Signal, placement: Placement, predicted: Floats, k: int
) -> tuple[Floats, Floats]:
    """c and S of (1) to (4) for channel k of a signal."""
    n = len(predicted)
    columns, sizes = [np.ones(n)], [_offset(simulated, signal)]  # eq. (1)
    for other in _other_axes(simulated, signal, placement, k):
        columns.append(other)
        sizes.append(TURN)  # eq. (2)
    if simulated.record.kind == "motion":
        ahead, behind = (values_at(simulated, signal, placement, shift)[:, k] for shift in (-SHORT, SHORT))
        columns.append((behind - ahead) / (2 * SHORT))  # eq. (3)
        sizes.append(max(LATE, 3 * _clock_sigma(simulated, signal)))
        if signal.quantity in ("motor_torque", "motor_voltage"):
            columns += _friction(simulated, signal, placement)  # eq. (4)
            sizes += [3 * float(np.nanstd(predicted[:, k]))] * 2
    return np.column_stack(columns), np.array(sizes)


def _offset(simulated: SimulatedRecord, signal: Signal) -> float:
    """S of (1)."""
    if signal.quantity == "position":
        frame = simulated.record.frame_of(signal)
        own = 0.02 * reach(simulated.arm)
        return float("inf") if frame.unknown else max(own, 5 * float(np.max(frame.translation)))
    if signal.quantity == "acceleration":
        return 0.5
    return float("inf") if signal.unit == "m" else OFFSETS.get(signal.quantity, float("inf"))


def _other_axes(simulated: SimulatedRecord, signal: Signal, placement: Placement, k: int) -> list[Floats]:
    """What the other axes would show, of vectors; of orientations the other channels."""
    if signal.quantity == "orientation":
        values = values_at(simulated, signal, placement)
        return [np.nan_to_num(values[:, j]) for j in range(4) if j != k]
    if signal.quantity not in ("position", "acceleration", "angular_rate"):
        return []
    whole = signal.replace(axes=("x", "y", "z"), channels=(), values=np.zeros((len(signal), 3)))
    bare = simulated.arm.replace(effects=(), uncertainty={})  # axes that were not measured have none
    clean = replace(simulated, arm=bare)
    values = values_at(clean, whole, placement)
    return [np.nan_to_num(values[:, j]) for j, axis in enumerate("xyz") if axis != signal.axes[k]]


def _clock_sigma(simulated: SimulatedRecord, signal: Signal) -> float:
    """1 sigma of the delay between a signal's clock and the drive's [s]; unknown: a first guess's."""
    both = [simulated.record.clocks[name] for name in {signal.clock, drive_clock(simulated.record)}]
    return 0.05 if any(clock.unknown for clock in both) else hypot(*(clock.sigma for clock in both))


def _friction(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> list[Floats]:
    """sgn v and v of the joint, scaled to 1."""
    run = simulated.simulation
    rate = np.asarray(run.drive_rate)[:, run.joints.index(signal.joint)]
    v = sample(run.time, rate, np.minimum(simulated.instants(signal, placement), run.time[-1]))
    fastest = float(np.max(np.abs(v), initial=0.0)) or 1.0
    return [np.tanh(v / (1e-2 * fastest)), v / fastest]
