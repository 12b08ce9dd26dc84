"""A search along parameters of laws with corners, without derivatives.

Where an arm falls through a gap or sticks, C of `fitting.fit` has ripples: what hits a stop a little earlier
swings on out of step. Differences finer than the ripples say where the next one goes, not where the least C
lies. Steps of some percent of a gap, a torque or a width, along one of them at a time, smaller ones where
none leads down [Hooke1961], go over the ripples.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.candidates.candidate import Candidate
from flexarm.diagnosis.fitting.coordinate import Coordinate
from flexarm.diagnosis.fitting.fit import Fit

if TYPE_CHECKING:
    from flexarm.diagnosis.fitting.fitter import Fitter

STEPS = (0.1, 0.03, 0.01, 0.003)
"""Parts of a parameter."""
AHEAD = 3
"""Steps that are looked at to each side."""
MOVES = 4
"""Most moves of one size."""


def stepped_over(fit: Fit, fitter: Fitter) -> tuple[Candidate, ...]:
    """The effects of a fit where steps along cornered laws lead down to; as they are if none does."""
    cornered = [j for j, c in enumerate(fit.coordinates) if not c.smooth]
    if not cornered:
        return fit.members
    problem = fitter.problem(fit.members)

    def height(z: Floats) -> float:
        return float(np.sum(problem.rows(z) ** 2))

    z, least = fit.z, height(fit.z)
    for part in STEPS:
        for _ in range(MOVES):
            tried = [
                z + step * np.eye(len(z))[j]
                for j in cornered
                for step in _steps(part, fit.coordinates[j], float(z[j]))
            ]
            fitter.observed.prepare(fitter.with_effects(problem.members_at(there)) for there in tried)
            heights = [height(there) for there in tried]
            if min(heights, default=least) >= least:
                break
            least = min(heights)
            z = tried[heights.index(least)]
    return problem.members_at(z)


def _steps(part: float, coordinate: Coordinate, z: float) -> list[float]:
    """Steps of z by such parts of the parameter, up and down, within its bounds."""
    step = abs(part * coordinate.value(z) / coordinate.slope(z))
    both = [sign * k * step for k in range(1, AHEAD + 1) for sign in (1, -1)]
    return [each for each in both if abs(z + each) <= coordinate.bound]
