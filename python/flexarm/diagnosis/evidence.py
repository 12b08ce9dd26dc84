r"""Evidence of models whose residuals are noise and a model discrepancy.

Laplace's approximation of the evidence of a model with fitted parameters z (in sigmas of their priors) and
nuisance parameters x,

.. math:: \ln Z = -\tfrac12 \left( r^T C^{-1} r + \ln |C| + |x/\sigma|^2 \right) + \ln p(z)
          + \tfrac{k}{2} \ln 2\pi - \tfrac12 \ln |H|,  \quad  H = J^T C^{-1} J + 1                     (1)

with r the residual over the noise, J the derivatives of what nuisance parameters leave, and C the covariance
of noise and discrepancy (`diagnosis.discrepancy`). Each model has the discrepancy that makes it most likely:
a model that leaves a gap may call it an error of its own, and pays for that with ln|C| and a small r C^-1 r
elsewhere. Fits weight rows by the stated noise; (1) is taken at its own optimum, to first order.

What is left *above the noise* in a channel, over the noise, is

.. math:: s_c^2 = \min(\gamma_0 - 1 - d_c, \max_{1 \le l \le L} |\gamma_l|)/(1 + d_c), \quad
          \text{at least } 0                                                                         (2)

with the autocovariance gamma and what noise of the drives and finer time steps move there, d
(`diagnosis.noise_model`): the smaller one of what noise cannot be because it is too large, and because it is
correlated. Poses have no order in time; there s^2 = (gamma_0 - 1 - d)/(1 + d), or none where noise alone
makes so large a gamma_0 of so few poses by a chance of more than `chance` of the policy.

No simulation agrees with a machine to better than a part delta of the noise, `discrepancy` of the policy. Its
error may lie along the difference v of two models, over N samples. Such an error adds to C of both models
before they are compared,

.. math:: c v v^T, \quad c = \delta^2 N_v/v^T v, \quad N_v = \frac{(\sum v^2)^2}{\sum v^4}               (3)

Where finer time steps move more than that part, delta^2 is the mean square of what they move, weighted by
v^2. Models that differ by less than some 0.5 of the noise throughout are so alike, however long the record; a
difference at a few instants, or in what it asks of nominal values, counts in full.

A law may require another one that the model lacks, as a backlash requires a spring. The prior odds of that
one are even, ln 2 less, which decides nothing but ties.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import log, pi

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.discrepancy import Discrepancy, in_time, of_poses
from flexarm.diagnosis.fit import Fit, gls_step
from flexarm.diagnosis.policy import NOISE_MODEL
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.residual_rows import Rows

Channel = tuple[str, str, int]


def autocovariance(values: Floats, lags: int) -> Floats:
    """gamma_0 ... gamma_lags of values, about zero, shape (lags + 1,)."""
    n = len(values)
    size = 1 << int(np.ceil(np.log2(2 * n)))
    spectrum = np.fft.rfft(values, size)
    return np.fft.irfft(np.abs(spectrum) ** 2, size)[: lags + 1] / n


def is_in_time(rows: Rows, problem: Problem) -> bool:
    """Return True if neighbouring rows follow one another in time."""
    return problem.records[rows.record].kind == "motion"


def above_noise(rest: Floats, problem: Problem, non_smooth: bool = False) -> dict[Channel, float]:
    """Return s_c of (2) for every channel, over the noise, of a smooth or non-smooth model."""
    from scipy.special import chdtri

    found = {}
    for each, where in problem.channels():
        values, explained_square = rest[where], each.explained_square(non_smooth)
        gamma = autocovariance(values, min(NOISE_MODEL.lags, len(values) - 1))
        square = gamma[0] - 1.0 - explained_square
        if is_in_time(each, problem):
            square = min(square, float(np.abs(gamma[1:]).max(initial=0.0)))  # eq. (2)
        elif len(values) * gamma[0] / (1 + explained_square) < chdtri(len(values), problem.policy.chance):
            square = 0.0
        found[each.record, each.signal, each.channel] = float(
            np.sqrt(max(square, 0.0) / (1 + explained_square))
        )
    return found


@dataclass(frozen=True, eq=False)
class Evidence:
    """Eq. (1) of a fit, in parts."""

    discrepancies: tuple[Discrepancy, ...]
    """C of each channel."""
    left: Floats
    """r at the optimum of (1). Shape (n,)."""
    log_likelihood: float
    """-(r C^-1 r + ln|C|)/2, and the priors of the discrepancies."""
    pulls: float
    """|x/sigma|^2/2 of nuisance parameters."""
    occam: float
    """The other terms: priors and ln|H|, and what effects need."""

    def with_error(self, v: Floats, c: float, problem: Problem) -> float:
        """Return the log likelihood where c v v^T adds to C (matrix determinant lemma)."""
        white = whitened(np.column_stack([v, self.left]), problem, self.discrepancies)
        along, square = float(white[:, 0] @ white[:, 1]), float(white[:, 0] @ white[:, 0])
        return self.log_likelihood + (c * along**2 / (1 + c * square) - log(1 + c * square)) / 2

    def covariance_times(self, values: Floats, problem: Problem) -> Floats:
        """Return C times values of shape (n, ...)."""
        return _by_channel(lambda each, rows: each.times(rows), values, problem, self.discrepancies)


def whitened(values: Floats, problem: Problem, discrepancies: tuple[Discrepancy, ...]) -> Floats:
    """Return the root of C^-1 times values of shape (n, ...)."""
    return _by_channel(lambda each, rows: each.whitened(rows), values, problem, discrepancies)


def _by_channel(
    product: Callable[[Discrepancy, Floats], Floats],
    values: Floats,
    problem: Problem,
    discrepancies: tuple[Discrepancy, ...],
) -> Floats:
    """Return values of shape (n, ...), those of each channel by the product with its discrepancy."""
    found = np.empty_like(values)
    for (_, where), each in zip(problem.channels(), discrepancies, strict=True):
        found[where] = product(each, values[where])
    return found


def discrepancies_of(rest: Floats, problem: Problem, non_smooth: bool) -> tuple[Discrepancy, ...]:
    """Return the most likely discrepancy of each channel of a residual of shape (n,)."""
    found: list[Discrepancy] = []
    for each, where in problem.channels():
        noise = 1.0 + each.explained_square(non_smooth)
        if is_in_time(each, problem):
            found.append(in_time(rest[where], each.time, noise))
        else:
            found.append(of_poses(rest[where], problem.pose_kernels(each), noise))
    return tuple(found)


def evidence_of(fit: Fit, problem: Problem) -> Evidence:
    """Return eq. (1) of a fit; computed once for each state of the noise."""
    kept: tuple[object, Evidence] | None = problem.evidence.get(fit)
    if kept is not None and kept[0] is problem.rows:
        return kept[1]
    n, k = len(problem), len(fit.z)
    discrepancies = discrepancies_of(fit.projected[:n], problem, fit.non_smooth)
    jacobian = np.column_stack([fit.jacobian, fit.projection.jacobian])
    rows = whitened(np.column_stack([jacobian, fit.residual]), problem, discrepancies)
    step = gls_step(fit, rows[:, :-1], rows[:, -1])
    left = fit.projected[:n] + jacobian @ step
    pulls = fit.projected[n:] + step[k:] / fit.projection.sigma
    white = whitened(left, problem, discrepancies)
    determinant = sum(each.log_determinant - 2 * each.log_prior for each in discrepancies)
    found = Evidence(
        discrepancies,
        left,
        -(float(white @ white) + determinant) / 2,
        float(pulls @ pulls) / 2,
        occam(fit, rows[:, :-1], fit.z + step[:k]),
    )
    problem.evidence[fit] = (problem.rows, found)
    return found


def explained_share(fit: Fit, fewer: Fit, problem: Problem) -> float:
    """Return the coefficient of partial determination of what a model has and another one lacks.

    Mean squares above the noise are summed over the channels, each weighted by the squared difference of the
    two models there.
    """
    left, before = 0.0, 0.0
    for each, where in problem.channels():
        noise = 1.0 + each.explained_square(fit.non_smooth)
        weight = float(np.sum((fit.projected[where] - fewer.projected[where]) ** 2))
        left += weight * max(float(np.mean(fit.projected[where] ** 2)) - noise, 0.0)
        before += weight * max(float(np.mean(fewer.projected[where] ** 2)) - noise, 0.0)
    return max(1.0 - left / before, 0.0) if before > 0 else 1.0


def log_bayes_factor(one: Fit, other: Fit, problem: Problem) -> float:
    """Return ln B of one model over another one, eq. (1) with (3)."""
    first, second = evidence_of(one, problem), evidence_of(other, problem)
    return log_likelihood_ratio(one, other, problem) + first.occam - second.occam


def log_likelihood_ratio(one: Fit, other: Fit, problem: Problem) -> float:
    """Return the same without Occam factors."""
    first, second = evidence_of(one, problem), evidence_of(other, problem)
    v = first.left - second.left
    errors = simulation_errors(problem, one.non_smooth or other.non_smooth)
    fourth = max(float(np.sum(v**4)), 1e-300)
    c = float(v**2 @ errors**2) / fourth  # eq. (3), delta^2 weighted by v^2
    gain = first.with_error(v, c, problem) - second.with_error(v, c, problem)
    return gain + second.pulls - first.pulls


def simulation_errors(problem: Problem, non_smooth: bool) -> Floats:
    """Return delta of (3), the error of the simulation in each row, shape (n,)."""
    found = np.empty(len(problem))
    for each, where in problem.channels():
        error = float(np.sqrt(each.discretisation_error)) if non_smooth else 0.0
        found[where] = max(problem.policy.discrepancy, error)
    return found


def occam(fit: Fit, jacobian: Floats, z: Floats) -> float:
    """Return the Occam factor: all terms of (1) but the first, and the prior odds of required effects.

    `jacobian` holds whitened derivatives with respect to effects and nuisance parameters. The latter count
    too, as an effect at a clock or frame replaces some.
    """
    k, sigma = len(fit.z), fit.projection.sigma
    known = np.isfinite(sigma)
    scale = np.where(known, sigma, 1.0 / np.maximum(np.linalg.norm(jacobian[:, k:], axis=0), 1e-300))
    own = jacobian[:, k:] * scale
    cost = _log_determinant(own[:, known].T @ own[:, known] + np.eye(int(known.sum()))) / 2
    if k == 0:
        return -cost
    joined = np.column_stack([jacobian[:, :k], own])
    hessian = joined.T @ joined + np.diag(np.concatenate([np.ones(k), known]))
    eliminated = _log_determinant(own.T @ own + np.diag(known.astype(float)))
    needed = {(n.name, n.at) for m in fit.members if (n := m.needs) is not None}
    prior = sum(c.log_density(float(x)) for c, x in zip(fit.parameters, z, strict=True))
    laplace = k / 2 * log(2 * pi) - (_log_determinant(hessian) - eliminated) / 2
    families = sum(member.hyperprior_log_evidence for member in fit.members)
    return prior + laplace + families - len(needed - fit.spots) * log(2) - cost


def _log_determinant(matrix: Floats) -> float:
    return float(np.linalg.slogdet(matrix)[1])
