"""What counts: when an effect is accepted, when nothing is left to explain, and when something is.

With e what a model leaves after the unknowns, x the unknowns that it needs, and s_c what it leaves above the
noise in channel c (eq. (3) of `diagnosis.evidence`; s_c0 of the model without effects), a larger
model matters if in some channel the part that it explains

    p_c = sqrt(mean over c of (e_old^2 - e_new^2)) > max(MATTERS, SHARE s_c0),                         (1)

or if it spares clocks, frames and nominal values a strain, which is what they need beyond two sigmas,

    S = sum_i max(|x_i|/sigma_i - FORBIDDEN, 0).                                                       (2)

Nothing is left to explain if

    s_c <= max(MATTERS, LEFT_SHARE s_c0/2) in every channel, and S < STRAINED;                         (3)

something else must be there if

    max_c s_c > max(LEFT, LEFT_SHARE max_c s_c0).                                                      (4)

Where two effects leave a gap and explain less than half of it, a third is not looked for: no three names of
the list are likely to be all. Where they leave a strain alone they must explain half of that. Nor is a second
one looked for beside one that explains less than `LITTLE` of the gap, and of the strain. The gap of n rows is
there C - n: of many quiet rows noise would else be most of what nothing explains.

An effect is accepted if the evidence for it is strong and it matters; none that is a clock or a frame within
`FORBIDDEN` sigmas of what the records state, as the smaller model has it there too. If it leaves a gap all
the same, it must also take a part of the whole one, C of `diagnosis.fit`, that is worth a name,

    C_new < (1 - DENT) C_old, or S_new < S_old - STRAINED,                                            (5)

and foretell data that are left out better than the smaller model does. What foretells them clearly better
needs no other evidence, which rests on the size and correlation of a remainder that nobody knows. Nor does
what foretells them about as well and is far more plausible: by priors with the tails of Student's t of all
values that a model needs, z of effects and of unknowns in their sigmas,

    U = 2 sum ln(1 + z^2/3).                                                                           (6)

Fits that need not be finished: those that stay far behind a model that is there already.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, log

import numpy as np

from flexarm.diagnosis.cross_validation import log_odds_lost, predicts_better, press_rms
from flexarm.diagnosis.evidence import above_noise, log_bayes_factor, variance_inflation
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.problem import Problem

STRONG = 6.0
"""Least gain of ln Z: odds of 400, for some forty effects at some places."""
REACH = log(20.0)
"""Bayes factor within which rivals are alternatives."""
SPARING = log(5.0)
"""The same as `STRONG` for an effect that spares a strain.

