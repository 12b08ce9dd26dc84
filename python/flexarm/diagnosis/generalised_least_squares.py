r"""Generalised least squares: normal equations of a fit, and the fit with its rows weighed, to first order.

    H = J^T W J + Lambda,     x = -H^-1 g                                                            (1)

J is the Jacobian of the residuals, W the weights of the rows, Lambda those of the priors. Parameters differ
by powers of ten, so H is kept scaled to a unit diagonal, S H S. Its eigenvalues there tell directions that
neither data nor priors determine; these have no inverse.

Fits weigh rows by their stated noise. Where a gap stays, that is far too much, and values run many sigmas
from their priors. The evidence, with the covariance C of noise and discrepancy, is greatest elsewhere: where

.. math:: (r + J_z \Delta z + J_x x)^T W (r + J_z \Delta z + J_x x) + |x/\sigma|^2
          + |\rho + \rho' \Delta z|^2                                                                (2)

with W = C^-1 is least. x are nuisance parameters from the centres of their priors, z the effects' parameters,
rho the rows of their priors (`diagnosis.parameters`). The step taken is that of (2) less that of (2) with
W = 1, so that a fit that leaves only noise stays where it is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.parameters import prior_rows

UNKNOWN = 1e-15
"""Part of the greatest eigenvalue below which a direction is unknown: nothing but rounding."""
ROUNDED = 1e-10
"""The same where rows were taken away: their rounding stays."""


@dataclass(frozen=True)
class NormalEquations:
    """H of (1): `hessian` is S H S, `scale` the diagonal of S, `unknown` as `UNKNOWN`."""

    hessian: Floats
    scale: Floats
    unknown: float = UNKNOWN

    @classmethod
    def of(
        cls, jacobian: Floats, prior: Floats, weight: Floats | None = None, unknown: float = UNKNOWN
    ) -> NormalEquations:
        """From J of shape (n, m), Lambda or its diagonal, and the diagonal of W, all ones if not given."""
        held = prior if prior.ndim == 2 else np.diag(prior)
        weighted = jacobian if weight is None else weight[:, None] * jacobian
        scale = 1.0 / np.sqrt(np.maximum(np.sum(jacobian * weighted, axis=0) + np.diag(held), 1e-300))
        hessian = (jacobian * scale).T @ (weighted * scale) + held * np.outer(scale, scale)
        return cls(hessian, scale, unknown)

    def without(self, jacobian: Floats) -> NormalEquations:
        """Return the same less rows of which these are J."""
        own = jacobian * self.scale
        return NormalEquations(self.hessian - own.T @ own, self.scale, ROUNDED)

    def solved(self, gradient: Floats) -> Floats:
        """H^-1 times vectors of shape (m, ...)."""
        root = self.root()
        found: Floats = root @ (root.T @ gradient)
        return found

    def inverse(self) -> Floats:
        """H^-1."""
        root = self.root()
        found: Floats = root @ root.T
        return found

    def root(self) -> Floats:
        """R of H^-1 = R R^T."""
        values, vectors = np.linalg.eigh(self.hessian)
        known: NDArray[np.bool_] = values > self.unknown * values.max(initial=0.0)
        found: Floats = self.scale[:, None] * vectors[:, known] / np.sqrt(values[known])
        return found


def joint_jacobian(fit: Fit) -> tuple[Floats, Floats, Floats]:
    """J, the residuals that unknowns leave, and the diagonal of Lambda, at the optimum of a fit."""
    x = fit.projection.solve(fit.residual)
    jacobian = np.column_stack([fit.jacobian, fit.projection.jacobian])
    residual = fit.residual + fit.projection.jacobian @ x
    held = [c.held**2 for c in fit.parameters]
    return jacobian, residual, np.concatenate([held, 1.0 / fit.projection.sigma**2])


NO_WEIGHT = 1e-12
"""Of `Normal`: what rows of little weight and no prior hardly know stays where it is."""


def gls_step(fit: Fit, jacobian: Floats, residual: Floats) -> Floats:
    """Return dz and dx from a fit to the optimum of (2), from whitened derivatives and residual."""
    plain = np.column_stack([fit.jacobian, fit.projection.jacobian])
    return _least(fit, jacobian, residual) - _least(fit, plain, fit.residual)


def gls_nuisance(fit: Fit) -> Floats:
    """x of a fit, shape (m,), where rows are worth what it leaves of them in the mean."""
    root = 1.0 / np.sqrt(max(1.0, fit.cost / len(fit.residual)))
    jacobian = np.column_stack([fit.jacobian, fit.projection.jacobian])
    step = gls_step(fit, root * jacobian, root * fit.residual)
    return fit.projection.solve(fit.residual) + step[len(fit.z) :]


def _least(fit: Fit, jacobian: Floats, residual: Floats) -> Floats:
    """Return dz and x where (2) is least."""
    rows, bends = prior_rows(fit.parameters, fit.z)
    held = np.concatenate([bends**2, 1.0 / fit.projection.sigma**2])
    pull = np.concatenate([bends * rows, np.zeros_like(fit.projection.sigma)])
    return -NormalEquations.of(jacobian, held, unknown=NO_WEIGHT).solved(jacobian.T @ residual + pull)
