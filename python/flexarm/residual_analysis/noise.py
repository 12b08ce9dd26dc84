r"""Noise of a signal estimated from its own samples.

    quiet bands   of a residual: its frequencies in 16 bands with k degrees of freedom each,
                  sigma^2 = lower quartile of their sums of squares / that of chi-square             (1)
    differences   of a drive: third differences of its samples have the variance 20 sigma^2,
                  sigma = 1.4826 median |D^3 y| / sqrt(20)                                           (2)
    repeats       of poses: the scatter of rows about the mean of their pose, pooled                 (3)

A slow residual and a vibration touch few of the bands of (1) and do not count. The strongest sines, which
leak into other bands, are removed first (orthogonal matching pursuit [Pati1993]), and so are outliers, which
spread over all of them. A residual that is fast and broad, as from impacts, does count: (1) is then more than
the noise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.comparison.bands import band_split
from flexarm.measurement.outliers import outliers
from flexarm.record import Signal
from flexarm.residual_analysis.policy import POLICY

BANDS = 16
LEAST_SAMPLES = 8 * BANDS


def exceeds_noise(squares: float, freedoms: float, false_alarm: float) -> bool:
    """Return True if a sum of squares, over their variance, exceeds the chi-square of white noise."""
    from scipy.special import chdtri

    # less than one degree of freedom spreads no wider than one whose variance is that much smaller
    scale = min(freedoms, 1.0)
    return bool(scale > 0 and squares / scale > chdtri(max(freedoms, 1.0), false_alarm))


def estimated_noise(pair: AlignedRecord, signal: Signal, residual: Floats) -> float | None:
    """Return 1 sigma of a channel by (1) or (3), from the residual; None given too few samples."""
    keep = np.isfinite(residual).all(axis=1)
    if pair.record.kind == "static":
        return repeated_noise(np.asarray(signal.pose)[keep], residual[keep])
    keep &= ~outliers(residual, pair.simulated.noise(signal))
    return quiet_band_noise(pair.simulated.instants(signal, pair.aligned.placement)[keep], residual[keep])


def quiet_band_noise(time: Floats, values: Floats) -> float | None:
    """Return 1 sigma of a channel by (1), given values of shape (n, channels)."""
    n, channels = values.shape
    if n < LEAST_SAMPLES:
        return None
    from scipy.special import chdtri

    nyquist = float(0.5 / np.median(np.diff(time)))
    values, taken = _without_sines(time, values)
    k = channels * (n - taken) / BANDS
    bands = band_split(time, values, np.linspace(0.0, nyquist, BANDS + 1).tolist())
    squares = n * np.array([band.rms**2 for band in bands])
    return float(np.sqrt(np.quantile(squares, 0.25) / chdtri(k, 0.75)))  # eq. (1)


def _without_sines(time: Floats, values: Floats, most: int = 8) -> tuple[Floats, int]:
    """Return values without their strongest sines, and the degrees of freedom taken from each channel."""
    step = float(np.median(np.diff(time)))
    place = np.round((time - time[0]) / step).astype(np.intp)
    grid = np.zeros((place[-1] + 1, values.shape[1]))
    columns, rest = np.empty((len(time), 0)), values
    for _ in range(most):
        grid[place] = rest
        powers = np.sum(np.abs(np.fft.rfft(grid, 4 * len(grid), axis=0)) ** 2, axis=1)
        peak = int(np.argmax(powers))
        if powers[peak] <= POLICY.peak_over_median * np.median(powers):
            break
        phase = np.pi * peak / (2 * len(grid)) * (time - time[0]) / step
        columns = np.column_stack([columns, np.cos(phase), np.sin(phase)])
        basis = np.linalg.qr(columns)[0]
        rest = values - basis @ (basis.T @ values)
    return rest, columns.shape[1]


def drive_noise(samples: Floats) -> float | None:
    """Return 1 sigma of evenly spaced samples of a smooth motion by (2), shape (n,)."""
    third = np.diff(samples, 3)
    third = third[np.isfinite(third)]
    if len(third) < LEAST_SAMPLES:
        return None
    return float(1.4826 * np.median(np.abs(third)) / np.sqrt(20))  # eq. (2)


def repeated_noise(pose: NDArray[np.str_], values: Floats) -> float | None:
    """Return 1 sigma of a channel by (3); None where no pose was measured twice."""
    names, number = np.unique(pose, return_inverse=True)
    freedoms = len(pose) - len(names)
    if freedoms < 1:
        return None
    count = np.bincount(number)
    means = np.stack([np.bincount(number, column) / count for column in values.T], axis=1)
    return float(np.sqrt(np.sum((values - means[number]) ** 2) / (freedoms * values.shape[1])))  # eq. (3)


def effective_samples(values: Floats) -> float:
    r"""Return the effective sample size of values, shape (n, channels).

        n_eff = n/(1 + 2 sum_k rho_k),                                                               (4)

    the autocorrelations rho_k summed up to the first that is not positive [Geyer1992].
    """
    n = len(values)
    centred = values - values.mean(axis=0) if n else values
    if n < 4 or not np.any(centred):
        return float(n)
    spectrum = np.fft.rfft(centred, 2 * n, axis=0)
    covariance = np.fft.irfft(np.sum(np.abs(spectrum) ** 2, axis=1))[:n]
    rho = covariance[1:] / covariance[0]
    ends = np.flatnonzero(rho <= 0)
    return float(n / (1 + 2 * np.sum(rho[: ends[0] if len(ends) else n])))  # eq. (4)
