r"""A fit with the rows weighed by what they are worth, to first order.

Fits weigh rows by their stated noise. Where a gap stays, that is far more than they are worth, and nominal
values and effects run many sigmas from their priors after a remainder that is none of theirs. The evidence,
which weighs rows by W, is greatest elsewhere: where

.. math:: (r + J_z \Delta z + J_x x)^T W (r + J_z \Delta z + J_x x) + |x/\sigma|^2
          + |\rho + \rho' \Delta z|^2                                                                (1)

is least; x are clocks, frames and nominal values from the centres of their priors, z the effects' parameters,
rho the rows of their priors (`fitting.coordinate`). The step taken is that of (1) less the one of (1) with
W = 1, so that a fit that leaves only noise stays where it is.
"""

from __future__ import annotations

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.fitting.coordinate import prior_rows
from flexarm.diagnosis.fitting.fit import Fit
from flexarm.diagnosis.fitting.normal import Normal

UNKNOWN = 1e-12
"""Of `Normal`: what rows of little weight and no prior hardly know stays where it is."""


def weighed(fit: Fit, weight: Floats) -> tuple[Floats, Floats]:
    """What a fit leaves, as `rest` of `fitting.fit`, and its z, where rows have weights of shape (n,)."""
    if (weight == 1.0).all():
        return fit.rest, fit.z
    slopes = np.column_stack([fit.slopes, fit.projection.slopes])
    step = _least(fit, slopes, weight) - _least(fit, slopes, np.ones_like(weight))
    k = len(fit.z)
    in_sigmas = step[k:] / fit.projection.sigma
    return fit.rest + np.concatenate([slopes @ step, in_sigmas]), fit.z + step[:k]


def tempered(fit: Fit) -> Floats:
    """x of a fit, shape (m,), where rows are worth what it leaves of them in the mean."""
    each = np.full(len(fit.residual), 1.0 / max(1.0, fit.cost / len(fit.residual)))
    slopes = np.column_stack([fit.slopes, fit.projection.slopes])
    step = _least(fit, slopes, each) - _least(fit, slopes, np.ones_like(each))
    return fit.projection.best(fit.residual) + step[len(fit.z) :]


def _least(fit: Fit, slopes: Floats, weight: Floats) -> Floats:
    """Where (1) is least: dz and x."""
    rows, bends = prior_rows(fit.coordinates, fit.z)
    held = np.concatenate([bends**2, 1.0 / fit.projection.sigma**2])
    pull = np.concatenate([bends * rows, np.zeros_like(fit.projection.sigma)])
    return -Normal.of(slopes, held, weight, UNKNOWN).solved(slopes.T @ (weight * fit.residual) + pull)
