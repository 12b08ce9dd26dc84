"""Gross outliers of drives: samples far from their neighbours that are back in place one or two rows later.

Drives have no residual and are judged by the parabolas of `flexarm.measurement.outliers` alone. One of the
three is right where a drive stops within a sample. The outer two miss a smooth motion by its third
differences,

    |y_{k+3} - 3 y_{k+2} + 3 y_{k+1} - y_k|,                                                           (1)

and a row must be off by more than `edge_ratio` times the median of its neighbours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison import pose_outliers
from flexarm.measurement.outliers import AROUND, NEIGHBOURS, deviation_from_parabolas, row_list
from flexarm.record import Record, Signal
from flexarm.record.quantisation_grid import quantisation_step
from flexarm.wording import with_unit


@dataclass(frozen=True)
class SpikePolicy:
    """Hold the thresholds of outliers of motions; a comment states the unit and the reason of each."""

    spike_noises: float = pose_outliers.NOISE  # [noise] least distance of an outlier
    spike_spread: float = pose_outliers.SPREAD  # [-] the same over the usual distance
    max_spike_share: float = pose_outliers.MOST  # [-] most rows that are outliers; more is the signal itself
    max_spike_rows: int = 2  # [-] most outliers one after the other
    edge_ratio: float = 4.0  # [-] limit at the ends, with one parabola, and over third differences of drives
    rounding_share: float = 1e-6  # [-] share of a drive's range that is rounding
    spike_counts: float = 2.0  # [counts] that a drive may jump by; rounding moves it by up to 4/3


SPIKES = SpikePolicy()


@dataclass(frozen=True)
class RemovedOutliers:
    """Hold the outliers that were removed from a signal."""

    record: str
    signal: str
    """Their names."""
    rows: tuple[int, ...]
    """Rows of the signal, counted from 0, whose values are now NaN."""
    size: float
    """Root mean square of their distances [unit]."""
    unit: str
    """SI unit of the signal."""
    poses: tuple[str, ...] = ()
    """The pose of each row of a static record."""

    def __str__(self) -> str:
        count = f"{len(self.rows)} outlier{'s' * (len(self.rows) > 1)}"
        size = with_unit(self.size, self.unit)
        poses = f" ({row_list(self.poses, 'pose')})" if self.poses else ""
        return f"{count} of {self.signal} in {self.record}, {row_list(self.rows)}{poses}, {size} off, removed"


def clean_drives(name: str, record: Record) -> tuple[Record, list[RemovedOutliers]]:
    """Return the record without the outliers of its drives, and these."""
    found: list[RemovedOutliers] = []
    for drive in record.drive:
        signal = record.signals[drive]
        if signal.pose is not None or signal.quantity == "joint_command" or len(signal) < 20:
            continue
        rows = isolated(drive_spikes(signal.values[:, 0], signal.noise_std or 0.0))
        if rows.any() and rows.mean() < SPIKES.max_spike_share:
            record = blank_rows(record, signal.name, rows)
            found.append(removed(name, signal, rows, signal.values))
    return record, found


def drive_spikes(samples: Floats, noise: float) -> NDArray[np.bool_]:
    """Return True at samples of a drive, shape (n,), that are far from all three parabolas."""
    found = np.zeros(len(samples), dtype=bool)
    rows = np.flatnonzero(np.isfinite(samples))
    if len(rows) > NEIGHBOURS:
        nearest = deviation_from_parabolas(samples[rows][:, None])[:, 0]
        usual = 2 * SPIKES.spike_spread * float(np.median(nearest))
        least = SPIKES.rounding_share * float(np.ptp(samples[rows]))
        noises = 2 * SPIKES.spike_noises * noise  # parabolas have 4.4 times the noise of a sample
        limit = max(noises, usual, least, SPIKES.spike_counts * quantisation_step(samples))
        far = np.flatnonzero(nearest > limit)
        around = _neighbouring_third_differences(samples[rows], far)
        found[rows[far]] = nearest[far] > SPIKES.edge_ratio * around
    return found


def _neighbouring_third_differences(y: Floats, at: NDArray[np.intp]) -> Floats:
    """Return medians of the third differences (1) on both sides of the samples `at`, in their shape."""
    third = np.pad(np.abs(np.diff(y, 3)), AROUND + 4, constant_values=np.nan)  # k is now k + AROUND + 4
    windows = np.lib.stride_tricks.sliding_window_view(third, AROUND)
    before, after = windows[at + 1], windows[at + AROUND + 5]
    return np.asarray(np.nanmedian(np.concatenate([before, after], axis=1), axis=1))


def blank_rows(record: Record, name: str, rows: NDArray[np.bool_ | np.intp] | Sequence[int]) -> Record:
    """Return the record with rows of a signal, a mask or numbers, set to NaN."""
    values = record.signals[name].values.copy()
    values[np.asarray(rows)] = np.nan
    return record.replace(signals={**record.signals, name: record.signals[name].replace(values=values)})


def isolated(rows: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Keep runs of at most `max_spike_rows` rows."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], rows.astype(int), [0]])))
    found = np.zeros_like(rows)
    for first, last in edges.reshape(-1, 2):
        if last - first <= SPIKES.max_spike_rows:
            found[first:last] = True
    return found


def removed(name: str, signal: Signal, rows: NDArray[np.bool_], values: Floats) -> RemovedOutliers:
    """Return removed rows with the rms distance of `values` from the line through their neighbours."""
    good = ~rows & np.isfinite(values).all(axis=1)
    time, y, at = signal.time[good], values[good], signal.time[rows]
    k = np.clip(np.searchsorted(time, at) - 1, 0, len(time) - 2)  # at the ends the line is extrapolated
    share = ((at - time[k]) / (time[k + 1] - time[k]))[:, None]
    off = values[rows] - y[k] - (y[k + 1] - y[k]) * share
    size = float(np.sqrt(np.nanmean(np.sum(off**2, axis=1))))
    return RemovedOutliers(name, signal.name, tuple(map(int, np.flatnonzero(rows))), size, signal.unit)
