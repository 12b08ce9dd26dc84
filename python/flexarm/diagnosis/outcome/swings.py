"""What is said of records that begin in motion: with how much the arm swung when they began."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexarm.diagnosis.fitting.fit import Fit
from flexarm.diagnosis.residuals.observed import Observed
from flexarm.diagnosis.wording import with_unit

TOLD = 1.0
"""Least swing that is told, over the noise."""


def swings(fit: Fit, observed: Observed) -> Iterator[str]:
    """A sentence for each record that begins with the arm swinging, which the gaps of a report still hold."""
    x = fit.projection.best(fit.residual)
    for name in observed.records:
        mine = [fit.unknowns.keys.index(s.key) for s in observed.starts if s.record == name]
        move = fit.projection.slopes[:, mine] @ x[mine]
        most = {each: float(np.abs(move[each.where]).max()) for each in observed.rows_of(name)}
        each = max(most, key=lambda rows: most[rows], default=None)
        if mine and each is not None and most[each] > TOLD:
            unit = observed.records[name].signals[each.signal].unit
            size = with_unit(most[each] * each.sigma, unit)
            yield (
                f"{name} begins with the arm swinging, by up to {size} at {each.signal}: that is fitted "
                "along, and still part of the gaps told here"
            )
