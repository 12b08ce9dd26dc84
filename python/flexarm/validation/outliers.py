"""Gross outliers: samples far from their neighbours that are back in place one or two rows later.

A row of evidence is one if its residual differs from the median of its seven neighbours, and from the
parabolas through those before, after and on both sides (`flexarm.measurement.outliers`), by more than `NOISE`
times the stated noise, `SPREAD` times the usual such difference, `NEARBY` times that of most rows around it,
and `RINGING` times the vibration that the model predicts around it: a move that rings the arm does so for
several rows, and a model seldom has the phase of its ringing right. Torques, accelerations and strains jump
where teeth strike; of these only readings beyond `RANGES` ranges of the others are outliers. Drives have no
residual: their samples are told apart by the parabolas alone; where a drive stops within a sample, one of the
three is right. What a motion does by itself from sample to sample shows in third differences beside a row,

    |y_{k+3} - 3 y_{k+2} + 3 y_{k+1} - y_k|,                                                           (1)

by which the outer two parabolas miss: of a drive without noise these are all that is left, and a row must be
off by more than `BENDS` times the median of those beside it. Poses have no neighbours and are laid beside one
another (`flexarm.comparison.pose_outliers`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.pose_outliers import pose_outliers
from flexarm.measurement.lattice import lattice_step
from flexarm.measurement.outliers import (
    AROUND,
    NEARBY,
    NEIGHBOURS,
    SMOOTH,
    beyond_all,
    nearby,
    off_the_median,
    off_the_parabolas,
)
from flexarm.measurement.predict import read
from flexarm.validation.channel import channels
from flexarm.validation.finding import Removed

if TYPE_CHECKING:
    from flexarm.comparison.simulated_record import Placement, SimulatedRecord
    from flexarm.record import Record, Signal


NOISE, SPREAD = 15.0, 12.0
RINGING, PERIOD = 3.0, 0.6
"""Vibration is what differs from cubics through `PERIOD` [s], on a grid of `GRID` [s]."""
GRID = 0.02
AT_ENDS = 4.0
"""Limit of the first and the last two rows over that of others: they have but one of the three parabolas."""
LONGEST = 2
"""Rows one after the other that may be outliers."""
MOST = 0.15
"""Share of the rows above which they are no outliers but what the signal shows."""
DRIVE_NOISE = 30.0
"""As `NOISE`, of drives; parabolas have up to 4.4 times the noise of a sample."""
BENDS = 4.0
"""As `NEARBY`, of drives, over (1): at the ends of a smooth motion a row is off by (1) itself."""
LEAST = 1e-6
"""Of a drive's range, by which a row must be off at least: less shows in no sensor, and may be rounding."""
COUNTS = 2.0
"""Steps of an encoder that a drive may jump by: rounding moves it off the middle parabola by up to 4/3."""


def clean_drives(name: str, record: Record) -> tuple[Record, list[Removed]]:
    """The record without the outliers of its drives."""
    found: list[Removed] = []
    for drive in record.drive:
        signal = record.signals[drive]
        if signal.pose is not None or signal.quantity == "joint_command" or len(signal) < 20:
            continue
        rows = _isolated(drive_spikes(signal.values[:, 0], signal.noise_std or 0.0))
        if rows.any() and rows.mean() < MOST:
            record = without(record, signal, rows)
            found.append(_removed(name, signal, rows, signal.values))
    return record, found


def clean_evidence(
    name: str, simulated: SimulatedRecord, placement: Placement
) -> tuple[Record, list[Removed]]:
    """The record without outliers of its other signals."""
    record, found = simulated.record, []
    if record.kind == "static":
        return _without_poses(name, simulated, placement)
    residuals: dict[str, Floats] = {}
    for channel in channels(name, simulated, placement):
        signal = channel.signal
        residual = residuals.setdefault(signal.name, np.full(signal.values.shape, np.nan))
        residual[channel.rows, channel.index] = channel.left()
    for signal_name, residual in residuals.items():
        signal = record.signals[signal_name]
        residual[~signal.valid] = np.nan
        noise = simulated.effects(signal).noise(signal.noise_std or 0.0)
        rows = _isolated(spikes(residual, noise, ringing(simulated, signal, placement)))
        if signal.quantity not in SMOOTH:
            rows &= beyond_all(residual, rows)
        if rows.any() and rows.mean() < MOST:
            record = without(record, signal, rows)
            found.append(_removed(name, signal, rows, residual))
    return record, found


def _without_poses(
    name: str, simulated: SimulatedRecord, placement: Placement
) -> tuple[Record, list[Removed]]:
    """The record of poses without the outliers among them."""
    record, found = simulated.record, []
    for signal_name, far in pose_outliers(simulated, placement).items():
        signal, rows = record.signals[signal_name], np.flatnonzero(far.rows)
        size = float(np.sqrt(np.mean(far.size[rows] ** 2)))
        poses = tuple(map(str, np.asarray(signal.pose)[rows]))
        record = without(record, signal, far.rows)
        found.append(Removed(name, signal_name, tuple(map(int, rows)), size, signal.unit, poses))
    return record, found


