r"""Cross-validation of fitted models: prediction residuals, and skill on parts of the training.

If the rows of a group g are left out of a fit of parameters x, with Jacobian J of the residuals r at its
optimum, weights Lambda of the priors and H = J^T J + Lambda, the prediction residuals are, to first order
(PRESS, [Allen1974]),

.. math:: e_g = r_g + J_g \, (H - J_g^T J_g)^{-1} J_g^T r_g                                           (1)

Errors of different groups are independent. If those of G groups are alike in size, the odds of one model over
another that predicts them are

.. math:: \ln B = G \ln (|e'|/|e|)                                                                    (2)

A group is a stretch of one record, poses in their order: clocks and frames are known from the rest of it.

A model that leaves a gap is also tested on parts of the training: records, or fifths of a single one. For
each part the fit is repeated without it, to first order about the fit of all,

    p_- = p - (J_-^T J_- + Lambda)^-1 (J_-^T r_- + Lambda (p - c))                                    (3)

(J_-, r_-: rows of the other parts). The model at p_- predicts the part, with clocks and frames aligned there
as `compare` does. With a the rms that this leaves, and b that of the nominal model aligned in the same way,

    skill = 1 - a/b.                                                                                  (4)

Each part must be predicted better than by the nominal model. Source: block cross-validation [Burman1994].
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.diagnosis.fit import Fit, NormalEquations, Projection, joint_jacobian
from flexarm.diagnosis.problem import Problem


def press_residuals(fit: Fit, problem: Problem) -> Floats:
    """Return e of (1), the prediction residual of every row over the noise; shape (n,)."""
    jacobian, residual, prior = joint_jacobian(fit)
    normal = NormalEquations.of(jacobian, prior)
    found = residual.copy()
    for rows in folds(problem):
        own = jacobian[rows]
        found[rows] += own @ normal.without(own).solved(own.T @ residual[rows])  # eq. (1)
    return found


def press_rms(fit: Fit, problem: Problem) -> float:
    """Return the rms of e of (1), over the noise."""
    return float(np.sqrt(np.mean(press_residuals(fit, problem) ** 2)))


def predicts_better(one: Fit, other: Fit, problem: Problem) -> bool:
    """Return True if a model predicts left-out data clearly better than another one."""
    ratio = press_rms(other, problem) / max(press_rms(one, problem), 1e-300)
    odds = len(folds(problem)) * log(max(ratio, 1e-300))  # eq. (2)
    policy = problem.policy
    return ratio * (1.0 - policy.predictive_share) > 1.0 and odds > policy.predictive_evidence


def log_odds_lost(fits: Sequence[Fit], problem: Problem) -> list[float]:
    """Return ln B of (2) of the best predictor over each of some models."""
    misses = [max(press_rms(f, problem), 1e-300) for f in fits]
    return [len(folds(problem)) * log(each / min(misses)) for each in misses]


def folds(problem: Problem) -> list[NDArray[np.int_]]:
    """Return the rows of each group: a stretch of a record, in time or in the order of poses."""
    return _stretches(problem, problem.policy.blocks)


def _stretches(problem: Problem, count: int) -> list[NDArray[np.int_]]:
    """Return the rows of each of `count` stretches a record, all channels."""
    found: dict[tuple[str, int], list[NDArray[np.int_]]] = {}
    for each, where in problem.channels():
        index = np.arange(where.start, where.stop)
        times = [row.time for row in problem.rows if row.record == each.record]
        first, last = min(t[0] for t in times), max(t[-1] for t in times)
        number = np.minimum((count * (each.time - first) / max(last - first, 1e-12)).astype(int), count - 1)
        for k in np.unique(number):
            found.setdefault((each.record, int(k)), []).append(index[number == k])
    return [np.concatenate(rows) for rows in found.values()]


PARTS = 5
"""Parts of a single record."""


def cross_validated_skill(fit: Fit, null: Fit, stated: Floats, problem: Problem) -> float:
    """Return (4) over all parts; 0 or less if one part is predicted worse than by the nominal model.

    `fit` and `null` are the models with and without effects, `stated` (n,) is the residual of the nominal
    model.
    """
    jacobian, residual, held = joint_jacobian(fit)
    best = np.concatenate([np.zeros(len(fit.z)), fit.projection.solve(fit.residual)])
    centred = np.where(np.arange(len(best)) < len(fit.z), 0.0, best)  # priors of effects centred at the fit
    after, before = [], []
    for rows in parts(problem):
        other = np.setdiff1d(np.arange(len(problem)), rows)
        gradient = jacobian[other].T @ residual[other] + held * centred
        moved = best - NormalEquations.of(jacobian[other], held).solved(gradient)  # eq. (3)
        model = ~_placed(fit)
        there = fit.residual[rows] + jacobian[np.ix_(rows, np.flatnonzero(model))] @ moved[model]
        after.append(_aligned(there, fit, rows))
        before.append(_aligned(stated[rows], null, rows))
    skill = 1.0 - float(np.sqrt(sum(after) / sum(before)))  # eq. (4)
    return skill if all(a < b for a, b in zip(after, before, strict=True)) else min(0.0, skill)


def parts(problem: Problem) -> list[NDArray[np.int_]]:
    """Return the rows of each part."""
    return _stretches(problem, PARTS if len(problem.records) == 1 else 1)


def _placed(fit: Fit) -> NDArray[np.bool_]:
    """Return True at clocks and frames among the parameters of the effects and nuisance parameters."""
    return np.array([False] * len(fit.z) + [u.kind != "nominal" for u in fit.nuisance.parameters], dtype=bool)


def _aligned(residual: Floats, fit: Fit, rows: NDArray[np.int_]) -> float:
    """Return the sum of squares after alignment of clocks and frames within their priors."""
    placed = _placed(fit)[len(fit.z) :]
    own = Projection(
        fit.projection.jacobian[np.ix_(rows, np.flatnonzero(placed))], fit.nuisance.sigma[placed]
    )
    rest = own.project(residual)[: len(rows)]
    return float(rest @ rest)
