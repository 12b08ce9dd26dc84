r"""Whether a repair that does not explain all still predicts what it was not fitted to.

The training is cut into parts: its records if there are several, else fifths of each record, one stretch of
time or poses each. For every part the fit is repeated without it, to first order about the fit of all,

    p_- = p - (J_-^T J_- + Lambda)^-1 (J_-^T r_- + Lambda (p - c))                                    (1)

(J_-, r_-: rows of the other parts), and its model predicts the part, with clocks and frames aligned anew
there, as `compare` does. With a the rms that this leaves in units of noise, b what the nominal model leaves
with its own clocks and frames aligned,

    carried = 1 - a/b.                                                                              (2)

A mixture of effects that imitates an unknown one in the data it saw fails where these data end: so each part
must be predicted better than by the nominal model. Source: cross-validation in blocks [Burman1994].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.diagnosis.fitting.fit import Fit
from flexarm.diagnosis.fitting.normal import Normal, joint_slopes
from flexarm.diagnosis.fitting.projection import Projection
from flexarm.diagnosis.residuals.observed import Observed

PARTS = 5
"""Of a single record."""


def carried(fit: Fit, null: Fit, stated: Floats, observed: Observed) -> float:
    """Eq. (2) over all parts; 0 or less where one part is predicted worse than by the model as stated.

    Parameters
    ----------
    fit, null : Fit
        With effects and without.
    stated : ndarray, shape (n,)
        Residual of the model without effects, nominal values where they are stated.
    observed : Observed
        The training.
    """
    slopes, residual, held = joint_slopes(fit)
    best = np.concatenate([np.zeros(len(fit.z)), fit.projection.best(fit.residual)])
    centred = np.where(np.arange(len(best)) < len(fit.z), 0.0, best)  # effects are held where the fit is
    after, before = [], []
    for rows in parts(observed):
        other = np.setdiff1d(np.arange(len(observed)), rows)
        gradient = slopes[other].T @ residual[other] + held * centred
        moved = best - Normal.of(slopes[other], held).solved(gradient)  # eq. (1)
        model = ~_placed(fit)
        there = fit.residual[rows] + slopes[np.ix_(rows, np.flatnonzero(model))] @ moved[model]
        after.append(_aligned(there, fit, rows))
        before.append(_aligned(stated[rows], null, rows))
    if any(a >= b for a, b in zip(after, before, strict=True)):
        return min(0.0, 1.0 - float(np.sqrt(sum(after) / sum(before))))
    return 1.0 - float(np.sqrt(sum(after) / sum(before)))  # eq. (2)


def parts(observed: Observed) -> list[NDArray[np.int_]]:
    """Rows of each part."""
    names = list(observed.records)
    found: dict[tuple[str, int], list[NDArray[np.int_]]] = {}
    for each, where in observed.channels():
        index = np.arange(where.start, where.stop)
        times = [row.time for row in observed.rows if row.record == each.record]
        first, last = min(t[0] for t in times), max(t[-1] for t in times)
        count = PARTS if len(names) == 1 else 1
        number = np.minimum(count * (each.time - first) / max(last - first, 1e-12), count - 1).astype(int)
        for k in np.unique(number):
            found.setdefault((each.record, int(k)), []).append(index[number == k])
    return [np.concatenate(rows) for rows in found.values()]


def _placed(fit: Fit) -> NDArray[np.bool_]:
    """Which unknowns are clocks and frames, after the parameters of the effects."""
    return np.array([False] * len(fit.z) + [u.kind != "nominal" for u in fit.unknowns.each], dtype=bool)


def _aligned(residual: Floats, fit: Fit, rows: NDArray[np.int_]) -> float:
    """Sum of squares that clocks and frames within their priors leave."""
    placed = _placed(fit)[len(fit.z) :]
    own = Projection(fit.projection.slopes[np.ix_(rows, np.flatnonzero(placed))], fit.unknowns.sigma[placed])
    rest = own.rest(residual)[: len(rows)]
    return float(rest @ rest)
