r"""The part of a gap that repeats with every turn of a motor, told in its angle instead of in time.

With the motor's angle n q, n the gear ratio, and the share w of a turn of the joint that the direction shows,

    h = w sum_m a_m u_m + sum_r (b_mr x_mr + c_mr x'_mr/omega_r),     u_m = cos(m n q), sin(m n q)    (1)
    x'' + 2 zeta_r omega_r x' + omega_r^2 x = omega_r^2 u_m                                          (2)

x_mr is how a mode r of the model answers the wave: near resonance most of the gap. An angle does not alias:
waves and answers are computed at the simulation's steps and read at the samples' own instants, however fast
the motor turns.

Slow parts of the gap are kept out: the columns of (1) are made orthogonal to polynomials in angle, rate and
acceleration. Any columns catch something; m is taken only if it catches `TIMES` what the columns with m a
little higher or lower catch (`BESIDE`), if that is more than noise and `LEAST` of the squares, and if the
motor turns often enough.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.residual_analysis.motion_states import JointStates

MULTIPLES = (1, 2, 3, 4)
"""Periods a turn of the motor that are looked for."""
MODES = 2
"""Modes that answer."""
LEAST_DAMPING = 5e-3
"""Damping ratio at least taken in (2), so that an answer forgets how it began."""
BESIDE = (0.8, 0.9, 1.1, 1.2)
"""Factors of m for columns that hold no harmonic."""
TIMES = 3.0
LEAST = 0.01
TURNS = 10.0
"""Least number of periods in the range of the angle: then the nearest of `BESIDE` differs by one."""
ALARM = 1e-5
"""Probability that noise alone is taken for a harmonic."""


@dataclass(frozen=True, eq=False)
class Harmonic:
    """One harmonic that a gap holds.

    Attributes
    ----------
    joint : str
        Whose motor turns.
    multiple : int
        Periods a turn of the motor.
    columns : ndarray, shape (n, k)
        Of (1), without slow parts.
    band_hz : tuple of float
        Frequencies of the wave, 5 to 95 % of the samples.
    """

    joint: str
    multiple: int
    columns: Floats
    band_hz: tuple[float, float]


@dataclass(eq=False)
class MotorHarmonics:
    """Waves of the motors of one record, with the answers of its modes; each is computed once.

    Attributes
    ----------
    pair : AlignedRecord
        The record beside its simulation.
    """

    pair: AlignedRecord
    _found: dict[tuple[str, float], Floats] = field(default_factory=dict)

    def at(self, joint: str, multiple: float, instants: Floats) -> Floats:
        """u, x and x'/omega of (1)-(2) for `multiple` radians a radian of the joint, shape (m, columns)."""
        key = (joint, multiple)
        if key not in self._found:
            self._found[key] = self._computed(joint, multiple)
        return np.stack([np.interp(instants, self._grid, column) for column in self._found[key].T], axis=1)

    @property
    def _grid(self) -> Floats:
        """Even steps over the run [s]."""
        time = np.asarray(self.pair.simulated.simulation.time)
        return np.linspace(time[0], time[-1], len(time))

    def _computed(self, joint: str, multiple: float) -> Floats:
        run, grid = self.pair.simulated.simulation, self._grid
        angle = np.interp(grid, run.time, np.asarray(run.drive_angle)[:, run.joints.index(joint)])
        columns = []
        for wave in (np.cos(multiple * angle), np.sin(multiple * angle)):
            columns.append(wave)
            for frequency, damping in self.pair.modes[:MODES]:
                columns += _answer(wave, grid[1] - grid[0], 2 * np.pi * frequency, damping)
        return np.stack(columns, axis=1)


def _answer(wave: Floats, step: float, omega: float, damping: float) -> list[Floats]:
    """x and x'/omega of (2) from rest under the first value, by the trapezoidal rule."""
    from scipy.signal import lfilter

    k, loss = 2 / step, 2 * max(damping, LEAST_DAMPING) * omega  # d/dt is k (z - 1)/(z + 1)
    below = np.array([k**2 + k * loss + omega**2, 2 * (omega**2 - k**2), k**2 - k * loss + omega**2])
    above = omega**2 * np.array([1.0, 2.0, 1.0]), omega * k * np.array([1.0, 0.0, -1.0])
    return [np.asarray(lfilter(each, below, wave - wave[0])) for each in above]


