"""Names of effects with their probabilities, alternatives and evidence, and remarks on signals and loads.

A probability is that of the evidence among alternatives within reach and no effect at all (eq. (1) of
`diagnosis.alternatives`), with three limits that evidence does not know. Some mechanism may be in no
vocabulary. An effect whose parameter differs between records or rests where fits end, or that coarse steps of
an encoder may imitate, is at most as likely as not. Where a gap stays that no effect explains, an effect may
imitate a part of its cause: its probability is at most the part of the gap, where it acts, that it explains.
A gap elsewhere does not make it less likely.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from flexarm.comparison.alignment_parameters import has_noise, uncertain_clock_and_frame
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.alternatives import probabilities
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.cross_validation import press_rms
from flexarm.diagnosis.evidence import above_noise, log_bayes_factor
from flexarm.diagnosis.family import EffectFamily, clear_places
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.nuisance import known_loads
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.residual_rows import greatest_by_signal
from flexarm.diagnosis.selection import Choice
from flexarm.diagnosis.uncertainty import Estimates, sizes_at_bounds
from flexarm.named_effects import Alternative, NamedEffect, Place, Rejected
from flexarm.record import Signal
from flexarm.wording import SPELT_OUT, listed, number, place_words, with_unit

SHRUNK = 0.95
"""Greatest part of a gap that is left where it counts as reduced."""
UNUSUAL = 3.0
"""Sigmas of its prior from which a parameter is unusual."""


def evidence_sentence(
    choice: Choice, k: int, moving: Sequence[Mapping[str, Any]], open_gap: bool, problem: Problem
) -> str:
    """Return the evidence for and against effect k of a choice in one sentence."""
    best = choice.best
    text = _shrinking(choice, k, problem)
    if choice.alternatives[k]:
        first = choice.alternatives[k][0]
        text += f"; next is {place_words(*first.candidate.place)}, {_behind(first.behind, choice.needed[k])}"
    if open_gap:
        with_it, without = (number(press_rms(fit, problem), 2) for fit in (best, choice.null))
        they = "it" if len(best.members) == 1 else "all of them"
        text += (
            f"; parts of the data that are left out of the fit are missed by {with_it} times the noise with "
            f"{they}, by {without} without"
        )
    if Criteria(problem, choice.null).in_conflict(best):
        worst = _conflict_clause(best, problem.policy.pull)
        text += f"; even with it {worst}, so that something else may be missing"
    for name, value, unit in best.members[k].held():
        text += f"; its {name} is {number(value)}{'' if unit == '-' else f' {unit}'}"
    known = _known_places(best, best.members[k], problem.policy.strong_evidence)
    text += "".join(f"; {said}" for said in (*known, *_unusual(best, k)))
    for each in moving:
        text += (
            f"; its {each['parameter']} moves with the {each['moves_with']}, which a right name's does not"
        )
    return text + "."


def _shrinking(choice: Choice, k: int, problem: Problem) -> str:
    """Return a clause on what an effect explains; of the first one on the gap and the conflicts of all."""
    members = [place_words(each.name, each.at) for each in choice.best.members]
    alone = len(members) == 1
    before = max(above_noise(choice.null.projected, problem, choice.null.non_smooth).values())
    after = max(above_noise(choice.best.projected, problem, choice.best.non_smooth).values())
    it = "it" if alone or k else members[k]
    stated = any(problem.arm.effect(*spot) is not None for spot in choice.best.members[k].spots)
    over = f"with {it} as stated" if stated else f"without {it}"
    gained = f"(ln Bayes factor {_factor(choice.needed[k])} over the model {over})"
    if k:
        others = listed(members[:k] + members[k + 1 :])
        return f"beside {others} the data ask for {members[k]} too {gained}"
    spared = _conflict_clause(choice.null, UNUSUAL)
    if spared and after >= SHRUNK * before:
        return (
            f"with clocks, frames and nominal values fitted along the largest gap above the noise is "
            f"{number(after, 2)} times the noise, with {listed(members)} or without; but without "
            f"{'it' if alone else 'them'} {spared} {gained}; if that sigma is too small, no effect is missing"
        )
    shrinks = (
        f"falls from {number(before, 2)} to {number(after, 2)}"
        if after < SHRUNK * before
        else f"stays at {number(after, 2)}"
    )
    text = f"with {listed(members)} the largest gap above the noise {shrinks} times the noise {gained}"
    return text + (f"; without {'it' if alone else 'them'} {spared}" if spared else "")


def _behind(alternative: float, gained: float) -> str:
    """Return how far behind an alternative is; no number beyond what the effect gains over none.

    Bayes factors of pairs do not add up: the more two models differ, the more the error of the simulation
    counts (eq. (3) of `diagnosis.evidence`).
    """
    return f"behind by a ln Bayes factor of {_factor(alternative)}" if alternative <= gained else "far behind"


def _factor(log_bayes: float) -> str:
    """Return a log Bayes factor as text."""
    return f"{log_bayes:.1f}" if abs(log_bayes) < 10 else f"{log_bayes:.0f}"


def _conflict_clause(fit: Fit, beyond: float) -> str:
    """Return a clause on the largest pull of a nuisance parameter; empty within `beyond` sigmas."""
    pulls = np.abs(fit.projection.solve(fit.residual)) / fit.nuisance.sigma
    if not pulls.max(initial=0.0) > beyond:
        return ""
    worst = int(np.argmax(pulls))
    words, times = fit.nuisance.parameters[worst].words, number(pulls[worst], 2)
    return f"the {words} would be off by {times} times its stated sigma"


def _known_places(fit: Fit, member: Candidate, strong: float) -> Iterator[str]:
    """Yield the places of a family where the data determine its size."""
    if isinstance(member, EffectFamily):
        clear, count = clear_places(fit, member, strong), len(member.members)
        where = listed(clear) if len(clear) <= SPELT_OUT else f"{len(clear)} places"
        if len(clear) < count:
            yield f"its size is known by itself at {where or 'none of them'}, elsewhere taken alike"


def _unusual(fit: Fit, k: int) -> Iterator[str]:
    """Yield parameters of an effect that are far from their priors."""
    for parameter, z in zip(fit.parameters, fit.z, strict=True):
        own = parameter.weight < 1.0  # its own, not a hierarchical one
        if parameter.candidate == k and own and abs(z) > UNUSUAL and parameter.prior.scale != "uniform":
            prior, value = parameter.prior, parameter.value(float(z))
            low, high = (with_unit(end, prior.unit) for end in (prior.low, prior.high))
            yield (
                f"its {parameter.name} of {with_unit(value, prior.unit)} is unusual, 95 % of machines have "
                f"{low} to {high}"
            )


IN_ITS_PLACE = "less likely in the place of a named effect"
ON_THE_WAY = "less likely as it was tried on the way"
"""Why a candidate was not taken."""
QUANTISED = (
    "what the encoder lost between its counts may look like it, so that it is at most as likely as not"
)
"""Reason for doubt where an encoder counts in coarse steps."""

Drift = Mapping[str, Any]
"""An effect's parameter fitted to each record, of `diagnosis.fit_statistics`."""


