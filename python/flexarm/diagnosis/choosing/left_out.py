r"""How well a model foretells what it was not fitted to.

Where something is left that no model explains, a larger model fits better whatever it says. What counts then
is what it says of data that it has not seen. If the rows of a group g are left out of a fit of parameters x,
with derivatives J of the residuals r at its optimum, priors' weights Lambda, and H = J^T J + Lambda, then x
moves by (H - J_g^T J_g)^{-1} J_g^T r_g, and what it misses there is, to first order [Allen1974],

.. math:: e_g = r_g + J_g \, (H - J_g^T J_g)^{-1} J_g^T r_g                                           (1)

Groups do not share their errors. If those of G of them are alike in size, whatever that is, the odds of one
model over another that foretells them are

.. math:: \ln B = G \ln (|e'|/|e|)                                                                    (2)

No group is fitted again. A group is what shares its errors: a static record, as poses of one day, one length
or one payload do; where there is but one, and in a motion, a block of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.diagnosis.fitting.fit import Fit
from flexarm.diagnosis.fitting.normal import Normal, joint_slopes
from flexarm.diagnosis.residuals.observed import Observed

BLOCKS = 24
"""Blocks a record."""
CLEARLY, ODDS = 0.2, log(200.0)
"""What is clearly better: part of what is missed, and least ln B of (2); for 24 blocks the same."""


def left_out(fit: Fit, observed: Observed) -> Floats:
    """e of (1): of every row, over the noise, what is missed if its group is left out; shape (n,)."""
    slopes, residual, prior = joint_slopes(fit)
    normal = Normal.of(slopes, prior)
    found = residual.copy()
    for rows in groups(observed):
        own = slopes[rows]
        found[rows] += own @ normal.without(own).solved(own.T @ residual[rows])  # eq. (1)
    return found


def missed(fit: Fit, observed: Observed) -> float:
    """Rms of e of (1), over the noise."""
    return float(np.sqrt(np.mean(left_out(fit, observed) ** 2)))


def foretells_better(one: Fit, other: Fit, observed: Observed) -> bool:
    """Whether a model foretells what is left out clearly better than another one."""
    ratio = missed(other, observed) / max(missed(one, observed), 1e-300)
    odds = len(groups(observed)) * log(max(ratio, 1e-300))  # eq. (2)
    return ratio * (1.0 - CLEARLY) > 1.0 and odds > ODDS


def odds_lost(fits: Sequence[Fit], observed: Observed) -> list[float]:
    """For each of some models, ln B of (2) over it of the one that foretells best."""
    misses = [max(missed(f, observed), 1e-300) for f in fits]
    return [len(groups(observed)) * log(each / min(misses)) for each in misses]


def groups(observed: Observed) -> list[NDArray[np.int_]]:
    """Rows of each group."""
    records: dict[str, list[NDArray[np.int_]]] = {}
    for each, where in observed.channels():
        if observed.records[each.record].kind == "static":
            records.setdefault(each.record, []).append(np.arange(where.start, where.stop))
    whole = {name: np.concatenate(parts) for name, parts in records.items()} if len(records) > 1 else {}
    if not whole:
        return blocks(observed)
    taken = np.concatenate(list(whole.values()))
    return [*whole.values(), *(rows for rows in blocks(observed) if not np.isin(rows, taken).any())]


def blocks(observed: Observed) -> list[NDArray[np.int_]]:
    """Rows of each block: a stretch of one record, all channels."""
    found: dict[tuple[str, int], list[NDArray[np.int_]]] = {}
    for each, where in observed.channels():
        index = np.arange(where.start, where.stop)
        record = [row.time for row in observed.rows if row.record == each.record]
        first, last = min(t[0] for t in record), max(t[-1] for t in record)
        number = np.minimum((BLOCKS * (each.time - first) / max(last - first, 1e-12)).astype(int), BLOCKS - 1)
        for j in np.unique(number):
            found.setdefault((each.record, int(j)), []).append(index[number == j])
    return [np.concatenate(parts) for parts in found.values()]