Few names move what a strained clock, frame or value moves, and values three sigma off, of which one in 400
is, are rarer than machines with something that moves them.
"""
MATTERS, SHARE = 0.5, 0.05
"""Least part explained in some channel, eq. (1): of the noise, and of what the nominal model leaves there."""
STRAINED, FORBIDDEN = 1.0, 2.0
"""Sum of the sigmas by which unknowns are beyond `FORBIDDEN` sigmas, from which they count as strained."""
DENT = 0.03
"""Least part of a gap that an effect takes if it leaves one, eq. (5): less is chance or disguise."""
HALF = 0.5
"""Part of the gap, and of the strain, of which two effects must leave less for a third to be looked for."""
LITTLE = 0.15
"""Least part of either that one effect takes for a second to be looked for; in the blind test 0.31."""
LEFT = 1.0
"""What may be left above the noise of a model that explains a record, over the noise."""
LEFT_SHARE = 0.07
"""The same, of what the nominal model leaves."""
NEARLY_ALL = 0.01
"""The same of a size that machines do not have."""


def accepted(new: Fit, old: Fit, null: Fit, problem: Problem) -> bool:
    """Whether evidence for a larger model is strong and what it explains matters."""
    spared = spares(new, old)
    if as_stated(new, old) or not (matters(new, old, null, problem) or spared):
        return False
    enough = SPARING if spared else STRONG
    strong = log_bayes_factor(new, old, problem, variance_inflation(new.projected, problem)) > enough
    if not leaves_gap(new, null, problem):
        return strong
    if not worth_a_name(new, old):
        return False
    if strong:
        return press_rms(new, problem) < press_rms(old, problem)
    return predicts_better(new, old, problem) or far_more_plausible(new, old, problem)


def far_more_plausible(new: Fit, old: Fit, problem: Problem) -> bool:
    """Whether odds are strong by (6) alone, and still are with what is foretold of data left out."""
    gained = implausibility(old) - implausibility(new)
    lost, least = log_odds_lost([new, old], problem)
    return gained > STRONG and gained + least - lost > STRONG


def as_stated(new: Fit, old: Fit) -> bool:
    """Whether what is added is a clock or a frame within `FORBIDDEN` sigmas of what is stated of it.

    In the smaller model it is free to be there.
    """
    stated = {u.key: u for u in old.nuisance.parameters}
    pulls = [
        abs(value - stated[key].centre) / stated[key].sigma
        for member in new.members
        if member.place not in old.places
        for name, value, _ in member.effect.parameters()
        if (key := f"effects.{member.name}.{member.at}.{name}") in stated
    ]
    return bool(pulls) and max(pulls) < FORBIDDEN


def matters(new: Fit, old: Fit, null: Fit, problem: Problem) -> bool:
    """Whether a larger model explains a part of the gap that can be seen in some channel."""
    first = above_noise(null.projected, problem, null.non_smooth)
    for each, where in problem.channels():
        square = float(np.mean(old.projected[where] ** 2) - np.mean(new.projected[where] ** 2))
        part = np.sqrt(max(square, 0.0))
        if part > max(MATTERS, SHARE * first[each.record, each.signal, each.channel]):  # eq. (1)
            return True
    return False


def worth_a_name(new: Fit, old: Fit) -> bool:
    """Whether a larger model that leaves a gap takes enough of it, or spares a strain."""
    return spares(new, old) or new.cost < (1.0 - DENT) * old.cost  # eq. (5)


def spares(new: Fit, old: Fit) -> bool:
    """Whether a larger model spares clocks, frames and nominal values a strain."""
    return strain(old) - strain(new) > STRAINED


def far_off(fit: Fit, null: Fit, problem: Problem) -> bool:
    """Whether a model leaves most of the gap that there is without effects, or of the strain if no gap."""
    if not beyond_noise(fit) > HALF * beyond_noise(null):
        return False
    return strain(fit) > HALF * strain(null) or leaves_gap(fit, null, problem)


def hardly_helps(fit: Fit, null: Fit) -> bool:
    """Whether a model explains little of the gap, and of the strain, that there is without effects."""
    left = 1.0 - LITTLE
    little = beyond_noise(fit) > left * beyond_noise(null)
    return little and (strain(fit) > left * strain(null) or strain(null) < STRAINED)


def beyond_noise(fit: Fit) -> float:
    """What a fit leaves of the squared gap, without what white noise of the stated size is of it."""
    return max(fit.cost - len(fit.residual), 0.0)


def implausibility(fit: Fit) -> float:
    """U: ln of how much likelier values are where they are most so."""
    known = [float(z) for c, z in zip(fit.parameters, fit.z, strict=True) if c.prior.scale != "uniform"]
    unknown = fit.projection.solve(fit.residual) / fit.nuisance.sigma
    return float(2.0 * np.sum(np.log1p(np.square([*known, *unknown]) / 3.0)))  # eq. (6)


def strain(fit: Fit) -> float:
    """By how many sigmas unknowns are beyond `FORBIDDEN` of them, summed."""
    z = np.abs(fit.projection.solve(fit.residual)) / fit.nuisance.sigma
    return float(np.sum(np.maximum(z - FORBIDDEN, 0.0)))  # eq. (2)


def explained(fit: Fit, null: Fit, problem: Problem) -> bool:
    """Whether nothing that matters is left above the noise, and no unknown is strained."""
    return quiet(fit, null, problem) and strain(fit) < STRAINED  # eq. (3)


def quiet(fit: Fit, null: Fit, problem: Problem) -> bool:
    """Whether nothing that matters is left above the noise, however strained unknowns are."""
    first = above_noise(null.projected, problem, null.non_smooth)
    left = above_noise(fit.projected, problem, fit.non_smooth)
    return all(left[c] <= max(MATTERS, LEFT_SHARE * first[c] / 2) for c in left)


def leaves_anything(fit: Fit, problem: Problem) -> bool:
    """Whether a fit leaves more than the noise, however small a part of the gap that is."""
    return max(above_noise(fit.projected, problem, fit.non_smooth).values()) > LEFT


def leaves_gap(fit: Fit, null: Fit, problem: Problem, share: float = LEFT_SHARE) -> bool:
    """Whether a fit leaves so much, or another share of the gap, that something else must be there."""
    first = max(above_noise(null.projected, problem, null.non_smooth).values())
    left = max(above_noise(fit.projected, problem, fit.non_smooth).values())
    return left > max(LEFT, share * first)  # eq. (4)


NEARLY = 0.1
"""Part of what the best model leaves by which another may always leave more."""


def limit_beside(found: Sequence[Fit], without: Fit, part: float) -> float:
    """C above which a fit is not finished: some `part` of the way from the best one back to none of them.

    However little the best one explains, what leaves a tenth more than it is near. Without any fit there is
    no limit.
    """
    least = min((f.cost for f in found), default=inf)
    return least if least == inf else (1 + NEARLY) * least + part * max(without.cost - least, 0.0)
