r"""Order tracking: the part of a residual that repeats with every turn of a motor.

With the motor's angle n q, n the gear ratio, and the share w of a turn of the joint that the direction shows,

    h = w sum_m a_m u_m + sum_r (b_mr x_mr + c_mr x'_mr/omega_r),     u_m = cos(m n q), sin(m n q)    (1)
    x'' + 2 zeta_r omega_r x' + omega_r^2 x = omega_r^2 u_m                                          (2)

x_mr is the response of mode r of the model to the wave of order m: near resonance most of the residual. An
angle does not alias: waves and responses are computed at the simulation's steps and read at the samples'
instants, however fast the motor turns.

The columns of (1) are made orthogonal to the slow part of the residual, polynomials in angle, rate and
acceleration. Any columns explain something. An order m is taken only if it explains `order_contrast` times
what the columns of slightly higher or lower orders explain, more than noise and `order_share` of the squares,
and if the motor turns often enough.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.residual_analysis.motion_states import JointStates
from flexarm.residual_analysis.noise import exceeds_noise
from flexarm.residual_analysis.policy import POLICY


@dataclass(frozen=True, eq=False)
class Harmonic:
    """One motor order of a residual."""

    joint: str
    """Whose motor turns."""
    multiple: int
    """Order: periods a turn of the motor."""
    columns: Floats
    """Of (1), without slow parts. Shape (n, k)."""
    band_hz: tuple[float, float]
    """Frequencies of the wave, 5 to 95 % of the samples."""


@dataclass(eq=False)
class MotorHarmonics:
    """Waves of the motors of one record, with the responses of its modes; each is computed once."""

    pair: AlignedRecord
    _found: dict[tuple[str, float], Floats] = field(default_factory=dict)

    def at(self, joint: str, multiple: float, instants: Floats) -> Floats:
        """Return u, x, x'/omega of (1)-(2), shape (m, columns), for `multiple` rad a radian of the joint."""
        run = self.pair.simulated.simulation
        grid = np.linspace(run.time[0], run.time[-1], len(run.time))
        key = (joint, multiple)
        if key not in self._found:
            angle = np.interp(grid, run.time, np.asarray(run.drive_angle)[:, run.joints.index(joint)])
            columns = []
            for wave in (np.cos(multiple * angle), np.sin(multiple * angle)):
                columns.append(wave)
                for frequency, damping in self.pair.modes[: POLICY.modes]:
                    columns += _modal_response(wave, grid[1] - grid[0], 2 * np.pi * frequency, damping)
            self._found[key] = np.stack(columns, axis=1)
        return np.stack([np.interp(instants, grid, column) for column in self._found[key].T], axis=1)


def _modal_response(wave: Floats, step: float, omega: float, damping: float) -> list[Floats]:
    """Return x and x'/omega of (2) from rest under the first value, by the trapezoidal rule.

    The damping ratio is 0.005 at least, so that a response forgets how it began.
    """
    from scipy.signal import lfilter

    k, loss = 2 / step, 2 * max(damping, 5e-3) * omega  # d/dt is k (z - 1)/(z + 1)
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
    """Return the motor orders 1 to 4 that the residual `values` (n,) of one signal along one direction holds.

    `sigma` is its noise, `time` (n,) its instants [s], `waves` those of the record. `states`, gear `ratios`
    and `shares` w of (1), each a number or of shape (n,), are of the joints.
    """
    slow = _slow_basis(states)
    rest = values - slow @ (slow.T @ values)
    spacing, found = POLICY.order_spacing, []
    for each, ratio, share in zip(states, ratios, shares, strict=True):

        def columns(
            multiple: float, joint: str = each.joint, ratio: float = ratio, share: Floats | float = share
        ) -> Floats:
            raw = waves.at(joint, multiple * ratio, time) * np.reshape(share, (-1, 1))
            return np.asarray(raw - slow @ (slow.T @ raw))

        for multiple in (1, 2, 3, 4):
            periods = float(np.ptp(each.angle)) * multiple * ratio / (2 * np.pi)
            if not np.any(share) or not each.moves or periods <= 1 / spacing:
                continue
            own = columns(multiple)
            explained, freedoms = _explained(own, rest), own.shape[1]
            few = len(values) < 4 * freedoms or explained < POLICY.order_share * (values @ values)
            if few or not exceeds_noise(explained / sigma**2, freedoms, POLICY.order_false_alarm):
                continue
            factors = (1 - 2 * spacing, 1 - spacing, 1 + spacing, 1 + 2 * spacing)
            if explained > POLICY.order_contrast * max(
                _explained(columns(factor * multiple), rest) for factor in factors
            ):
                speed = multiple * ratio * np.abs(each.rate) / (2 * np.pi)
                low, high = np.quantile(speed, [0.05, 0.95])
                found.append(Harmonic(each.joint, multiple, own, (float(low), float(high))))
    return found


def harmonic_parts(values: Floats, harmonics: Iterable[Harmonic]) -> tuple[list[Floats], Floats]:
    """Return what each harmonic adds to those before it, and the rest; all orthogonal to each other."""
    parts, basis, rest = [], np.empty((len(values), 0)), values
    for each in harmonics:
        own = _orthonormal(each.columns - basis @ (basis.T @ each.columns))
        parts.append(own @ (own.T @ values))
        basis, rest = np.concatenate([basis, own], axis=1), rest - parts[-1]
    return parts, rest


def _orthonormal(columns: Floats) -> Floats:
    """Return a basis of the space of columns, shape (n, rank)."""
    left, size, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, size > 1e-9 * max(size.max(initial=0.0), 1e-300)])


def _slow_basis(states: Sequence[JointStates]) -> Floats:
    """Return a basis of slow functions of the joints' states."""
    columns = [np.ones(len(states[0].angle))]
    for each in states:
        angle = each.angle - each.angle.mean()
        angle = angle / max(np.abs(angle).max(), 1e-12)
        columns += [angle**p for p in range(1, 5)]
        columns += [state / max(np.abs(state).max(), 1e-12) for state in (each.rate, each.acceleration)]
    return _orthonormal(np.stack(columns, axis=1))


def _explained(columns: Floats, values: Floats) -> float:
    """Return the squares of values that columns explain, by their normal equations."""
    right = columns.T @ values
    return float(right @ np.linalg.pinv(columns.T @ columns, rcond=1e-10, hermitian=True) @ right)