def named_effects(
    choice: Choice,
    sizes: Estimates,
    drifts: Sequence[Drift],
    open_gap: bool,
    problem: Problem,
    coarse: bool = False,
) -> tuple[NamedEffect, ...]:
    """Return the chosen effects, each with its alternatives within reach, the most probable first.

    `coarse` is True if an encoder counts in steps that matter.
    """
    policy = problem.policy
    at_bounds = [parameter.candidate for _, parameter, _ in sizes_at_bounds(choice.best)]
    found = []
    for k, (member, models) in enumerate(zip(choice.best.members, choice.alternatives, strict=True)):
        near = [model for model in models if model.within_reach]
        odds = [min(p, policy.most_certain) for p in probabilities(near, choice.needed[k])]
        first_parameter = (*member.place, member.free[0])
        moving = [
            drift
            for drift in drifts
            if (drift["effect"], drift["at"], drift["parameter"]) == first_parameter and not drift["constant"]
        ]
        first = min(odds[0], 0.5) if moving or coarse or k in at_bounds else odds[0]
        if open_gap:
            first = min(first, choice.shares[k])
        alternatives = tuple(
            Alternative(each.candidate.name, each.candidate.at, p)
            for each, p in zip(near, odds[1:], strict=True)
        )
        evidence = evidence_sentence(choice, k, moving, open_gap, problem)
        if coarse:
            evidence = f"{evidence.removesuffix('.')}; {QUANTISED}."
        found.append(NamedEffect(member.name, member.at, first, sizes.effects[k], alternatives, evidence))
    return tuple(sorted(found, key=lambda effect: -effect.probability))


