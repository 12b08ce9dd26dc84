r"""Posterior along a curved valley: a profile in the direction that data know least.

Data that tell a ratio well and a size hardly have a long, curved posterior. No normal distribution about the
estimate u_0 has its shape. With H of `calibration.estimation`, eq. (2), and d the direction of greatest
variance in units of the parameters' sigmas, d^T H d = 1, the objective F is minimised at points t,

.. math:: F(t) = \min_u F(u) \quad \text{with} \quad d^T H (u - u_0) = t                               (1)

A normal posterior has F(t) = F(0) + t^2. Where that misses by more than `CalibrationPolicy.curved` of it at
the ends of the 90 % interval of t, the profile is traced. By Laplace's approximation of other directions A,

.. math:: p(t) \propto \frac{\exp(-F(t)/2\rho)}{\sqrt{|A^T H_t A|}}, \quad
          p(u_k) = \int N\left(u_k(t), V_k(t)\right) p(t) \, dt                                        (2)

[Tierney1986] with H_t and V(t) of steps along A, eq. (3) there, and rho the variance of t by all errors.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.calibration.estimation import damped_step
from flexarm.diagnosis.fit import FIT_ERRORS
from flexarm.named_effects import NORMAL_90

if TYPE_CHECKING:
    from flexarm.calibration.estimation import Posterior


@dataclass(frozen=True, eq=False)
class Valley:
    """The profile (1) at increasing t."""

    t: Floats
    """Shape (n,)."""
    u: Floats
    variance: Floats
    """u(t) and the diagonal of V(t) of (2), shape (n, m)."""
    objective: Floats
    """F(t), shape (n,)."""
    log_density: Floats
    """ln p(t) of (2) but for a constant, shape (n,)."""

    def lower(self, least: float) -> Floats | None:
        """Return u where F is lowest, if it is lower there than at t = 0 by more than `least`."""
        k = int(np.argmin(self.objective))
        return self.u[k] if self.objective[k] < float(self.objective[self.t == 0][0]) - least else None

    def spread(self, k: int) -> float:
        """Return the variance of u_k(t)."""
        mean, _, weight = self._at(k)
        return float(weight @ (mean - weight @ mean) ** 2)

    def below(self, k: int) -> tuple[Floats, Floats]:
        """Return increasing values of u_k and the probabilities below them by (2)."""
        from scipy.special import ndtr

        mean, variance, weight = self._at(k)
        sigma = np.sqrt(variance + np.gradient(mean) ** 2)  # no gaps between points
        u = np.linspace((mean - 6 * sigma).min(), (mean + 6 * sigma).max(), 2001)
        return u, ndtr((u[:, None] - mean) / sigma) @ weight

    def _at(self, k: int) -> tuple[Floats, Floats, Floats]:
        """Return u_k(t), V_k(t) and weights of many t."""
        from scipy.interpolate import PchipInterpolator

        t = np.linspace(self.t[0], self.t[-1], 401)
        columns = np.column_stack([self.u[:, k], self.variance[:, k], self.log_density])
        mean, variance, log_p = PchipInterpolator(self.t, columns)(t).T
        weight = np.exp(log_p - log_p.max())
        return mean, variance, weight / weight.sum()


def worst_direction(posterior: Posterior) -> Floats:
    """Return d of (1), shape (m,)."""
    sigma = np.sqrt(np.diag(posterior.inverse))
    values, vectors = np.linalg.eigh(posterior.inverse / np.outer(sigma, sigma))
    return np.asarray(sigma * vectors[:, -1] * np.sqrt(values[-1]))


def valley_of(posterior: Posterior) -> Valley | None:
    """Return the profile in the worst direction; None where the posterior is normal along it.

    None as well about estimates that are not at rest: (1) has no minimum there.
    """
    if not posterior.at_rest:
        return None
    try:
        d = worst_direction(posterior)
        ends = [posterior.objective(posterior.point.u + t * d) for t in (-NORMAL_90, NORMAL_90)]
        rise = (np.array(ends) - posterior.objective(posterior.point.u)) / NORMAL_90**2
        if np.abs(rise - 1).max() <= posterior.estimation.policy.curved:
            return None
        return _traced(posterior, d)
    except FIT_ERRORS:
        return None


def _traced(posterior: Posterior, d: Floats) -> Valley:
    """Return the profile to both sides, as far as (2) has probability, at most `CalibrationPolicy.reach`, or
    to a lower point.
    """
    estimation, weighting, u0 = posterior.estimation, posterior.weighting, posterior.point.u
    policy, P = estimation.policy, estimation.precision()
    sigma = np.sqrt(np.diag(posterior.inverse))
    H = np.linalg.inv(posterior.inverse / np.outer(sigma, sigma)) / np.outer(sigma, sigma)
    a = H @ d
    A = sigma[:, None] * np.linalg.svd((a * sigma)[None])[2][1:].T  # a^T A = 0
    rho = float(a @ weighting.covariance(posterior.point.jacobian, P, posterior.inverse) @ a)

    def at(start: Floats) -> tuple[Floats, float, Floats, float]:
        """Return u(t), F(t), V(t) and ln p(t) from a start with this t."""
        point = estimation.linearised(start)
        step, residual, _ = damped_step(estimation, point, weighting, P, estimation.centre, A)
        J = weighting.root(point.jacobian @ A)
        normal = J.T @ J + A.T @ P @ A
        inverse = A @ np.linalg.inv(normal) @ A.T
        F = posterior.objective(start + step, residual)
        own = replace(weighting, input_errors=point.input_errors)
        variance = np.diag(own.covariance(point.jacobian, P, inverse))
        return start + step, F, variance, -F / (2 * rho) - float(np.linalg.slogdet(normal)[1]) / 2

    found = {0.0: at(u0)}
    false = found[0.0][1] - posterior.negligible
    for side in (-1.0, 1.0):
        move, u, t = side * d, found[0.0][0], 0.0
        most = max(each[3] for each in found.values())
        while abs(t) < policy.reach and found[t][1] > false and found[t][3] > most - policy.lost:
            most = max(most, found[t][3])
            t += side
            found[t] = at(u + move)
            move, u = found[t][0] - u, found[t][0]
    order = sorted(found)
    u, objective, variance, log_density = (np.array([found[t][k] for t in order]) for k in range(4))
    return Valley(np.array(order), u, variance, objective, log_density)
