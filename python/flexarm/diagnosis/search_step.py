"""Time step of a search: so fine that what simulations miss for it is a correction.

Fits add what time steps miss about one model to the residuals of all (`diagnosis.estimator`). That holds
while it is small. A lightly damped mode whose period is p wrong has another phase after 1 / p periods, and
another model another error. With the residual r(h) over its noise, the step is halved while in some channel

    mean (r(h/2) - r(h))^2 > SelectionPolicy.model_errors                                            (1)

and a halving brings the left side down as a method of order two does.
"""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.diagnosis.fit import FIT_ERRORS
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.residual_rows import is_non_smooth

HALVINGS = 2
"""At most: a search then takes four times as long."""
SECOND_ORDER = 4.0
"""Least factor by which (1) falls where steps are halved, of 16: below, a finer step does not pay."""


def with_fine_step(problem: Problem, arm: Arm) -> Problem:
    """Return the problem with its step, or with half or a quarter of it where (1) asks for that."""
    if is_non_smooth(arm) or all(record.kind == "static" for record in problem.records.values()):
        return problem
    with suppress(*FIT_ERRORS):
        moved = _moved(problem, arm)
        for _ in range(HALVINGS):
            if not np.any(moved > problem.policy.model_errors):  # eq. (1)
                break
            finer = problem.with_step(problem.step / 2)
            then = _moved(finer, arm)
            if then.max() * SECOND_ORDER > moved.max():
                break
            problem, moved = finer, then
    return problem


def _moved(problem: Problem, arm: Arm) -> Floats:
    """Left side of (1) by channel."""
    change = problem.with_step(problem.step / 2).residual(arm) - problem.residual(arm)
    return np.array([float(np.mean(change[where] ** 2)) for _, where in problem.channels()])


def step_remarks(stated: float, taken: float) -> list[str]:
    """Return a sentence on a step that is not the stated one."""
    if taken == stated:
        return []
    return [
        f"simulated in steps of {1e3 * taken:.3g} ms: those of {1e3 * stated:.3g} ms miss more than the noise"
    ]