def drive_spikes(samples: Floats, noise: float) -> NDArray[np.bool_]:
    """Samples of a drive, shape (n,), that are far from all three parabolas."""
    found = np.zeros(len(samples), dtype=bool)
    rows = np.flatnonzero(np.isfinite(samples))
    if len(rows) > NEIGHBOURS:
        nearest = off_the_parabolas(samples[rows][:, None])[:, 0]
        usual = 2 * SPREAD * float(np.median(nearest))
        least = LEAST * float(np.ptp(samples[rows]))
        limit = max(DRIVE_NOISE * noise, usual, least, COUNTS * lattice_step(samples))
        found[rows] = nearest > np.maximum(limit, BENDS * _bends_beside(samples[rows]))
    return found


def _bends_beside(y: Floats) -> Floats:
    """Median of the third differences (1) on both sides of every sample that do not hold it, shape (n,)."""
    third = np.pad(np.abs(np.diff(y, 3)), AROUND + 4, constant_values=np.nan)  # k is now k + AROUND + 4
    windows = np.lib.stride_tricks.sliding_window_view(third, AROUND)
    before, after = windows[1 : 1 + len(y)], windows[AROUND + 5 : AROUND + 5 + len(y)]
    return np.asarray(np.nanmedian(np.concatenate([before, after], axis=1), axis=1))


def ringing(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> Floats:
    """Greatest vibration that the model predicts around each row, shape (n, channels)."""
    from scipy.ndimage import maximum_filter1d
    from scipy.signal import savgol_filter

    run, instants = simulated.simulation, simulated.instants(signal, placement)
    window = 2 * round(PERIOD / GRID / 2) + 1
    first = max(instants[0] - PERIOD, run.time[0])
    last = max(min(instants[-1] + PERIOD, run.time[-1]), first + window * GRID)
    grid = np.arange(first, last, GRID)
    on_grid = read(run, signal, np.minimum(grid, run.time[-1]), simulated.frame(signal, placement))
    vibration = np.abs(on_grid - savgol_filter(on_grid, window, 3, axis=0))
    greatest = maximum_filter1d(vibration, window, axis=0, mode="nearest")
    return np.asarray(greatest[np.searchsorted(grid, instants).clip(0, len(grid) - 1)])


def spikes(residual: Floats, noise: Floats, ringing: Floats | float = 0.0) -> NDArray[np.bool_]:
    """Rows of a residual, shape (n, channels), that are far off.

    Parameters
    ----------
    residual : ndarray, shape (n, channels)
        Measured minus predicted.
    noise : ndarray, shape (channels,)
        1 sigma.
    ringing : ndarray, shape (n, channels)
        Vibration that the model predicts around each row.
    """
    found = np.zeros(len(residual), dtype=bool)
    rows, off, usual = off_the_median(residual)
    if not len(rows):
        return found
    size = np.minimum(np.abs(off), off_the_parabolas(residual[rows]))
    limit = np.maximum(np.maximum(NOISE * noise, SPREAD * usual), NEARBY * nearby(size))
    limit[[0, 1, -2, -1]] *= AT_ENDS
    found[rows] = np.any(
        size > np.maximum(limit, RINGING * np.broadcast_to(ringing, residual.shape)[rows]), axis=1
    )
    return found


def without(record: Record, signal: Signal, rows: NDArray[np.bool_]) -> Record:
    """The record with rows of a signal lost."""
    values = np.where(rows[:, None], np.nan, record.signals[signal.name].values)
    changed = record.signals[signal.name].replace(values=values)
    return record.replace(signals={**record.signals, signal.name: changed})


def _isolated(rows: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Runs of no more than `LONGEST` rows."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], rows.astype(int), [0]])))
    found = np.zeros_like(rows)
    for first, last in edges.reshape(-1, 2):
        if last - first <= LONGEST:
            found[first:last] = True
    return found


def _removed(name: str, signal: Signal, rows: NDArray[np.bool_], values: Floats) -> Removed:
    """With the root mean square distance of `values`, all axes together, from the line through neighbours."""
    good = ~rows & np.isfinite(values).all(axis=1)
    off = [y[rows] - _line(signal.time[rows], signal.time[good], y[good]) for y in values.T]
    size = float(np.sqrt(np.nanmean(np.sum(np.square(off), axis=0))))
    return Removed(name, signal.name, tuple(map(int, np.flatnonzero(rows))), size, signal.unit)


def _line(at: Floats, time: Floats, y: Floats) -> Floats:
    """The line between neighbours; before the first and after the last the one through two of them."""
    first = np.clip(np.searchsorted(time, at) - 1, 0, len(time) - 2)
    return np.asarray(y[first] + (y[first + 1] - y[first]) * (at - time[first]) / np.diff(time)[first])


def without_rows(record: Record, name: str, rows: tuple[int, ...]) -> Record:
    """The record with rows of a signal lost, given by their numbers."""
    signal = record.signals[name]
    lost = np.zeros(len(signal), dtype=bool)
    lost[list(rows)] = True
    return without(record, signal, lost)