def rejected(choice: Choice, problem: Problem) -> tuple[Rejected, ...]:
    """Return effects out of reach, and those that were tried on the way."""
    found: dict[tuple[str, Place], Rejected] = {}
    near = {
        alternative.candidate.place
        for alternatives in choice.alternatives
        for alternative in alternatives
        if alternative.within_reach
    }
    chosen = {*choice.best.places, *near}
    for alternatives in choice.alternatives:
        for alternative in alternatives:
            place = alternative.candidate.place
            if not alternative.within_reach and place not in chosen:
                found[place] = Rejected(*place, -alternative.behind, IN_ITS_PLACE)
    for fit in choice.tried:
        for place in fit.places:
            if place not in chosen and place not in found:
                behind = log_bayes_factor(fit, choice.best, problem)
                if behind < -problem.policy.reach:
                    found[place] = Rejected(*place, behind, ON_THE_WAY)
    return tuple(sorted(found.values(), key=lambda each: -each.log_bayes_factor))


REPORTED = 1.0
"""Least initial vibration that is reported, over the noise."""


def transient_remarks(fit: Fit, problem: Problem) -> Iterator[str]:
    """Yield a remark on each record with an initial vibration, which the gaps of a report include."""
    x = fit.projection.solve(fit.residual)
    for name in problem.records:
        mine = [fit.nuisance.keys.index(s.key) for s in problem.initial_conditions if s.record == name]
        move = fit.projection.jacobian[:, mine] @ x[mine]
        most = {each: float(np.abs(move[each.where]).max()) for each in problem.rows_of(name)}
        each = max(most, key=lambda rows: most[rows], default=None)
        if mine and each is not None and most[each] > REPORTED:
            unit = problem.records[name].signals[each.signal].unit
            size = with_unit(most[each] * each.sigma, unit)
            yield (
                f"{name} begins with the arm swinging, by up to {size} at {each.signal}: that is fitted "
                "along, and still part of the gaps told here"
            )


_SILENT = "no noise is stated, and its values are too few or too even to show it"


def noise_remarks(problem: Problem) -> Iterator[str]:
    """Yield a remark on each signal without a stated noise: the noise used, and what it does not align."""
    silent = (r for r in problem.rows if not has_noise(_signal(problem, r.record, r.signal).noise_std))
    for name, sigma in greatest_by_signal(silent, lambda rows: rows.sigma).items():
        own = [(each, each.signals[name]) for each in problem.records.values() if name in each.signals]
        places = dict.fromkeys(place for pair in own for place in uncertain_clock_and_frame(*pair))
        noise = with_unit(sigma, own[0][1].unit, 2)
        text = f"no noise is stated for {name}: the {noise} that its values show count instead"
        if places:
            text += f"; the gaps before and after are not aligned by it, in {listed(list(places))}"
        yield text


def unfitted_remarks(problem: Problem, compared: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """Yield a remark on each signal, `compared` with the model by record, of which no value is fitted."""
    seen = {(rows.record, rows.signal) for rows in problem.rows}
    for record in problem.records:
        for name in compared.get(record, ()):
            if (record, name) not in seen:
                stated = has_noise(_signal(problem, record, name).noise_std)
                why = "none of its values lies in the time of the drives" if stated else _SILENT
                yield f"{record}: {name} is not fitted: {why}"


def payload_remarks(problem: Problem) -> Iterator[str]:
    """Yield a remark on each payload whose mass the records state and whose uncertainty the model states."""
    for load in known_loads(problem.arm, problem.records):
        yield (
            f"the mass of {load} is what the records state, and its uncertainty in the model has no part: "
            "if it was weighed wrongly, leave it out of the records, or other effects stand in for it"
        )


def _signal(problem: Problem, record: str, name: str) -> Signal:
    return problem.records[record].signals[name]
