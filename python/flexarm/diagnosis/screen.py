"""Screening: how much of the gap every effect at every place could explain, from finite steps.

With q the residual and D the probes of a candidate (`flexarm.diagnosis.candidates`), both without what
clocks, frames and nominal values explain,

    min over alpha of |q + D alpha|^2 + |alpha/10|^2,      share = 1 - min/|q|^2                       (1)

The probes of all candidates are simulated once; sets of two and more are then linear algebra. A probe is
about one sigma of what is plausible: the second term keeps alphas below some ten of them. Laws that cannot be
negative are not.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexarm.diagnosis.candidates import SPRINGS, Candidate
from flexarm.diagnosis.fit import Fit, Fitter
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.simulation import Progress, reported

Floats = NDArray[np.float64]

RIDGE = 0.1
ONE_SIGNED = ("joint_hysteresis", "backlash", "coulomb_friction", "viscous_friction", "motor_friction")


@dataclass(frozen=True, eq=False)
class Probed:
    """A candidate and what its probes do to the residual, shape (n, probes)."""

    candidate: Candidate
    moves: Floats


@dataclass(frozen=True, eq=False)
class Share:
    """What a set of candidates explains.

    Attributes
    ----------
    members : tuple of Candidate
        Of the size that explains most, ready to be fitted.
    share : float
        Of the squared gap, eq. (1).
    """

    members: tuple[Candidate, ...]
    share: float

    def __str__(self) -> str:
        return f"{self.share:7.2%}  " + " + ".join(f"{m.name} at {m.at}" for m in self.members)


def probe(fitter: Fitter, found: Sequence[Candidate], progress: Progress = None) -> list[Probed]:
    """Simulates the probes of all candidates; those that cannot be simulated are left out."""
    observed, arm = fitter.observed, fitter.start
    probed = []
    with reported(progress, "probing effects") as report:
        for k, candidate in enumerate(found):
            try:
                there = candidate.base(arm)
                models = [there, *(there.with_effect(each) for each in candidate.probes)]
                observed.prepare(models)
                before, *after = [observed.residual(model) for model in models]
            except (InvalidParameter, NotConverged):
                continue
            probed.append(Probed(candidate, np.stack([r - before for r in after], axis=1)))
            if report is not None:
                report((k + 1) / len(found))
    return probed


def screen(fitter: Fitter, probed: Sequence[Probed], fit: Fit, together: int = 0) -> list[Share]:
    """Candidates that could explain what a fit leaves, the best first.

    Parameters
    ----------
    fitter : Fitter
        Records and unknowns.
    probed : sequence of Probed
        What the probes do.
    fit : Fit
        Its effects may change along, to first order.
    together : int
        How many of the best are also tried in pairs, where a single one explains little.
    """
    taken = set(fit.places)
    free = [p for p in probed if p.candidate.place not in taken]
    singles = [found for p in free if (found := _share(fitter, [p], fit)) is not None]
    singles.sort(key=lambda s: -s.share)
    if not together:
        return singles
    return singles + pairs(fitter, free, fit, together)


def sharpened(fitter: Fitter, shares: Sequence[Share], fit: Fit) -> list[Share]:
    """Shares taken anew with each set at the size found, since laws bend between a probe and that size."""
    models = []
    for share in shares:
        members = (*fit.members, *share.members)
        with suppress(InvalidParameter):  # a ripple that would turn the output back
            models.append((share, members, fitter.with_effects(members)))
    fitter.observed.prepare(arm for _, _, arm in models)
    found = []
    for share, members, _ in models:
        try:
            move = fitter.residual(members) - fit.residual
        except (InvalidParameter, NotConverged):
            continue
        _, projection = fitter.eliminated(members)
        rest = projection.rest(np.column_stack([fit.residual, move]))
        q, d = rest[:, 0], rest[:, 1]
        times = max(-float(d @ q) / max(float(d @ d), 1e-300), 0.0)
        left = q + times * d
        found.append(Share(share.members, 1.0 - float(left @ left) / fit.cost))
    return sorted(found, key=lambda s: -s.share)


def pairs(fitter: Fitter, free: Sequence[Probed], fit: Fit, most: int) -> list[Share]:
    """The best pairs of candidates."""
    found = []
    for i, one in enumerate(free):
        for other in free[i + 1 :]:
            if one.candidate.place != other.candidate.place:
                share = _share(fitter, [one, other], fit)
                if share is not None:
                    found.append(share)
    found.sort(key=lambda s: -s.share)
    return found[:most]


def _share(fitter: Fitter, probed: Sequence[Probed], fit: Fit) -> Share | None:
    """Eq. (1) for one set, of what the fit leaves; None where a law would have to be negative."""
    members = [p.candidate for p in probed]
    _, projection = fitter.eliminated([*fit.members, *members])
    moves = np.concatenate([p.moves for p in probed], axis=1)
    rest = projection.rest(np.column_stack([fit.residual, moves, fit.slopes]))
    q, d, own = rest[:, 0], rest[:, 1:], moves.shape[1]
    gram = d.T @ d + np.diag([RIDGE**2] * own + [1.0] * (d.shape[1] - own))
    alphas: Floats = np.asarray(np.linalg.solve(gram, -d.T @ q), dtype=float)
    k = 0
    sized = []
    for each in probed:
        mine = alphas[k : k + each.moves.shape[1]]
        k += len(mine)
        if not _possible(each.candidate, mine):
            return None
        try:
            sized.append(replace(each.candidate, effect=each.candidate.sized(mine.tolist())))
        except (InvalidParameter, ValueError):
            return None
    left = q + d @ alphas
    return Share(tuple(sized), 1.0 - float(left @ left) / fit.cost)


def _possible(candidate: Candidate, alphas: Floats) -> bool:
    """Whether a law has the sign that it can have."""
    if candidate.name in ONE_SIGNED and candidate.without is None:
        return bool(alphas.max() > 0)
    if candidate.name in SPRINGS and candidate.without is None:
        return bool(alphas[0] > 0)
    return True
