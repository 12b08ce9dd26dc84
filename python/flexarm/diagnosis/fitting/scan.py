"""Starts for a law that bounces: gaps over a range, since between them least squares stop at ripples.

An arm that falls through a gap hits its ends a little earlier for a gap a little smaller and swings on out of
step, so that C of `fitting.fit` has ripples along the gap; steps of Newton and of three tenths
(`fitting.pattern`) end in one of them where the probe was far off. Across them C falls to where the gap is
right: gaps of a geometric series about the one that a fit found are tried, with all else as it is, and the
best one starts another fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexarm.diagnosis.candidates.candidate import Candidate, value_of
from flexarm.diagnosis.fitting.fit import Fit
from flexarm.diagnosis.fitting.fitter import Fitter
from flexarm.errors import InvalidParameter, NotConverged

TIMES = tuple(np.geomspace(0.4, 2.5, 12).tolist())
"""Gaps over the one that was found; the series steps over it, as it is known."""


def scanned(fit: Fit, fitter: Fitter) -> Fit | None:
    """A fit from the best of the gaps; None where the model has none, or none is better than its own."""
    k = next((i for i, member in enumerate(fit.members) if member.name == "backlash"), None)
    if k is None:
        return None
    gap = value_of(fit.members[k].effect, "gap")
    tried = [_with_gap(fit.members, k, times * gap) for times in TIMES]
    fitter.observed.prepare(fitter.with_effects(members) for members in tried)
    best = min(tried, key=lambda members: _left(members, fitter))
    if _left(best, fitter) >= fit.cost:
        return None
    return fitter.fit(best)


def _with_gap(members: Sequence[Candidate], k: int, gap: float) -> tuple[Candidate, ...]:
    moved = replace(members[k], effect=members[k].effect.with_parameters({"gap": gap}))
    return (*members[:k], moved, *members[k + 1 :])


def _left(members: Sequence[Candidate], fitter: Fitter) -> float:
    """C; infinite where nothing can be simulated."""
    try:
        rest = fitter.eliminated(members)[1].rest(fitter.residual(members))
    except (InvalidParameter, NotConverged):
        return np.inf
    return float(rest @ rest)
