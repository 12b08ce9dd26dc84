"""What is said of effects: names with their probabilities and alternatives, and what was rejected.

A probability is that of the evidence among rivals within reach and no effect at all (eq. (1) of
`choosing.rivals`), with two doubts that evidence does not know: some mechanism may be in no
vocabulary, and an effect whose parameter moves from record to record, or beside which a gap stays open, a
clock, a frame or a nominal value strained (eq. (2) of `choosing.acceptance`), or beside an encoder of which
coarse steps hide what moved, is at most as likely as not.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flexarm.diagnosis.candidates.candidate import Candidate
from flexarm.diagnosis.choosing.acceptance import REACH, STRAINED, strain
from flexarm.diagnosis.choosing.choose import Choice
from flexarm.diagnosis.choosing.evidence import log_bayes_factor
from flexarm.diagnosis.choosing.rivals import probabilities
from flexarm.diagnosis.named import Alternative, NamedEffect, Rejected
from flexarm.diagnosis.outcome.estimates import Estimates
from flexarm.diagnosis.outcome.evidence_sentence import evidence_sentence
from flexarm.diagnosis.residuals.observed import Observed

CAP = 0.98
"""Greatest probability of a name: some mechanism may be in no vocabulary."""
CONFIDENT = 0.5
"""Greatest probability of a name whose parameter moves, or beside what nothing explains."""
IN_ITS_PLACE = "less likely in the place of a named effect"
ON_THE_WAY = "less likely as it was tried on the way"
"""Why a candidate was not taken."""
LOST = "what the encoder lost between its counts may look like it, so that it is at most as likely as not"
"""Said of a name beside an encoder that counts in steps."""

Drift = Mapping[str, Any]
"""An effect's parameter fitted to each record, of `choosing.constancy`."""


def named_effects(
    choice: Choice,
    sizes: Estimates,
    drifts: Sequence[Drift],
    open_gap: bool,
    observed: Observed,
    coarse: bool = False,
) -> tuple[NamedEffect, ...]:
    """The chosen effects, each with its rivals within reach, the most probable first.

    `coarse` says that an encoder counts in steps that matter.
    """
    doubtful = open_gap or coarse or strain(choice.best) > STRAINED
    found = []
    for k, (member, rivals) in enumerate(zip(choice.best.members, choice.rivals, strict=True)):
        near = [rival for rival in rivals if rival.within_reach]
        odds = [min(p, CAP) for p in probabilities(near, choice.needed[k])]
        moving = [drift for drift in drifts if _moves(drift, member)]
        first = min(odds[0], CONFIDENT) if moving or doubtful else odds[0]
        alternatives = tuple(
            Alternative(rival.candidate.name, rival.candidate.at, p)
            for rival, p in zip(near, odds[1:], strict=True)
        )
        evidence = evidence_sentence(choice, k, moving, open_gap, observed)
        if coarse:
            evidence = f"{evidence.removesuffix('.')}; {LOST}."
        found.append(NamedEffect(member.name, member.at, first, sizes.effects[k], alternatives, evidence))
    return tuple(sorted(found, key=lambda effect: -effect.probability))


def _moves(drift: Drift, member: Candidate) -> bool:
    """Whether it is an effect's first parameter that is not constant."""
    first = (*member.place, member.free[0])
    return (drift["effect"], drift["at"], drift["parameter"]) == first and not drift["constant"]


def rejected(choice: Choice, observed: Observed) -> tuple[Rejected, ...]:
    """Rivals out of reach, and what was tried on the way; alternatives are neither."""
    found: dict[tuple[str, str], Rejected] = {}
    near = {rival.candidate.place for rivals in choice.rivals for rival in rivals if rival.within_reach}
    chosen = {*choice.best.places, *near}
    for rivals in choice.rivals:
        for rival in rivals:
            place = rival.candidate.place
            if not rival.within_reach and place not in chosen:
                found[place] = Rejected(*place, -rival.behind, IN_ITS_PLACE)
    for fit, _ in choice.tried:
        for place in fit.places:
            if place not in chosen and place not in found:
                behind = log_bayes_factor(fit, choice.best, observed, choice.value)
                if behind < -REACH:
                    found[place] = Rejected(*place, behind, ON_THE_WAY)
    return tuple(sorted(found.values(), key=lambda each: -each.log_bayes_factor))
