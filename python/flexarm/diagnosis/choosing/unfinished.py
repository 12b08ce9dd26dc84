"""Fits that need not be finished: those that stay far behind a model that is there already."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from flexarm.diagnosis.fitting.fit import Fit

NEARLY = 0.1
"""Part of what the best model leaves by which another may always leave more."""


def limit_beside(found: Sequence[Fit], without: Fit, part: float) -> float:
    """C above which a fit is not finished: some `part` of the way from the best one back to none of them.

    However little the best one explains, what leaves a tenth more than it is near. Without any fit there is
    no limit.
    """
    least = min((f.cost for f in found), default=inf)
    return least if least == inf else (1 + NEARLY) * least + part * max(without.cost - least, 0.0)
