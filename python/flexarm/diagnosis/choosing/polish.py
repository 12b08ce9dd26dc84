"""Fits repeated about themselves: at the model that it found, a fit takes derivatives by unknowns anew.

Clocks, frames and nominal values are eliminated to first order about the model that a fit starts from
(`fitting.projection`), and so is what its time steps miss. About the model that it found both are
better known, and the fit leaves less, until nothing moves any more. A law that is not smooth takes some
rounds.
"""

from __future__ import annotations

from flexarm.diagnosis.choosing.evidence import above_noise
from flexarm.diagnosis.fitting.fit import Fit
from flexarm.diagnosis.fitting.fitter import Fitter

ROUNDS, BETTER, QUIET = 6, 0.98, 0.4
"""Of `polished`: most rounds, what counts as less, and what is left above the noise where it ends."""
SETTLED = 1.0
"""Least fall of C in a round of `settled`: that of one sigma."""
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
    """A fit repeated about itself until it leaves no less, and where it was found."""
    best, there, idle = fit, about, 0
    for _ in range(ROUNDS):
        if idle == 2 or max(above_noise(best.rest, about.observed).values()) < QUIET:
            break
        about = about.about(fit)
        fit = about.fit(fit.members)
        idle = 0 if fit.cost < BETTER * best.cost else idle + 1
        if fit.cost < best.cost:
            best, there = fit, about
    return best, there


def settled(fit: Fit, about: Fitter) -> tuple[Fit, Fitter]:
    """A fit repeated about itself until C falls by less than one: until its values are those of the least C.

    What ends the search for names, a gap below the noise, leaves values that are off by several sigma where
    they act alike.
    """
    best, there = fit, about
    for _ in range(ROUNDS if fit.members else 0):
        about = about.about(fit)
        fit = about.fit(fit.members)
        if fit.cost > best.cost - SETTLED:
            return min((best, there), (fit, about), key=lambda pair: pair[0].cost)
        best, there = fit, about
    return best, there
