"""Gross outliers among poses: a slipped decimal point, a mistaken digit, another reflector.

Poses have no neighbours. Each row is compared with its prediction by the other rows: gaps y are fitted by the
columns A of `pose_columns`, with coefficients of size 1,

    y_i = A_i x + e_i,    x ~ N(0, 1),    e_i ~ N(0, s^2)                                              (1)

first with Cauchy's weights from x = 0, then by the rows near that fit. The scale s is median |e|/0.6745, for
N values that determine p coefficients times sqrt(N/(N - p)), and no less than the noise. With P the
covariance of x, a row that counted in the fit has the PRESS residual

    e_i' = (1 - H_i)^-1 e_i,    covariance s^2 (1 - H_i)^-1,    H_i = A_i P A_i^T/s^2                  (2)

and one that did not has e_i, covariance s^2 (1 + H_i). It is an outlier if, in any channel, it exceeds
`SPREAD` sigma of that, `NOISE` times the noise, and `FAR`. Quantities that the columns describe in part also
need a gap beyond twice the range of all others. An unknown frame is fitted again without the outliers. Values
that many rows share are a plateau, which the validation judges. Source: [Cook1982], chapter 2.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.sizes import reach
from flexarm.arrays import Floats
from flexarm.comparison.initial_guess import initial_guess
from flexarm.comparison.pose_columns import ANGLES, pose_columns
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.outliers import beyond_range_of_others
from flexarm.record import Signal

LEAST_POSES = 5
"""Fewest poses of a signal that may have an outlier: three others predict too little of one."""
MOST = 0.15
"""Share of the rows above which they are no outliers but what the signal shows; one row may always be."""
SPREAD, NOISE = 12.0, 15.0
"""As of outliers of motions in a diagnosis."""
FAR = 0.01
"""Over the reach, or in rad: 10 mrad, twice the widest backlash of a drive, whose flanks no column knows."""
DESCRIBED = ("position", "joint_angle")
"""Quantities that the columns describe; what tilts, bears or bends also depends on how joints are turned."""


@dataclass(frozen=True, eq=False)
class PoseOutliers:
    """Hold outliers of one signal: their rows, and distances of all rows from their predictions [unit]."""

    rows: NDArray[np.bool_]
    size: Floats


def pose_outliers(simulated: SimulatedRecord, start: Placement) -> dict[str, PoseOutliers]:
    """Return outliers of a static record by signal, of those that have some.

    Frames are as stated in `start`; those of which nothing is stated are fitted here.
    """
    frames = 4  # most rigid fits of a frame, each without the outliers of the one before
    found: dict[str, PoseOutliers] = {}
    for _ in range(frames):
        signals = dict(simulated.signals)
        for name, far in found.items():
            values = np.where(far.rows[:, None], np.nan, signals[name].values)
            signals[name] = signals[name].replace(values=values)
        placement = initial_guess(replace(simulated, signals=signals), start)
        each = {name: _of_signal(simulated, signal, placement) for name, signal in simulated.evidence.items()}
        last, found = found, {name: far for name, far in each.items() if far is not None}
        if _row_numbers(last) == _row_numbers(found):
            break
    return found


def _row_numbers(found: Mapping[str, PoseOutliers]) -> dict[str, list[int]]:
    return {name: np.flatnonzero(far.rows).tolist() for name, far in found.items()}


def _of_signal(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> PoseOutliers | None:
    """Return the outliers of one signal; None if there are none, or too many."""
    gap = simulated.residual(signal, placement, hold=True)
    known = np.isfinite(gap).all(axis=1)
    if len(np.unique(np.asarray(signal.pose)[known])) < LEAST_POSES:
        return None
    far = FAR * reach(simulated.arm) if signal.unit == "m" else FAR if signal.quantity in ANGLES else 0.0
    columns = pose_columns(simulated, signal, placement)
    off, sigma = prediction_residuals(columns[known], gap[known], simulated.noise(signal))
    limit = np.maximum(SPREAD * sigma, np.maximum(NOISE * simulated.noise(signal), far))
    rows, size = np.zeros(len(gap), dtype=bool), np.full(len(gap), np.nan)
    held = _repeated(signal.values[known], signal.noise_std or 0.0)
    beyond = np.abs(off) > limit
    if held.shape == beyond.shape:  # gaps of orientations have no channels
        beyond &= ~held
    rows[known], size[known] = np.any(beyond, axis=1), np.linalg.norm(off, axis=1)
    if rows.any() and signal.quantity not in DESCRIBED:
        rows &= beyond_range_of_others(gap, rows)
    return PoseOutliers(rows, size) if 0 < rows.sum() <= max(1.0, MOST * known.sum()) else None


def _repeated(values: Floats, noise: float) -> NDArray[np.bool_]:
    """Return True at readings that `alike` rows share, exactly or, at the ends of the range, to the noise."""
    # Rows that make a plateau, and the noises that those at an end of the range may differ by.
    alike, ends = 5, 6.0
    found = np.zeros(values.shape, dtype=bool)
    for channel, column in zip(found.T, values.T, strict=True):
        _, number, count = np.unique(column, return_inverse=True, return_counts=True)
        channel |= count[number] >= alike
        for end in (column.min(), column.max()):
            at = np.abs(column - end) <= ends * noise
            channel |= at & (at.sum() >= alike)
    return found


def prediction_residuals(columns: Floats, gap: Floats, noise: Floats) -> tuple[Floats, Floats]:
    """Return PRESS residuals (2) and their standard deviations, shapes (n, channels).

    A of (1) has the shape (n, channels, k), y (n, channels), and the noise of the readings (channels,).
    """
    # Least scale over the greatest gap, for records without noise; least freedom of a row, for rounding.
    tiny = 1e-9
    settled = 1e-2  # change of the scale, over itself, below which the former end
    weighted, trimmed = 30, 5  # most rounds of the fit with weights, and those of the fit by near rows
    # Scales s at which a row's weight is a half, and within which rows are near the fit.
    wide, near = 2.4, 6.0
    least = max(float(np.max(noise)), tiny * float(np.max(np.abs(gap))), np.finfo(float).tiny)
    weight, scale = np.zeros(len(gap)), max(least, float(np.median(np.abs(gap))) / 0.6745)
    left = gap
    for _ in range(weighted):
        weight, last = 1 / (1 + np.mean(left**2, axis=1) / (wide * scale) ** 2), scale
        left, scale, _ = _fit(columns, gap, weight, scale, least)
        if abs(scale - last) < settled * last:
            break
    weight = (np.mean(left**2, axis=1) < (near * scale) ** 2).astype(float)
    for _ in range(trimmed):
        left, scale, leverage = _fit(columns, gap, weight, scale, least)
    # of rows that counted (1 - H)^-1, of others 1 + H
    freedom = np.eye(gap.shape[1]) - leverage + tiny * np.eye(gap.shape[1])
    spread = np.where(weight[:, None, None] > 0, np.linalg.inv(freedom), np.eye(gap.shape[1]) + leverage)
    off = np.where(weight[:, None] > 0, np.einsum("nab,nb->na", spread, left), left)  # eq. (2)
    return off, scale * np.sqrt(np.maximum(np.einsum("naa->na", spread), 0.0))


def _fit(
    columns: Floats, gap: Floats, weight: Floats, scale: float, least: float
) -> tuple[Floats, float, Floats]:
    """Return the residual of (1) with weights, its scale, and H of (2), shape (n, channels, channels)."""
    n, channels, k = columns.shape
    A, root = columns.reshape(-1, k) / scale, np.sqrt(np.repeat(weight, channels))
    Q, R = np.linalg.qr(np.vstack([root[:, None] * A, np.eye(k)]))
    x = np.linalg.solve(R, Q[: len(A)].T @ (root * gap.ravel() / scale))
    seen = np.linalg.solve(R.T, A.T).T.reshape(n, channels, k)
    leverage = seen @ seen.transpose(0, 2, 1)
    left = gap - columns @ x
    values = channels * float(np.sum(weight))
    determined = float(np.sum(weight * np.einsum("naa->n", leverage)))
    spread = float(np.median(np.abs(left))) / 0.6745 * np.sqrt(values / max(values - determined, 1.0))
    return left, max(least, spread), leverage
