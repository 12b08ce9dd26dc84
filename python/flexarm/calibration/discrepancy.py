r"""Model discrepancy of a calibration: a process of each channel, integrated over its size and length.

The residual of a channel over its noise has independent values at frequencies of its Fourier transform F
(motions), or along eigenvectors of a kernel (poses). They have the variances

.. math:: S_f = r + S_{in,f} + s^2 k_f(L)                                                             (1)

of noise, input noise and discrepancy (`diagnosis.discrepancy`). S_in is the mean periodogram of draws of
input noise (`diagnosis.noise_model`). Given the squares I_f of these values,

.. math:: p(s, L \mid I) \propto p(s) \, p(L) \exp \Big( -\tfrac12 \sum_f (\ln S_f + I_f/S_f) \Big)    (2)

with a half-Cauchy prior of s of the noise's scale [Gelman2006] and all lengths alike. A fit hides from its
residual what an error has in common with the derivatives J. Its expectation is known,

.. math:: I_f = |F r|_f^2 + \sum_k |F J R_k|_f^2, \quad R R^T = H^{-1}                                 (3)

Errors have the covariance C, beside those of input noise, and rows the weights W,

.. math:: C = F^* \left( \frac{1}{E[1/S]} - S_{in} \right) F, \quad
          W = F^* \frac{1}{\lambda + S_{in}} F                                                         (4)

with lambda the variance by C of the mean of n values times n. Frequencies at which a discrepancy is small get
no greater weights: a gap is not like the process in all. No size of an error is assumed: of each length
remain the sizes that data would not show.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import Protocol

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.discrepancy import Bands
from flexarm.diagnosis.evidence import is_in_time
from flexarm.diagnosis.problem import Problem

SQUARES = np.concatenate([[0.0], np.geomspace(1e-3, 1e8, 60)])
"""s^2/r of (1)."""


Product = Callable[[Floats], Floats]
"""A matrix times values of shape (n, ...)."""


class Transform(Protocol):
    """F of (1)."""

    samples: int

    def squares(self, values: Floats) -> Floats:
        """Return I of (2), summed over columns of values of shape (n, ...)."""

    def product(self, factors: Floats) -> Product:
        """Return the product of F^* factors F with values."""


class OfMotion(Bands):
    """Bands of the Fourier transform of a channel in time."""

    def product(self, factors: Floats) -> Product:
        """Return the product of F^* factors F with values."""
        return lambda values: self.filtered(values, factors)


class OfPoses:
    """Eigenvectors of the kernels of all lengths, in one row."""

    def __init__(self, kernels: Sequence[tuple[Floats, Floats]]) -> None:
        self.vectors = np.hstack([vectors for _, vectors in kernels])
        self.samples = len(self.vectors)

    def squares(self, values: Floats) -> Floats:
        """Return I of (2), summed over columns of values of shape (n, ...)."""
        turned = self.vectors.T @ values
        return np.asarray(np.sum(turned.reshape(len(turned), -1) ** 2, axis=1))

    def product(self, factors: Floats) -> Product:
        """Return the product of F^* factors F with values."""
        matrix = (self.vectors * factors) @ self.vectors.T
        return lambda values: np.asarray(matrix @ values)


@dataclass(frozen=True, eq=False)
class Channel:
    """Eq. (2) of one channel for h sizes and lengths and m values."""

    transform: Transform
    variance: Floats
    """S of (1), shape (h, m)."""
    input_variance: Floats
    """S_in of (1), shape (m,)."""
    log_prior: Floats
    """Logarithm of p(s) p(L), shape (h,)."""
    belongs: Floats
    """One where a value is one of a size and length, else zero, shape (h, m)."""
    count: Floats
    """Numbers of values with these variances, shape (m,)."""

    @classmethod
    def of_motion(cls, n: int, noise: float, input_errors: Floats, white: bool = False) -> Channel:
        """Return the channel of a motion; input_errors are draws, shape (k, n)."""
        bands = OfMotion(n)
        shapes = np.ones((1, len(bands.count))) if white else bands.spectra
        of_input = bands.squares(input_errors.T) / bands.count / max(len(input_errors), 1)
        variance = noise * (1 + SQUARES * shapes[..., None]) + of_input[:, None]
        variance = np.moveaxis(variance, 1, 2).reshape(-1, len(bands.count))
        prior = log_prior(len(shapes))
        return cls(bands, variance, of_input, prior, np.ones_like(variance), bands.count)

    @classmethod
    def of_poses(cls, kernels: Sequence[tuple[Floats, Floats]], noise: float, white: bool = False) -> Channel:
        """Return the channel of poses with these eigenvalues and eigenvectors of kernels."""
        if white:
            kernels = [(np.ones_like(values), vectors) for values, vectors in kernels[:1]]
        values = np.hstack([values for values, _ in kernels])
        belongs = np.repeat(np.eye(len(kernels)), len(SQUARES), axis=0)
        belongs = np.repeat(belongs, len(kernels[0][0]), axis=1)
        variance = noise * (1 + np.tile(SQUARES, len(kernels))[:, None] * values)
        prior = log_prior(len(kernels))
        return cls(OfPoses(kernels), variance, np.zeros(len(values)), prior, belongs, np.ones(len(values)))

    @cached_property
    def _constant(self) -> Floats:
        """Return ln p(s) p(L) - ln|S|/2, shape (h,)."""
        return np.asarray(self.log_prior - (self.belongs * np.log(self.variance)) @ self.count / 2)

    def process(self, squares: Floats) -> Process:
        """Return the expectations of (4)."""
        from scipy.special import softmax

        log_posterior = self._constant - (self.belongs / self.variance) @ squares / 2  # eq. (2)
        weight = softmax(log_posterior)[:, None] * self.belongs
        own = np.sum(weight, axis=0) ** 2 / np.sum(weight / self.variance, axis=0) - self.input_variance
        times, ones = self.transform.product(own), np.ones(self.transform.samples)
        level = float(np.mean(times(ones)))
        root = np.sum(weight, axis=0) / np.sqrt(level + self.input_variance)
        return Process(self.transform.product(root), times, level)


@dataclass(frozen=True, eq=False)
class Process:
    """Expectations (4) of a channel."""

    root: Product
    """The root of W times values."""
    times: Product
    """C times values."""
    level: float
    """lambda of (4)."""


def log_prior(lengths: int) -> Floats:
    """Return ln p(s) p(L) of all sizes for each length."""
    edges = np.concatenate([[0.0], SQUARES[1:2] / 2, np.sqrt(SQUARES[1:-1] * SQUARES[2:]), [np.inf]])
    share = np.diff(np.arctan(np.sqrt(edges))) * 2 / pi
    return np.tile(np.log(share / lengths), lengths)


def channels_of(
    problem: Problem, non_smooth: bool, input_errors: Floats, white: bool = False
) -> tuple[Channel, ...]:
    """Return the channels of a problem; input_errors are draws of input noise, shape (draws, n);
    a white discrepancy has no correlation.
    """
    found = []
    for each, where in problem.channels():
        noise = 1.0 + each.explained_square(non_smooth)
        if is_in_time(each, problem):
            errors = input_errors[:, where]
            found.append(Channel.of_motion(errors.shape[1], noise - each.input_noise, errors, white))
        else:
            found.append(Channel.of_poses(problem.pose_kernels(each), noise, white))
    return tuple(found)
