"""Gross outliers: samples far from their neighbours that are back in place one or two rows later.

A row of evidence is an outlier if its residual differs from the median of its seven neighbours, and from the
parabolas through those before, after and on both sides (`flexarm.measurement.outliers`), by more than

* `spike_noises` times the stated noise,
* `spike_spread` times the usual such difference, and `NEARBY` times that of most rows around it,
* `unusual_ratio` times the vibration that the model predicts around it, as its phase is seldom right, or
  less of it where most rows of the signal show that phase right.

Torques, accelerations and strains jump where teeth strike; only readings beyond `RANGES` ranges of the others
are outliers there. Of drives see `flexarm.comparison.drive_outliers`, of poses, which have no neighbours,
`flexarm.comparison.pose_outliers`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.drive_outliers import RemovedOutliers, blank_rows, isolated, removed
from flexarm.comparison.pose_outliers import pose_outliers
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.filters import cubic_average
from flexarm.measurement.outliers import (
    MOST_OF_THEM,
    NEARBY,
    SMOOTH,
    beyond_range_of_others,
    deviation_from_median,
    deviation_from_parabolas,
    nearby,
)
from flexarm.measurement.predict import read
from flexarm.record import Record, Signal
from flexarm.validation.channel import Channel
from flexarm.validation.policy import POLICY


def clean_evidence(
    name: str, simulated: SimulatedRecord, placement: Placement, channels: Sequence[Channel]
) -> tuple[Record, list[RemovedOutliers]]:
    """Return the record without the outliers of its other signals, of given channels, and these."""
    record, found = simulated.record, []
    if record.kind == "static":
        return _without_poses(name, simulated, placement)
    residuals: dict[str, Floats] = {}
    for channel in channels:
        signal = channel.signal
        residual = residuals.setdefault(signal.name, np.full(signal.values.shape, np.nan))
        residual[channel.rows, channel.index] = channel.robust_residual()
    for signal_name, residual in residuals.items():
        signal = record.signals[signal_name]
        residual[~signal.valid] = np.nan
        noise = simulated.effects(signal).noise(signal.noise_std or 0.0)
        rows = isolated(spikes(residual, noise, predicted_vibration(simulated, signal, placement)))
        if signal.quantity not in SMOOTH:
            rows &= beyond_range_of_others(residual, rows)
        if rows.any() and rows.mean() < POLICY.max_spike_share:
            record = blank_rows(record, signal.name, rows)
            found.append(removed(name, signal, rows, residual))
    return record, found


def _without_poses(
    name: str, simulated: SimulatedRecord, placement: Placement
) -> tuple[Record, list[RemovedOutliers]]:
    """Return the record of poses without the outliers among them, and these."""
    record, found = simulated.record, []
    for signal_name, far in pose_outliers(simulated, placement).items():
        signal, rows = record.signals[signal_name], np.flatnonzero(far.rows)
        size = float(np.sqrt(np.mean(far.size[rows] ** 2)))
        poses = tuple(map(str, np.asarray(signal.pose)[rows]))
        record = blank_rows(record, signal_name, far.rows)
        found.append(RemovedOutliers(name, signal_name, tuple(map(int, rows)), size, signal.unit, poses))
    return record, found


def predicted_vibration(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> Floats:
    """Return the greatest vibration that the model predicts around each row, shape (n, channels)."""
    from scipy.ndimage import maximum_filter1d

    run, instants = simulated.simulation, simulated.instants(signal, placement)
    window = 2 * round(POLICY.vibration_period / POLICY.vibration_step / 2) + 1
    first = max(instants[0] - POLICY.vibration_period, run.time[0])
    last = max(
        min(instants[-1] + POLICY.vibration_period, run.time[-1]), first + window * POLICY.vibration_step
    )
    grid = np.arange(first, last, POLICY.vibration_step)
    on_grid = read(run, signal, np.minimum(grid, run.time[-1]), simulated.frame(signal, placement))
    vibration = np.abs(on_grid - cubic_average(on_grid, window))
    greatest = maximum_filter1d(vibration, window, axis=0, mode="nearest")
    return np.asarray(greatest[np.searchsorted(grid, instants).clip(0, len(grid) - 1)])


def spikes(residual: Floats, noise: Floats, ringing: Floats) -> NDArray[np.bool_]:
    """Return True at rows of a residual, measured minus predicted (n, channels), that are outliers, shape
    (n,).

    `noise` (channels,) is 1 sigma; `ringing` (n, channels) the vibration predicted around each row.
    """
    found = np.zeros(len(residual), dtype=bool)
    rows, off, usual = deviation_from_median(residual)
    least = np.maximum(POLICY.spike_noises * noise, POLICY.spike_spread * usual)
    if not np.any(np.abs(off) > least):  # most signals need no parabolas
        return found
    size = np.minimum(np.abs(off), deviation_from_parabolas(residual[rows]))
    far = np.flatnonzero(np.any(size > least, axis=1))
    limit = np.maximum(least, NEARBY * nearby(size, far))
    limit[(far < 2) | (far >= len(rows) - 2)] *= POLICY.edge_ratio
    vibration = POLICY.unusual_ratio * ringing[rows]
    rings = vibration > least
    missed = size[rings] / vibration[rings]  # share of the predicted vibration
    phase = min(NEARBY * float(np.quantile(missed, MOST_OF_THEM)), 1.0) if len(missed) else 1.0
    found[rows[far]] = np.any(size[far] > np.maximum(limit, phase * vibration[far]), axis=1)
    return found
