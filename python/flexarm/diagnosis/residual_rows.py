"""Rows of a residual: the values of a record that are evidence, over their noise.

    r_i = (y_i - f_i)/sigma                                                                            (1)

A channel of a signal gives a row for every finite value y while all drives are known. sigma is the stated
noise or, where a motion states none, a robust estimate from second differences, which a smooth motion hardly
has: the variance of r_(i-1) - 2 r_i + r_(i+1) is six times that of white r,

    sigma = median |r_(i-1) - 2 r_i + r_(i+1)| / (0.6745 sqrt 6).                                      (2)

The noise of poses is the scatter of rows of one pose (`noise`); without such rows it has to be stated.

Predictions of non-smooth laws have ripples, so that small steps tell little of large ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.errors import InvalidParameter
from flexarm.record import Record, Signal
from flexarm.residual_analysis.noise_floor import repeated_noise


def is_non_smooth(arm: Arm) -> bool:
    """Return True if a model has a law with a corner."""
    return not all(effect.smooth for effect in arm.effects)


REPEATS = 6
"""Least rows beyond one a pose that show the noise: of two channels to a fifth."""
ROUNDING = 1e-12
"""Scatter over the greatest reading that is rounding."""


@dataclass(frozen=True, eq=False)
class Rows:
    """The rows of (1) that belong to one channel of one signal of one record.

    Attributes
    ----------
    record, signal : str
        Names.
    channel : int
        Of the signal.
    where : slice
        In the vector.
    kept : ndarray of bool, shape (n,)
        Rows of the signal that are in it.
    sigma : float
        1 sigma of the noise [SI].
    time : ndarray
        Instants of the kept rows by the drive's clock [s], or numbers of poses.
    input_noise : float
        Mean square, over sigma^2, of what noise of the drives moves there (`noise_model`).
    discretisation_error : float
        The same of what finer time steps still move of models whose laws have corners (`noise_model`).
    """

    record: str
    signal: str
    channel: int
    where: slice
    kept: NDArray[np.bool_]
    sigma: float
    time: Floats
    input_noise: float = 0.0
    discretisation_error: float = 0.0

    def explained_square(self, non_smooth: bool) -> float:
        """Mean square, over sigma^2, of what the right model leaves there beside noise.

        `corners` tells whether its laws have some.
        """
        return self.input_noise + (self.discretisation_error if non_smooth else 0.0)


def evidence_rows(name: str, pair: SimulatedRecord, placement: Placement, start: int) -> Iterator[Rows]:
    """Rows of all channels of a record, beside any simulation; the first one is `start` of the residual.

    Raises
    ------
    InvalidParameter
        If the noise of poses is neither stated nor shown.
    """
    for signal in pair.evidence.values():
        for each in _channels(name, pair, placement, signal, start):
            yield each
            start = each.where.stop


def _channels(
    name: str, pair: SimulatedRecord, placement: Placement, signal: Signal, start: int
) -> Iterator[Rows]:
    residual = pair.residual(signal, placement, hold=True)
    noise = pair.noise(signal)
    if pair.record.kind == "static" and not noise.all():
        noise = np.where(noise > 0, noise, noise_of_poses(name, signal, residual))
    instants = pair.instants(signal, placement)
    driven = instants <= _last_drive(pair.record) + 1e-9
    for channel in range(residual.shape[1]):
        kept = np.isfinite(residual[:, channel]) & driven
        count = int(kept.sum())
        if count == 0:
            continue
        sigma = float(noise[channel]) or shown_noise(residual[kept, channel])
        if sigma > 0:
            yield Rows(name, signal.name, channel, slice(start, start + count), kept, sigma, instants[kept])
            start += count


def rows_left(rows: Iterable[Rows], out: NDArray[np.bool_]) -> Iterator[Rows]:
    """Rows without those of a mask over all of them, in a residual that is shorter by these."""
    start = 0
    for each in rows:
        left = ~out[each.where]
        kept = each.kept.copy()
        kept[np.flatnonzero(kept)] = left
        stop = start + int(left.sum())
        if stop > start:
            yield replace(each, where=slice(start, stop), kept=kept, time=each.time[left])
        start = stop


def _last_drive(record: Record) -> float:
    """Last instant at which all drives are known."""
    if record.kind == "static" or not record.drive:
        return float(np.inf)
    return min(float(record.signals[drive].time[-1]) for drive in record.drive)


def noise_of_poses(name: str, signal: Signal, residual: Floats) -> float:
    """1 sigma of each channel of a signal of a record, from rows of one pose.

    Raises
    ------
    InvalidParameter
        If these are too few, or all alike.
    """
    known = np.isfinite(residual).all(axis=1)
    pose = np.asarray(signal.pose)[known]
    repeats = len(pose) - len(np.unique(pose))
    sigma = repeated_noise(pose, residual[known]) if repeats >= REPEATS else None
    if sigma is None or sigma < ROUNDING * np.nanmax(np.abs(signal.values)):
        raise InvalidParameter(
            f"state noise_std above zero; of poses only rows that repeat one would show it, needed are "
            f"{REPEATS} that are not all alike, got {repeats}",
            where=f"records.{name}.signals.{signal.name}",
        )
    return sigma


def shown_noise(residual: Floats) -> float:
    """Eq. (2); zero of too few values."""
    if len(residual) < 8:
        return 0.0
    return float(1.4826 * np.median(np.abs(np.diff(residual, 2))) / np.sqrt(6.0))  # eq. (2)


def put_over_noise(found: Floats, rows: Iterable[Rows], values: Callable[[str], Floats]) -> None:
    """Write eq. (1) into some rows of a residual, or derivatives of it, from the values of each signal."""
    by_signal: dict[str, Floats] = {}
    for each in rows:
        if each.signal not in by_signal:
            by_signal[each.signal] = values(each.signal)
        found[each.where] = by_signal[each.signal][each.kept, each.channel] / each.sigma  # eq. (1)