def detected_harmonics(
    values: Floats,
    sigma: float,
    time: Floats,
    waves: MotorHarmonics,
    states: Sequence[JointStates],
    ratios: Sequence[float],
    shares: Sequence[Floats | float],
) -> list[Harmonic]:
    """Harmonics of the motors that values hold.

    Parameters
    ----------
    values, time : ndarray, shape (n,)
        The gap of one signal along one direction, and its instants [s].
    sigma : float
        Its noise.
    waves : MotorHarmonics
        Of the record.
    states : sequence of JointStates
        Of the joints.
    ratios : sequence of float
        Their gear ratios.
    shares : sequence of float or ndarray, shape (n,)
        w of (1) for each joint.
    """
    slow = _slow(states)
    rest = values - slow @ (slow.T @ values)
    found = []
    for each, ratio, share in zip(states, ratios, shares, strict=True):

        def columns(
            multiple: float, joint: str = each.joint, ratio: float = ratio, share: Floats | float = share
        ) -> Floats:
            raw = waves.at(joint, multiple * ratio, time) * np.reshape(share, (-1, 1))
            return np.asarray(raw - slow @ (slow.T @ raw))

        for multiple in MULTIPLES:
            if not np.any(share) or not _turns_enough(each, multiple * ratio):
                continue
            own = columns(multiple)
            caught = _caught(own, rest)
            few = len(values) < 4 * own.shape[1] or caught < LEAST * (values @ values)
            if few or not _more_than_noise(caught, sigma, own.shape[1]):
                continue
            if caught > TIMES * max(_caught(columns(factor * multiple), rest) for factor in BESIDE):
                speed = multiple * ratio * np.abs(each.rate) / (2 * np.pi)
                low, high = np.quantile(speed, [0.05, 0.95])
                found.append(Harmonic(each.joint, multiple, own, (float(low), float(high))))
    return found


def harmonic_parts(values: Floats, harmonics: Iterable[Harmonic]) -> tuple[list[Floats], Floats]:
    """What each harmonic adds to those before it, and the rest; all orthogonal to each other."""
    parts, basis, rest = [], np.empty((len(values), 0)), values
    for each in harmonics:
        own = orthonormal(each.columns - basis @ (basis.T @ each.columns))
        parts.append(own @ (own.T @ values))
        basis, rest = np.concatenate([basis, own], axis=1), rest - parts[-1]
    return parts, rest


def orthonormal(columns: Floats) -> Floats:
    """Basis of the space of columns, shape (n, rank)."""
    left, size, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, size > 1e-9 * max(size.max(initial=0.0), 1e-300)])


def _turns_enough(states: JointStates, ratio: float) -> bool:
    """Whether the motor's periods are enough to tell its harmonics from what is beside them."""
    return states.moves and float(np.ptp(states.angle)) * ratio / (2 * np.pi) > TURNS


def _more_than_noise(squares: float, sigma: float, freedoms: int) -> bool:
    from scipy.special import chdtri

    return bool(squares > sigma**2 * chdtri(freedoms, ALARM))


def _slow(states: Sequence[JointStates]) -> Floats:
    """Basis of slow functions of the joints' states."""
    columns = [np.ones(len(states[0].angle))]
    for each in states:
        angle = each.angle - each.angle.mean()
        angle = angle / max(np.abs(angle).max(), 1e-12)
        columns += [angle**p for p in range(1, 5)]
        columns += [state / max(np.abs(state).max(), 1e-12) for state in (each.rate, each.acceleration)]
    return orthonormal(np.stack(columns, axis=1))


def _caught(columns: Floats, values: Floats) -> float:
    """Squares of values that columns hold, by their normal equations."""
    right = columns.T @ values
    return float(right @ np.linalg.pinv(columns.T @ columns, rcond=1e-10, hermitian=True) @ right)
