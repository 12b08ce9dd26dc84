"""Fits taken further: at the model that it found, a fit takes derivatives by unknowns anew.

Clocks, frames and nominal values are eliminated to first order about the model that a fit starts from
(`fitting.projection`), and so is what its time steps miss. About the model that it found both are better
known. A step or two in which all that is free moves together (`fitting.newton`) then finds what fits repeated
about themselves creep towards: where a link's stiffness and its modulus act alike these stop percents short.
"""

from __future__ import annotations

from contextlib import suppress

from flexarm.diagnosis.choosing.acceptance import STRAINED, strain
from flexarm.diagnosis.choosing.evidence import above_noise
from flexarm.diagnosis.fitting.fit import Fit
from flexarm.diagnosis.fitting.fitter import Fitter
from flexarm.diagnosis.fitting.newton import evaluated, objective, stepped
from flexarm.errors import InvalidParameter, NotConverged

ROUNDS, BETTER, QUIET = 6, 0.98, 0.4
"""Of `polished`: most rounds, what counts as less, and what is left above the noise where it ends."""
STILL, SETTLED = 1.0, 0.1
"""Least fall of C in a round of each, in squared sigmas: those of the noise or, above it, of what is left."""
ALIKE = 2
"""Rounds in which the model without effects is fitted about itself."""


def without_effects(start: Fit, fitter: Fitter) -> Fit:
    """The nominal model about its own optimum, as fits with effects are; otherwise any effect seems better.

    The search itself starts where clocks and frames are nominal, since effects may take their places.
    """
    best, there = start, fitter
    for _ in range(ALIKE):
        there = there.about(best)
        fit = there.fit(())
        if fit.cost > BETTER * best.cost:
            return min(fit, best, key=lambda f: f.cost)
        best = fit
    return best


def polished(fit: Fit, about: Fitter) -> tuple[Fit, Fitter]:
    """A fit taken further until it leaves no less, and where it was found."""
    best, there, idle = fit, about, 0
    for _ in range(ROUNDS):
        quiet = max(above_noise(best.rest, about.observed).values()) < QUIET
        if idle == 2 or (quiet and strain(best) < STRAINED):
            break
        ahead, about = further(best, there)
        fell = best.cost - ahead.cost
        idle = 0 if fell > (1 - BETTER) * best.cost else idle + 1
        if fell > 0:
            best, there = ahead, about
        if abs(fell) < STILL * sigma_squared(best):
            break
    return best, there


def further(fit: Fit, about: Fitter) -> tuple[Fit, Fitter]:
    """A step of Newton from a fit; where that leads up, as with laws that bend, a fit about what it found."""
    with suppress(InvalidParameter, NotConverged):
        here, at = evaluated(fit, about)
        ahead, there = stepped(here, at)
        if objective(ahead) < objective(here):
            return ahead, there
    there = about.about(fit)
    return there.fit(fit.members), there


def settled(fit: Fit, about: Fitter) -> tuple[Fit, Fitter]:
    """A fit taken further until it rests: its values are those of the least C.

    What ends the search for names, a gap below the noise, leaves values that are off by several sigma where
    they act alike, and rivals that are compared before they have come to rest seem apart that are not. All
    derivatives are of one model, or what acts alike would seem known apart.
    """
    best, there = fit, about
    for _ in range(ROUNDS if fit.members else 0):
        ahead, about = further(best, there)
        fell = objective(best) - objective(ahead)
        if fell > -STILL * sigma_squared(best):  # a fit's own C leaves out how derivatives change
            best, there = ahead, about
        if fell < SETTLED * sigma_squared(best):
            break
    return evaluated(best, there) if fit.members else (best, there)


def sigma_squared(fit: Fit) -> float:
    """Of a residual: one of noise alone, more where a gap is left."""
    return max(1.0, fit.cost / len(fit.residual))
