r"""Hierarchical prior of the sizes of one effect at several places.

Its mean and spread are estimated (empirical Bayes), and their uncertainty is part of the evidence. Sizes that
are positive scatter in the logarithm u = ln p,

.. math:: u_i \sim N(\mu, \tau^2), \quad \mu \sim N(m, s^2)                                            (1)

with mode m and s of the effect's own prior: a member that the data hardly know stays near exp(mu). Errors
that may have either sign have no common value but a common size,

.. math:: u_i \sim N(0, \tau^2)                                                                        (2)

The spread tau is estimated: its posterior mode given estimates u and their variances v,

.. math:: \tau^2 = \frac{\nu \tau_0^2 + \sum_i \left((u_i - \mu)^2 + v_i\right)}{\nu + n}             (3)

where a prior spread tau_0 counts as nu members: of (1) a spread of its own, of (2) the effect's sigma. So
x = ln tau^2 has the density

.. math:: \ln p(x) = \tfrac{\nu}{2} \ln \tfrac{\nu \tau_0^2}{2} - \ln\Gamma(\tfrac{\nu}{2})
          - \tfrac{\nu}{2} x - \tfrac{\nu \tau_0^2}{2} e^{-x}                                          (4)

Members given mu and tau have evidence of their own. By Laplace's approximation about (3), with the curvatures
n/tau^2 + 1/s^2 and (nu + n)/2, the uncertainty of mu and x costs

.. math:: \ln p(\mu) + \tfrac12 \ln\frac{2\pi}{n/\tau^2 + 1/s^2}
          + \ln p(x) + \tfrac12 \ln\frac{4\pi}{\nu + n}                                                (5)

Fits and the evidence of members replace the normal density of (1) and (2) by one of Student's, as of every
prior (`candidate.TransformedParameter.log_density`), so that one odd place does not move the others.

Source: [Gelman2013], chapter 5; (3) is a step of expectation maximisation [Dempster1977].
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, lgamma, log, pi, sqrt

import numpy as np

from flexarm.arm.prior import QUANTILE, Prior
from flexarm.arrays import Floats
from flexarm.diagnosis.policy import FamilyPolicy


@dataclass(frozen=True)
class HierarchicalPrior:
    """Eq. (1) or (2) of one parameter."""

    prior: Prior
    """Prior of the size in one machine."""
    prior_spread: float
    count: float
    """tau_0 and nu of (3); `family_spread` and `family_count` of the policy."""
    spread: float
    """tau of (1) or (2)."""
    mean: float = 0.0
    """mu of (1); 0 of (2)."""

    @classmethod
    def of(cls, prior: Prior, policy: FamilyPolicy) -> HierarchicalPrior:
        """Return the prior before any data."""
        own = policy.family_spread if prior.scale == "log" else (prior.high - prior.low) / (2 * QUANTILE)
        found = cls(prior, own, policy.family_count, own)
        return replace(found, mean=found.hyperprior[0])

    @property
    def has_mean(self) -> bool:
        """Return True if the members scatter about a mean, eq. (1)."""
        return self.prior.scale == "log"

    @property
    def hyperprior(self) -> tuple[float, float]:
        """Return m and s of (1); zeros of (2)."""
        if not self.has_mean:
            return 0.0, 0.0
        low, mode, high = (log(value) for value in (self.prior.low, self.prior.typical, self.prior.high))
        return mode, (high - low) / (2 * QUANTILE)

    def precision(self, n: int) -> Floats:
        """Return the inverse of the prior covariance of n members, shape (n, n)."""
        covariance = self.hyperprior[1] ** 2 * np.ones((n, n)) + self.spread**2 * np.eye(n)
        return np.asarray(np.linalg.inv(covariance))

    def shared_value(self, u: Floats) -> float:
        """Return the posterior mean of mu given the members' u; 0 of (2)."""
        m, s = self.hyperprior
        if not self.has_mean:
            return 0.0
        weights = 1 / self.spread**2, 1 / s**2
        return float((weights[0] * u.sum() + weights[1] * m) / (weights[0] * len(u) + weights[1]))

    def updated(self, u: Floats, variance: Floats) -> HierarchicalPrior:
        """Return the same with the mean of the members' u and the spread of (3)."""
        mean = self.shared_value(u)
        squares = float(np.sum((u - mean) ** 2 + variance))
        spread = sqrt((self.count * self.prior_spread**2 + squares) / (self.count + len(u)))  # eq. (3)
        return replace(self, mean=mean, spread=spread)

    def member_prior(self) -> Prior:
        """Return the prior of each member given mu and tau."""
        ends = (self.mean + sign * QUANTILE * self.spread for sign in (-1, 0, 1))
        low, mode, high = (exp(end) for end in ends) if self.has_mean else ends
        source = f"{self.prior.source}; shared with the other places"
        return replace(self.prior, low=low, typical=mode, high=high, source=source)

    def log_evidence(self, n: int) -> float:
        """Return the log evidence of mu and tau of n members, eq. (5)."""
        nu, x = self.count, 2 * log(self.spread)
        scale = nu * self.prior_spread**2 / 2
        density = nu / 2 * (log(scale) - x) - lgamma(nu / 2) - scale / self.spread**2  # eq. (4)
        found = density + log(4 * pi / (nu + n)) / 2
        if self.has_mean:
            m, s = self.hyperprior
            of_mean = -(((self.mean - m) / s) ** 2) / 2 - log(2 * pi * s**2) / 2
            found += of_mean + log(2 * pi / (n / self.spread**2 + 1 / s**2)) / 2
        return found  # eq. (5)
