"""What finer time steps still move where laws have corners.

What steps of length h miss is extrapolated (`Observed.correction`): the method is of order two. Teeth that
bounce do not follow any order. After some hits the motions of two steps part as those of two machines
would, and no step is fine enough. With r(h) the residual and

    E(h) = r(h/2) + (r(h/2) - r(h))/3                                                                 (1)

E(h/2) - E(h) is an error of each channel. Its mean square, for the models that a search comes by, is no gap
(`choosing.evidence`): the right gap between the teeth would else seem to lack something.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from math import sqrt

import numpy as np

from flexarm.arm import Arm
from flexarm.diagnosis.fitting.fit import FAILED
from flexarm.diagnosis.residuals.corners import has_corners
from flexarm.diagnosis.residuals.observed import Observed, extrapolated
from flexarm.diagnosis.wording import times_noise

COUNTS = 0.3
"""Least error of some channel, over its noise, that counts: a smaller one is what any simulation errs by."""


def allow_for_steps(observed: Observed, arm: Arm) -> None:
    """Counts (1) in each of `rows` beside a model with corners, where it is more than was known."""
    if not has_corners(arm):
        return
    with suppress(*FAILED):
        coarse, half, quarter = (
            observed.with_step(observed.step / times).residual(arm) for times in (1, 2, 4)
        )
        error = extrapolated(half, quarter) - extrapolated(coarse, half)  # eq. (1)
        square = [float(np.mean(error[each.where] ** 2)) for each in observed.rows]
        if max(square) < COUNTS**2:
            return
        rows = zip(observed.rows, square, strict=True)
        observed.rows = tuple(replace(each, unsteady=max(each.unsteady, s)) for each, s in rows)


def unsteady_told(observed: Observed) -> list[str]:
    """A sentence on signals of which no step is fine enough, if there are some."""
    most: dict[str, float] = {}
    for each in observed.rows:
        most[each.signal] = max(most.get(each.signal, 0.0), sqrt(each.unsteady))
    sizes = {signal: size for signal, size in most.items() if size > COUNTS}
    said = "no time step is fine enough for what bounces: half of it moves"
    return [f"{said} {times_noise(sizes)}, which is no gap"] if sizes else []
