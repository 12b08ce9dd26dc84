r"""Model discrepancy: the residual beyond noise, as a stationary process of each channel.

The residual of a channel, over the stated noise, has the covariance

.. math:: C = r I + s^2 K, \quad r = 1 + d,                                                            (1)

with d what noise of drives and finer time steps move there (`diagnosis.noise_model`). Size s and correlation
length of the process are estimated for each model by maximum likelihood. In time it is an Ornstein-Uhlenbeck
process, K_ij = exp(-|i - j|/L). Its likelihood comes from a Kalman filter of one state, whose innovations
over their deviation are white [Kalman1960]:

.. math:: e_t = y_t - \hat x_t, \quad V_t = P_t + r, \quad
          \hat x_{t+1} = \phi (\hat x_t + P_t e_t/V_t), \quad
          P_{t+1} = \phi^2 P_t r/V_t + s^2 (1 - \phi^2), \quad \phi = e^{-1/L}                         (2)

Pauses restart the filter. s and L maximise Whittle's likelihood of the periodogram [Whittle1953] times a
prior,

.. math:: \ln p = -\tfrac12 \sum_k (\ln S_k + I_k/S_k) - \tfrac12 \ln(1 + s^2/r), \quad
          S_k = r + s^2 \frac{1 - \phi^2}{1 - 2 \phi \cos \omega_k + \phi^2}                           (3)

The prior of s is a half-Cauchy one of the noise's scale [Gelman2006], times the width of what data leave of
it, which grows with s: a model that needs a discrepancy of s times the noise is less likely by that factor.
What lasts longer than a tenth of a record is no discrepancy: an offset or a drift is an effect.

Poses have no order in time: there K_ij = exp(-|a_i - a_j|^2/(2 L^2)) with a the joints' angles over their
spread, L a part of it, and one eigendecomposition of K whitens all models [Rasmussen2006].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.diagnosis.policy import NOISE_MODEL
from flexarm.filters import recursive_filter
from flexarm.record import Record


@dataclass(frozen=True, eq=False)
class TimeDiscrepancy:
    """Eq. (1) of a channel in time."""

    stretches: Sequence[slice]
    """Rows between pauses."""
    noise: float
    size: float = 0.0
    """r and s^2 of (1), over the stated variance."""
    length: float = 0.0
    """L [samples]; 0 without a discrepancy."""

    @property
    def _phi(self) -> float:
        return float(np.exp(-1.0 / self.length)) if self.length > 0 else 0.0

    @cached_property
    def gains(self) -> tuple[Floats, Floats]:
        """V_t of (2) and P_t/V_t of the first samples of a stretch, the last one for all others."""
        variance, gain = np.empty(NOISE_MODEL.transient + 1), np.empty(NOISE_MODEL.transient + 1)
        phi, predicted = self._phi, self.size
        fresh = self.size * (1 - phi**2)
        for t in range(NOISE_MODEL.transient):
            variance[t] = predicted + self.noise
            gain[t] = predicted / variance[t]
            predicted = phi**2 * predicted * self.noise / variance[t] + fresh  # eq. (2)
        half = (self.noise * (1 - phi**2) - fresh) / 2
        steady = -half + np.sqrt(half**2 + fresh * self.noise)
        variance[-1], gain[-1] = steady + self.noise, steady / (steady + self.noise)
        return variance, gain

    def whitened(self, values: Floats) -> Floats:
        """Return innovations over their deviation, of values of shape (n, ...)."""
        found: Floats = values / np.sqrt(self.noise)
        if self.size == 0:
            return found
        for rows in self.stretches:
            found[rows] = self._filtered(values[rows])
        return found

    def _filtered(self, values: Floats) -> Floats:
        variance, gain = self.gains
        phi, found = self._phi, np.empty_like(values)
        state = np.zeros(values.shape[1:])
        for t in range(min(NOISE_MODEL.transient, len(values))):
            error = values[t] - state
            found[t] = error / np.sqrt(variance[t])
            state = phi * (state + gain[t] * error)  # eq. (2)
        if len(values) > NOISE_MODEL.transient:
            fresh = values[NOISE_MODEL.transient :] - phi * values[NOISE_MODEL.transient - 1 : -1]
            fresh[0] = values[NOISE_MODEL.transient] - state
            rest = recursive_filter(fresh, np.array([1.0, -phi * (1 - gain[-1])]))
            found[NOISE_MODEL.transient :] = rest / np.sqrt(variance[-1])
        return found

    def times(self, values: Floats) -> Floats:
        """Return C times values of shape (n, ...)."""
        found: Floats = self.noise * values
        if self.size > 0:
            poles = np.array([1.0, -self._phi])
            for rows in self.stretches:  # K decays after each sample, and before it
                after = recursive_filter(values[rows], poles)
                before = recursive_filter(values[rows][::-1], poles)[::-1]
                found[rows] += self.size * (after + before - values[rows])
        return found

    @property
    def log_prior(self) -> float:
        """Logarithm of the prior of s, at most 0."""
        return float(log_prior(self.size / self.noise))

    @property
    def log_determinant(self) -> float:
        """ln |C|."""
        if self.size == 0:
            return float(np.log(self.noise) * sum(rows.stop - rows.start for rows in self.stretches))
        variance = np.log(self.gains[0])
        counts = [rows.stop - rows.start for rows in self.stretches]
        return float(
            sum(
                variance[: min(n, NOISE_MODEL.transient)].sum()
                + max(n - NOISE_MODEL.transient, 0) * variance[-1]
                for n in counts
            )
        )


@dataclass(frozen=True, eq=False)
class PoseDiscrepancy:
    """Eq. (1) of a channel of poses."""

    vectors: Floats
    variances: Floats
    """Eigenvectors and eigenvalues of C. Shape (n, n) and (n,)."""
    log_prior: float = 0.0
    """Logarithm of the prior of s, at most 0."""

    def whitened(self, values: Floats) -> Floats:
        """Return values of shape (n, ...) in directions of their own, over their deviation."""
        turned = self.vectors.T @ values
        return (turned.T / np.sqrt(self.variances)).T

    def times(self, values: Floats) -> Floats:
        """Return C times values of shape (n, ...)."""
        return self.vectors @ ((self.vectors.T @ values).T * self.variances).T

    @property
    def log_determinant(self) -> float:
        """ln |C|."""
        return float(np.log(self.variances).sum())


Discrepancy = TimeDiscrepancy | PoseDiscrepancy


def log_prior(square: Any) -> Any:
    """Return the last term of (3) for s^2/r."""
    return -0.5 * np.log1p(square)


def stretches(time: Floats) -> list[slice]:
    """Return the rows between pauses of a record."""
    steps = np.diff(time)
    ends = (
        np.flatnonzero(steps > NOISE_MODEL.pause * np.median(steps)) + 1
        if len(steps)
        else np.empty(0, dtype=int)
    )
    edges = [0, *ends.tolist(), len(time)]
    return [slice(a, b) for a, b in pairwise(edges)]


def in_time(rest: Floats, time: Floats, noise: float) -> TimeDiscrepancy:
    """Return the most probable discrepancy of a channel in time, by (3)."""
    bands = Bands(len(rest))
    power = bands.squares(rest) / bands.count
    sizes = noise * np.geomspace(1e-3, max(10.0 * float(np.mean(rest**2)) / noise, 1.0), 60)
    density = noise + sizes[:, None, None] * bands.spectra  # eq. (3)
    likely = -0.5 * ((np.log(density) + power / density) @ bands.count) + log_prior(sizes / noise)[:, None]
    nothing = -0.5 * float((np.log(noise) + power / noise) @ bands.count)
    i, j = np.unravel_index(int(np.argmax(likely)), likely.shape)
    there = stretches(time)
    if likely[i, j] <= nothing:
        return TimeDiscrepancy(there, noise)
    return TimeDiscrepancy(there, noise, float(sizes[i]), float(bands.lengths[j]))


class Bands:
    """Bands of frequency of n samples in which periodograms are summed."""

    def __init__(self, n: int) -> None:
        self.samples = n
        edges = np.unique(np.geomspace(1, n // 2 + 1, NOISE_MODEL.bins).astype(int))
        self.starts = np.concatenate([[0], edges[:-1]]) if len(edges) > 1 else np.array([0])
        values = np.full(n // 2 + 1, 2.0)
        values[0] = 1.0
        if n % 2 == 0:
            values[-1] = 1.0
        self.values = values
        """Of the transform at each frequency, real and imaginary ones."""
        self.count = np.add.reduceat(values, self.starts)
        """The same of each band."""

    @property
    def lengths(self) -> Floats:
        """Return L of a discrepancy that is none of longer lengths [samples]."""
        longest = max(NOISE_MODEL.longest * self.samples, 2.0)
        return np.geomspace(1.0, longest, max(int(3 * np.log(longest)), 2))

    @property
    def spectra(self) -> Floats:
        """Return the factor of s^2 in (3), shape (lengths, bands)."""
        omega = 2 * np.pi * np.arange(len(self.values)) / self.samples
        omega = np.add.reduceat(self.values * omega, self.starts) / self.count
        phi = np.exp(-1.0 / self.lengths)[:, None]
        return np.asarray((1 - phi**2) / (1 - 2 * phi * np.cos(omega) + phi**2))

    def squares(self, values: Floats) -> Floats:
        """Return the sum of I_k in each band, of values of shape (n, ...) the sum over their columns."""
        columns = values.reshape(self.samples, -1)
        power = np.sum(np.abs(np.fft.rfft(columns, axis=0)) ** 2, axis=1) / self.samples
        return np.asarray(np.add.reduceat(self.values * power, self.starts))

    def filtered(self, values: Floats, factors: Floats) -> Floats:
        """Return values of shape (n, ...) whose transform is multiplied by a factor in each band."""
        of_each = np.repeat(factors, np.diff(self.starts, append=len(self.values)))
        shape = (-1, *[1] * (values.ndim - 1))
        transform = np.fft.rfft(values, axis=0) * of_each.reshape(shape)
        return np.asarray(np.fft.irfft(transform, self.samples, axis=0))


def angles_of_poses(record: Record, pose: NDArray[Any]) -> Floats:
    """Return the drive angles of a static record in given poses, shape (n, drives)."""
    found = np.zeros((len(pose), len(record.drive)))
    for column, name in zip(found.T, record.drive, strict=True):
        drive = record.signals[name]
        known = dict(zip(np.asarray(drive.pose).tolist(), drive.values[:, 0].tolist(), strict=True))
        column[:] = [known.get(each, np.nan) for each in pose.tolist()]
    return np.nan_to_num(found)


def pose_kernels(angles: Floats) -> list[tuple[Floats, Floats]]:
    """Return eigenvalues and eigenvectors of K for each of `NOISE_MODEL.pose_lengths`, from angles of shape
    (n, joints).
    """
    spread = angles.std(axis=0)
    scaled = (angles - angles.mean(axis=0))[:, spread > 0] / spread[spread > 0]
    square = np.sum((scaled[:, None] - scaled[None]) ** 2, axis=2) / max(scaled.shape[1], 1)
    found = []
    for length in NOISE_MODEL.pose_lengths:
        values, vectors = np.linalg.eigh(np.exp(-square / (2 * length**2)))
        found.append((np.maximum(values, 0.0), vectors))
    return found


def of_poses(rest: Floats, kernels: Sequence[tuple[Floats, Floats]], noise: float) -> PoseDiscrepancy:
    """Return the most probable discrepancy of a channel of poses."""
    sizes = noise * np.concatenate([[0.0], np.geomspace(1e-3, max(10 * float(np.mean(rest**2)), 1.0), 60)])
    best = None
    for values, vectors in kernels:
        variances = noise + sizes[:, None] * values
        prior = log_prior(sizes / noise)
        likely = prior - 0.5 * np.sum(np.log(variances) + (vectors.T @ rest) ** 2 / variances, axis=1)
        k = int(np.argmax(likely))
        if best is None or likely[k] > best[0]:
            best = (float(likely[k]), PoseDiscrepancy(vectors, variances[k], float(prior[k])))
    assert best is not None
    return best[1]
