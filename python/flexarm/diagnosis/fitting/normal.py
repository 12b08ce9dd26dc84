"""Normal equations of a fit, in which effects, clocks, frames and nominal values move together.

    H = J^T W J + Lambda,     x = -H^-1 g                                                            (1)

J are derivatives of residuals, W the rows' weights, Lambda those of priors. Parameters differ by powers of
ten, so that H is kept with a diagonal of ones, S H S, and what is unknown is told from what is small by its
eigenvalues there: directions of which neither data nor priors say anything have no inverse.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.diagnosis.fitting.fit import Fit

HELD = 1.0 / 9.0
"""Weight of an effect's prior, as in `least_squares`."""
UNKNOWN = 1e-15
"""Part of the greatest eigenvalue below which a direction is unknown: nothing but rounding."""
ROUNDED = 1e-10
"""The same where rows were taken away: their rounding stays."""


@dataclass(frozen=True)
class Normal:
    """H of (1): `hessian` is S H S, `scale` the diagonal of S, `unknown` as `UNKNOWN`."""

    hessian: Floats
    scale: Floats
    unknown: float = UNKNOWN

    @classmethod
    def of(
        cls, slopes: Floats, prior: Floats, weight: Floats | None = None, unknown: float = UNKNOWN
    ) -> Normal:
        """From J of shape (n, m), the diagonals of Lambda and of W, all ones if not given."""
        weighed = slopes if weight is None else weight[:, None] * slopes
        scale = 1.0 / np.sqrt(np.maximum(np.sum(slopes * weighed, axis=0) + prior, 1e-300))
        hessian = (slopes * scale).T @ (weighed * scale) + np.diag(prior * scale**2)
        return cls(hessian, scale, unknown)

    def without(self, slopes: Floats) -> Normal:
        """The same less rows of which these are J."""
        own = slopes * self.scale
        return Normal(self.hessian - own.T @ own, self.scale, ROUNDED)

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


def joint_slopes(fit: Fit) -> tuple[Floats, Floats, Floats]:
    """J, the residuals that unknowns leave, and the diagonal of Lambda, at the optimum of a fit."""
    x = fit.projection.best(fit.residual)
    slopes = np.column_stack([fit.slopes, fit.projection.slopes])
    residual = fit.residual + fit.projection.slopes @ x
    held = [1e-6 if c.prior.scale == "uniform" else HELD for c in fit.coordinates]
    return slopes, residual, np.concatenate([held, 1.0 / fit.projection.sigma**2])
