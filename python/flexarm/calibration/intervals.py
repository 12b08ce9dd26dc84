r"""Intervals of parameters in whose logarithm u a model is curved.

Data tell a spring's compliance, not the logarithm of its stiffness: of a rigid joint they tell a least
stiffness and no greatest one. With d the distance of u from its estimate, the signals of a model are linear
in [BoxCox1964]

.. math:: x(d) = \frac{1 - e^{-\lambda d}}{\lambda}                                                    (1)

with lambda = 1 of what acts by its inverse, 0 of what acts by its logarithm, -1 of what acts in proportion.
It follows from one more residual, at d, and what the estimate makes of that,

.. math:: x(d) = \frac{a^T (r(u + d) - r(u))}{a^T J_k}, \quad a = W J H^{-1}_k                         (2)

The posterior of u alone is that of x, with what data know of it, and the prior of u,

.. math:: \ln p = -\frac{(x - b)^2}{2 s^2} - \frac{(u - m)^2}{2 \tau^2}, \quad
          \frac{1}{s^2} = \frac{1}{V_{kk}} - \frac{1}{\tau^2}                                          (3)

where b makes the estimate the most probable value with the weights that it was found with. The 90 % interval
lies between its quantiles. With lambda = 0 that is the normal distribution of variance V. Where the
90 % interval of x without the prior reaches beyond its end 1/lambda, data alone set one end of u: a spring
cannot be told from rigid, or what acts in proportion from none.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asinh, expm1, sqrt
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.calibration_estimates import OneSided
from flexarm.diagnosis.fit import FIT_ERRORS
from flexarm.named_effects import NORMAL_90

if TYPE_CHECKING:
    from flexarm.calibration.estimation import Posterior


@dataclass(frozen=True, eq=False)
class Marginal:
    """Posterior of one u."""

    u: Floats
    """Increasing values, shape (n,)."""
    below: Floats
    """Probability below each of them, shape (n,)."""
    one_sided: OneSided = ""
    """The end that data alone set, if they set one."""

    @classmethod
    def normal(cls, mean: float, sigma: float) -> Marginal:
        """Return a normal distribution."""
        from scipy.special import ndtr

        z = np.linspace(-8.0, 8.0, 1601)
        return cls(mean + sigma * z, ndtr(z))

    def quantile(self, share: float) -> float:
        """Return the u below which a share of the probability lies."""
        return float(np.interp(share, self.below, self.u))

    def share(self, u: float) -> float:
        """Return the probability below u."""
        return float(np.interp(u, self.u, self.below))


def marginals(posterior: Posterior) -> list[Marginal]:
    """Return the posterior of each parameter."""
    found = [_marginal(posterior, k) for k in range(len(posterior.point.u))]
    valley, policy = posterior.valley, posterior.estimation.policy
    if valley is None:
        return found
    return [
        Marginal(*valley.below(k))
        if valley.spread(k) > policy.along * posterior.covariance[k, k] and not own.one_sided
        else own
        for k, own in enumerate(found)
    ]


def _marginal(posterior: Posterior, k: int) -> Marginal:
    """Return the posterior of parameter k about the estimate."""
    u, variance = float(posterior.point.u[k]), float(posterior.covariance[k, k])
    naive, (m, tau) = float(posterior.inverse[k, k]), own_prior(posterior, k)
    if posterior.estimation.parameters[k].scale != "log" or max(variance, naive) >= tau**2:
        return Marginal.normal(u, sqrt(variance))
    bend = _bend(posterior, k, min(sqrt(variance), posterior.estimation.policy.longest_step))
    s, b = _of_data(variance, tau), (u - m) * _of_data(naive, tau) ** 2 / tau**2
    return bent_marginal(u, bend, (b, s), (m, tau))


def own_prior(posterior: Posterior, k: int) -> tuple[float, float]:
    """Return m and tau of (3); what the rest of a family tells of a member is not identified by the data."""
    estimation = posterior.estimation
    family = next((each for each in estimation.families if k in estimation.columns(each)), None)
    if family is None:
        return float(estimation.centre[k]), float(np.sqrt(np.linalg.inv(estimation.precision())[k, k]))
    return family.hierarchy.shared_value(
        posterior.point.u[estimation.columns(family)]
    ), family.hierarchy.spread


def _of_data(variance: float, tau: float) -> float:
    """Return s of (3)."""
    return 1 / sqrt(1 / variance - 1 / tau**2)


def _bend(posterior: Posterior, k: int, d: float) -> float:
    """Return lambda of (1), from -1 to 1; 0 where the model cannot be simulated."""
    estimation, u = posterior.estimation, posterior.point.u
    column = posterior.weighting.root(posterior.point.jacobian) @ posterior.inverse[:, k]
    depends = posterior.weighting.root(column)
    there = u.copy()
    there[k] += d
    try:
        problem = estimation.problem
        moved = problem.residual(estimation.model(there)) - problem.residual(estimation.model(u))
    except FIT_ERRORS:
        return 0.0
    return bend_of(d, float(depends @ moved) / float(depends @ posterior.point.jacobian[:, k]))


def bend_of(d: float, x: float) -> float:
    """Return lambda of (1) for x at d, from -1 to 1."""
    from scipy.optimize import brentq

    if not -expm1(-d) < x < expm1(d):
        return 1.0 if x <= -expm1(-d) else -1.0
    return float(brentq(lambda bend: float(transformed(d, bend)) - x, -1.0, 1.0))


def transformed(d: Floats | float, bend: float) -> Floats:
    """Return x of (1)."""
    d = np.asarray(d, dtype=float)
    found: Floats = d if abs(bend) < 1e-9 else -np.expm1(-bend * d) / bend
    return found


def bent_marginal(u: float, bend: float, data: tuple[float, float], prior: tuple[float, float]) -> Marginal:
    """Return (3) with b and s, m and tau."""
    (b, s), (m, tau) = data, prior
    reach = asinh((8.0 * tau + abs(u - m)) / s)  # beyond that the prior leaves nothing
    t = np.linspace(-reach, reach, 20001)
    d = s * np.sinh(t)
    x = transformed(np.clip(d, -100.0, 100.0), bend)
    log_p = -(((x - b) / s) ** 2) / 2 - ((u + d - m) / tau) ** 2 / 2
    total = np.cumsum(np.exp(log_p - log_p.max()) * np.cosh(t))
    end: OneSided = "low" if bend > 0 else "high"
    beyond = bend * b + abs(bend) * NORMAL_90 * s >= 1
    return Marginal(u + d, total / total[-1], end if beyond else "")
