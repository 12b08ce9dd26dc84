"""Effects that are collinear with a chosen one, though screening about another model does not show them.

A mass that is 4 % off puts a lightly damped arm out of step within some periods. About the model without the
effect, which alternatives are screened about, it explains little to first order, as they do. About the chosen
model, with J_e what the effect moves and D what small steps of a candidate do, both less what nuisance
parameters and the other effects explain,

    R2 = |P J_e|^2 / |J_e|^2,    P = D (D^T D)^-1 D^T                                                  (1)

is 1 for a candidate that moves the same. It is fitted from the size that moves as much as the effect does.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.moves.search_state import small_steps
from flexarm.diagnosis.screening import LONGER, Probed, Share
from flexarm.errors import InvalidParameter


def out_of_step(chosen: Candidate, shares: Sequence[Share], best: Fit, fewer: Fit, part: float) -> bool:
    """Return True if screening without an effect sees less than a part of what it explains."""
    seen = max((s.share for s in shares if s.places == (chosen.place,)), default=0.0)
    return seen < part * (1.0 - best.cost / fewer.cost)


def collinear(k: int, best: Fit, estimator: Estimator, probed: Sequence[Probed]) -> list[Candidate]:
    """Return candidates of which (1) is above `confounded`, few, the highest R2 first."""
    policy, chosen = estimator.problem.policy, best.members[k]
    own = np.array([parameter.candidate == k for parameter in best.parameters])
    there = {None, *best.spots}
    found = {
        p.candidate.place: p.candidate
        for p in reversed(probed)
        if p.candidate.effect.smooth
        and not p.candidate.effect.is_wave
        and p.candidate.needs is None
        and p.candidate.required_place in there
        and not p.candidate.spots & best.spots
    }
    ranked: list[tuple[float, Candidate]] = []
    effect = best.jacobian[:, own] @ _away(chosen, best, own)
    fine = replace(estimator, problem=estimator.problem.with_step(estimator.problem.step / LONGER))
    with suppress(*FIT_ERRORS):
        moved = small_steps(fine, [*found.values()], best)  # in the steps of the fit: longer ones ring slower
        for candidate, steps in zip(found.values(), moved, strict=True):
            if steps is None:
                continue
            columns = np.column_stack([effect, steps.moves, best.jacobian[:, ~own]])
            rest = best.projection.project(columns)
            sizes = np.linalg.lstsq(rest[:, 1:], rest[:, 0], rcond=None)[0]
            left = rest[:, 0] - rest[:, 1:] @ sizes
            r2 = 1.0 - float(left @ left) / max(float(rest[:, 0] @ rest[:, 0]), 1e-300)  # eq. (1)
            if r2 > policy.confounded:
                ranked.append((r2, candidate.at_size(sizes[: steps.moves.shape[1]].tolist())))
    ranked.sort(key=lambda one: -one[0])
    return [candidate for _, candidate in ranked[: policy.more_proposals]]


def _away(chosen: Candidate, best: Fit, own: NDArray[np.bool_]) -> Floats:
    """Return how far each parameter of the effect is from none of it, in z; 1 where that is not finite."""
    found = []
    for k in np.flatnonzero(own):
        parameter, away = best.parameters[k], 1.0
        null = chosen.null.get(parameter.name, np.nan)
        with suppress(InvalidParameter):
            away = float(best.z[k]) - parameter.z(null) if isfinite(null) else away
        found.append(away)
    return np.array(found)
