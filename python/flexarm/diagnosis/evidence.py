r"""How strongly the data speak for a model, when residuals are not white and no model is perfect.

Laplace's approximation of the evidence of a model with fitted parameters z (in sigmas of their priors),

.. math:: \ln Z = -\tfrac12 \sum_c \chi_c^2 / T_c + \ln p(z) + \tfrac{k}{2} \ln 2\pi - \tfrac12 \ln |H|  (1)

with H = J^T W J + 1, J the derivatives of what unknowns leave, W = 1/T_c on the rows of channel c. T_c is
what a sample of that channel is worth less than one of white noise of the stated size: the variance of the
remainder of the best model, times its integrated correlation time,

.. math:: T_c = \max(1, \gamma_0 + 2 \sum_{l \ge 1} w_l \gamma_l)                                    (2)

(Bartlett's window w; gamma: autocovariance over the stated variance). n/T_c is the effective sample size
[Bayley1946]. A remainder that no model explains makes T large, and rivals hard to tell apart, as it should.

What is left *above the noise* in a channel, over the noise, is

.. math:: s_c^2 = \min(\gamma_0 - 1 - d_c, \max_{1 \le l \le L} |\gamma_l|)/(1 + d_c), \quad
          \text{at least } 0                                                                         (3)

with what noise of the drives and finer time steps move there, d (`diagnosis.noise_model`, `noise_model`): the
smaller one of what noise cannot be because it is too large, and because it is correlated. Poses have no order
in time, but those of one record share what the model lacks there. With gamma_0 and gamma_w the mean square
and the mean product of two different poses of a record, over all static records of a signal, n_c poses are
worth [Moulton1986]

.. math:: T_c = \max(1, \gamma_0 + (n_c - 1) \max(\gamma_w, 0))                                     (2a)

and s^2 = (gamma_0 - 1 - d)/(1 + d) of the record alone, or none where noise alone makes so large a gamma_0 of
so few poses by a chance of more than `chance` of the policy. With nothing in common every pose counts, with
all in common the record counts once.

No simulation agrees with a machine to better than a part delta of the noise, `discrepancy` of the policy, and
its error is not noise: it lasts. If two models differ by v over N samples, an error of that size along v adds
to the variance 1/W that noise and remainder have along v, so that

.. math:: \ln B = \frac{\Delta\chi^2/2}{1 + \delta^2 N_v w} + \ldots, \quad
          N_v = \frac{(\sum v^2)^2}{\sum v^4}, \quad w = \frac{v^T W v}{v^T v}                        (4)

Where finer time steps move more than that part, delta^2 is the mean square of what they move, weighed by v^2.
Models that differ by less than some 0.5 of the noise throughout are so alike, however long the record; a
difference at a few instants, or in what it asks of nominal values, counts in full.

A law that needs another one, which the model lacks, such as a backlash the spring behind it, is as likely as
that one is there: an even chance, ln 2 less, which decides nothing but ties.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import log, pi

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.generalised_least_squares import gls_estimate
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.residual_rows import Rows

Channel = tuple[str, str, int]

LAGS = 12
"""L of (3), in samples."""
WINDOW = 0.1
"""Width of Bartlett's window in (2), share of the record."""


def autocovariance(values: Floats, lags: int) -> Floats:
    """gamma_0 ... gamma_lags of values, about zero, shape (lags + 1,)."""
    n = len(values)
    size = 1 << int(np.ceil(np.log2(2 * n)))
    spectrum = np.fft.rfft(values, size)
    found: Floats = np.fft.irfft(np.abs(spectrum) ** 2, size)[: lags + 1] / n
    return found


def variance_inflation(rest: Floats, problem: Problem) -> dict[Channel, float]:
    """T_c of (2), of poses of (2a), for every channel."""
    found = _worth_of_poses(rest, problem)
    for each, where in problem.channels():
        if not _in_time(each, problem):
            continue
        values = rest[where]
        lags = max(1, int(WINDOW * len(values)))
        gamma = autocovariance(values, lags)
        window = 1.0 - np.arange(1, lags + 1) / (lags + 1)
        found[each.record, each.signal, each.channel] = max(
            1.0, float(gamma[0] + 2 * np.sum(window * gamma[1:]))
        )  # eq. (2)
    return found


def _worth_of_poses(rest: Floats, problem: Problem) -> dict[Channel, float]:
    """T_c of (2a) for the channels of static records."""
    groups: dict[tuple[str, int], dict[Channel, Floats]] = {}
    for each, where in problem.channels():
        if not _in_time(each, problem):
            key = (each.record, each.signal, each.channel)
            groups.setdefault(key[1:], {})[key] = rest[where]
    found = {}
    for records in groups.values():
        parts = list(records.values())
        squares = sum(float(part @ part) for part in parts)
        products = sum(float(part.sum()) ** 2 for part in parts) - squares
        alike = products / max(sum(len(part) * (len(part) - 1) for part in parts), 1)
        mean = squares / sum(len(part) for part in parts)
        for key, part in records.items():
            found[key] = max(1.0, mean + (len(part) - 1) * max(alike, 0.0))  # eq. (2a)
    return found


