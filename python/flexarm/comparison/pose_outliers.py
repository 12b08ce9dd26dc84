"""Gross outliers among poses: a slipped decimal point, a mistaken digit, another reflector.

Poses have no neighbours. Each row is compared with its prediction by the other rows: gaps y are fitted by the
columns A of (3) to (5), with coefficients of size 1,

    y_i = A_i x + e_i,    x ~ N(0, 1),    e_i ~ N(0, s^2)                                              (1)

first with Cauchy's weights from x = 0, then by the rows near that fit. The scale s is median |e|/0.6745, for
N values that determine p coefficients times sqrt(N/(N - p)), and no less than the noise. With P the
covariance of x, a row that counted in the fit has the PRESS residual

    e_i' = (1 - H_i)^-1 e_i,    covariance s^2 (1 - H_i)^-1,    H_i = A_i P A_i^T/s^2                  (2)

and one that did not has e_i, covariance s^2 (1 + H_i). It is an outlier if, in any channel, it exceeds
`SPREAD` sigma of that, `NOISE` times the noise, and `FAR`. Quantities that the columns describe in part also
need a gap beyond twice the range of all others. An unknown frame is fitted again without the outliers. Values
that many rows share are a plateau, which the validation judges. Source: [Cook1982], chapter 2.

A nominal model that lacks something misses smoothly in the pose. To first order the gap of a point at p is

    sum over base axes a of (d_a a + r_a a x p)     shift and rotation of its frame or of the base      (3)
    + z (p - p_rigid)                               links softer, or loads heavier, than stated         (4)
    + sum over joints J_j (o_j + s_j q_j + k_j T_j) zeros, scales and springs of joints                 (5)

with the rigid Jacobian J_j, the angle q_j and the torque T_j of each joint. Channels of other quantities have
J_j = 1, each with coefficients of its own, and the predictions of all channels instead of (4). Each column is
multiplied by the size of its coefficient that few machines worth a diagnosis exceed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.kinematics import link_pose, point_jacobian
from flexarm.arm.sizes import reach
from flexarm.arrays import Floats
from flexarm.comparison.gap import drive_angles
from flexarm.comparison.initial_guess import initial_guess
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.outliers import beyond_range_of_others
from flexarm.measurement.sampling import sample
from flexarm.measurement.tracker import base_position
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


TURN = 0.05
"""Rotation of a frame, and of a joint by each part of (5) where that is greatest [rad]: three degrees."""
SHIFT = 0.02
"""Shift of a frame over the reach of the arm."""
ANGLES = ("joint_angle", "inclination", "orientation")
"""Quantities of which a model misses by `TURN`; of others that are no places it may miss all it says."""


def pose_columns(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> Floats:
    """Return columns for every row of a signal, shape (n, channels, k)."""
    of = _of_point if signal.quantity == "position" else _of_channels
    found = list(of(simulated, signal, placement))
    return np.stack([column for column in found if np.any(column)] or found[:1], axis=2)


def _of_point(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> Iterator[Floats]:
    """Yield (3) to (5) of a point, along the measured axes."""
    free = 10.0  # reaches or radians that a frame may be off by of which nothing is stated: as good as any
    known = 5.0  # stated sigmas of a registration that it may be off by
    arm, instants, axes = (
        simulated.arm,
        simulated.instants(signal, placement),
        simulated.axes(signal, placement),
    )
    frame, size, place = simulated.record.frame_of(signal), reach(arm), arm.point(signal.point)
    angles = drive_angles(simulated, instants)
    there = base_position(simulated.simulation, signal, instants)
    yield (there - link_pose(arm, place.link, angles).of_point(np.asarray(place.position))) @ axes  # eq. (4)
    shift = free * size if frame.unknown else max(SHIFT * size, known * frame.translation)
    turn = free if frame.unknown else max(TURN, known * frame.rotation)
    for axis in np.eye(3):
        yield shift * np.broadcast_to(axis @ axes, (len(signal), axes.shape[1]))  # eq. (3)
        yield turn * np.cross(axis, there) @ axes
    for joint in arm.moving_joints:
        most = TURN * (size if joint.type == "prismatic" else 1.0)
        turned = most * point_jacobian(arm, joint.name, str(signal.point), angles) @ axes
        yield turned  # eq. (5)
        for state in _states(simulated, joint.name, instants):
            yield state[:, None] * turned


def _of_channels(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> Iterator[Floats]:
    """Yield the columns of other quantities."""
    predicted = simulated.predicted(signal, placement, hold=True)
    channels = simulated.residual(signal, placement, hold=True).shape[1]
    size = TURN if signal.quantity in ANGLES else float(np.max(np.abs(predicted), initial=0.0))
    states = [np.ones(len(signal)), *map(_over_greatest, predicted.T)]
    for joint in simulated.arm.moving_joints:
        states += _states(simulated, joint.name, simulated.instants(signal, placement))
    for state in states:
        for channel in np.eye(channels):
            yield size * np.outer(state, channel)


def _states(simulated: SimulatedRecord, joint: str, instants: Floats) -> list[Floats]:
    """Return angle and torque of a joint over their greatest values."""
    run = simulated.simulation
    torque = sample(run.time, np.asarray(run.motor_torque)[:, run.joints.index(joint)], instants)
    return [_over_greatest(drive_angles(simulated, instants)[joint]), _over_greatest(torque)]


def _over_greatest(values: Floats) -> Floats:
    greatest = float(np.max(np.abs(values), initial=0.0))
    return np.asarray(values / greatest if greatest > 0 else values)
