"""Which of several larger models is best: by the evidence of each over each.

Beside the smaller model all of them differ by the whole gap, and the simulation's error would hide what they
differ by; so they are compared with one another. Where all leave gaps and the evidence for none is strong,
the one that foretells best what is left out comes first.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cmp_to_key

import numpy as np

from flexarm.diagnosis.choosing.acceptance import STRONG, leaves_gap
from flexarm.diagnosis.choosing.evidence import log_bayes_factor, worth
from flexarm.diagnosis.choosing.left_out import missed
from flexarm.diagnosis.choosing.polish import polished
from flexarm.diagnosis.fitting.fit import Fit
from flexarm.diagnosis.fitting.fitter import Fitter
from flexarm.diagnosis.residuals.observed import Observed

CLOSE = 30.0
"""How far behind in ln Z a model is fitted with derivatives of its own."""


def best_of(fitter: Fitter, fits: Sequence[Fit], old: Fit, null: Fit) -> tuple[Fit, Fitter]:
    """The best fit, polished, with derivatives taken anew about those that come close."""
    observed = fitter.observed
    first, *others = _ranked(fits, old, null, observed)
    close = [f for f in others[:2] if _close(f, first, observed)]
    there = {}
    for fit in (first, *close):
        about = fitter.about(fit)
        there[about.fit(fit.members)] = about
    best = _ranked(list(there), old, null, observed)[0]
    return polished(best, there[best])


def _ranked(fits: Sequence[Fit], old: Fit, null: Fit, observed: Observed) -> list[Fit]:
    """The best first."""
    value = worth(min(fits, key=lambda f: f.cost).rest, observed)

    def behind(one: Fit, other: Fit) -> int:
        return int(np.sign(log_bayes_factor(other, one, observed, value)))

    ranked = sorted(fits, key=cmp_to_key(behind))
    strong = log_bayes_factor(ranked[0], old, observed, value) > STRONG
    if strong or not all(leaves_gap(f, null, observed) for f in fits):
        return ranked
    return sorted(fits, key=lambda f: missed(f, observed))


def _close(fit: Fit, first: Fit, observed: Observed) -> bool:
    """Whether a fit may be as good as the first with derivatives of its own."""
    value = worth(min((fit, first), key=lambda f: f.cost).rest, observed)
    return log_bayes_factor(first, fit, observed, value) < CLOSE