def _in_time(rows: Rows, problem: Problem) -> bool:
    """Return True if neighbouring rows follow one another in time."""
    return problem.records[rows.record].kind == "motion"


def above_noise(rest: Floats, problem: Problem, non_smooth: bool = False) -> dict[Channel, float]:
    """s_c of (3) for every channel, over the noise, of a model whose laws may have corners."""
    from scipy.special import chdtri

    found = {}
    for each, where in problem.channels():
        values, explained_square = rest[where], each.explained_square(non_smooth)
        gamma = autocovariance(values, min(LAGS, len(values) - 1))
        square = gamma[0] - 1.0 - explained_square
        if _in_time(each, problem):
            square = min(square, float(np.abs(gamma[1:]).max(initial=0.0)))  # eq. (3)
        elif len(values) * gamma[0] / (1 + explained_square) < chdtri(len(values), problem.policy.chance):
            square = 0.0
        found[each.record, each.signal, each.channel] = float(
            np.sqrt(max(square, 0.0) / (1 + explained_square))
        )
    return found


def log_bayes_factor(one: Fit, other: Fit, problem: Problem, value: Mapping[Channel, float]) -> float:
    """ln Z of one model over another one's, eq. (1) with (4)."""
    weight = _weights(problem, value)
    return log_likelihood_ratio(one, other, problem, value) + occam(one, weight) - occam(other, weight)


def log_likelihood_ratio(one: Fit, other: Fit, problem: Problem, value: Mapping[Channel, float]) -> float:
    """Return the first term of (4): how much better one model fits, whatever is plausible."""
    n, weight = len(problem), _weights(problem, value)
    (left, _), (left_by_other, _) = gls_estimate(one, weight), gls_estimate(other, weight)
    gain = weight @ (left_by_other[:n] ** 2 - left[:n] ** 2)
    v = np.abs(left[:n] - left_by_other[:n])
    spread = float(np.sum(v**2)) * float(weight @ v**2) / max(float(np.sum(v**4)), 1e-300)
    asked = float(np.sum(left_by_other[n:] ** 2) - np.sum(left[n:] ** 2))
    non_smooth = one.non_smooth or other.non_smooth
    delta = float(v**2 @ discrepancies(problem, non_smooth) ** 2) / max(float(np.sum(v**2)), 1e-300)
    return float(gain) / 2 / (1 + delta * spread) + asked / 2  # eq. (4)


def discrepancies(problem: Problem, non_smooth: bool) -> Floats:
    """delta of (4) of each row, shape (n,): what simulations err by, of laws with corners or without them."""
    found = np.empty(len(problem))
    for each, where in problem.channels():
        error = float(np.sqrt(each.discretisation_error)) if non_smooth else 0.0
        found[where] = max(problem.policy.discrepancy, error)
    return found


def _weights(problem: Problem, value: Mapping[Channel, float]) -> Floats:
    """W of (1), shape (n,)."""
    weight = np.ones(len(problem))
    for each, where in problem.channels():
        weight[where] = 1.0 / value[each.record, each.signal, each.channel]
    return weight


def occam(fit: Fit, weight: Floats) -> float:
    """Return what the parameters cost: all terms of (1) but the first; and what effects need.

    Unknowns that were eliminated cost theirs too: an effect at a clock or frame takes the place of some.
    """
    cost = _eliminated(fit, weight)
    k = len(fit.z)
    if k == 0:
        return -cost
    needed = {(n.name, n.at) for m in fit.members if (n := m.needs) is not None}
    jacobian = fit.projection.project(fit.jacobian)
    weights = np.concatenate([weight, np.ones(len(jacobian) - len(weight))])
    hessian = jacobian.T @ (weights[:, None] * jacobian) + np.eye(k)
    prior = sum(
        c.log_density(float(z)) for c, z in zip(fit.parameters, gls_estimate(fit, weight)[1], strict=True)
    )
    laplace = k / 2 * log(2 * pi) - float(np.linalg.slogdet(hessian)[1]) / 2
    return prior + laplace - len(needed - set(fit.places)) * log(2) - cost


def _eliminated(fit: Fit, weight: Floats) -> float:
    """ln|H|/2 of (1) for clocks, frames and nominal values, in their sigmas; none without a prior."""
    known = np.isfinite(fit.projection.sigma)
    jacobian = fit.projection.jacobian[:, known] * fit.projection.sigma[known]
    hessian = jacobian.T @ (weight[:, None] * jacobian) + np.eye(jacobian.shape[1])
    return float(np.linalg.slogdet(hessian)[1]) / 2
