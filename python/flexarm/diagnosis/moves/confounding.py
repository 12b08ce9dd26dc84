r"""Effects that take over what a clock, a frame or a nominal value is strained to do.

A value far outside of what is stated of it stands in for an effect that moves the arm as it does: a modulus
for a link that is stiffer, a clock for a sensor that is late. About the nominal model the two may look apart,
as the finite steps of probes bend, and as that model's arm swings out of step with the machine's. So both are
laid side by side about the fit that is strained, with small steps. An effect with the derivatives D takes
over the move :math:`J_u x_u` of an unknown u where

.. math:: R_u^2 = 1 - \min_\alpha |J_u x_u - D \alpha|^2 / |J_u x_u|^2 > \text{confounded},               (1)

and with it what else it is the `SAME` as, such as all of a frame. Its fit starts with these nuisance
parameters back where they are stated, and with the size that makes up for them.

What one effect moves may be told as several nuisance parameters at once: a longer link as two points off
along it, each of which moves a part of that. The moves of nuisance parameters are added up, the most alike
first, while each leaves at most half of what (1) misses. An effect that does better so than with any of them
goes before all others.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain, zip_longest
from math import inf

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.acceptance import conflict
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import FIT_ERRORS, Fit, Projection
from flexarm.diagnosis.moves.search_state import SearchState, same_in_small_steps, small_steps
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.screening import LONGER, Probed, linear_response, possible
from flexarm.named_effects import Place

SAME = 0.98
"""Least part of what another unknown moves for an effect to take it along, eq. (1)."""
TOGETHER = ""
"""Instead of the key of one unknown: several of them."""
PART = 1 / 3
"""Least part of what would be left without strained nuisance parameters that they explain."""
SIZES = (0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0)
"""Times what makes up for the nuisance parameters to first order that are tried, to start where it does so
best.
"""

Strained = dict[str, tuple[Floats, float]]
"""Responses to nuisance parameters and their estimates, by key."""


@dataclass(frozen=True, eq=False)
class Takeover:
    """An effect that does what some nuisance parameters are strained to do."""

    candidate: Candidate
    """The effect."""
    alphas: Floats
    """How much of its probes that is, to first order."""
    values: Mapping[str, float]
    """The nuisance parameters that it takes over, and where they are."""

    def member(self, times: float = 1.0) -> Candidate:
        """Return the effect of that size, or of so many times that size."""
        sized = self.candidate.sized((times * self.alphas).tolist())
        return replace(self.candidate, effect=sized)


def confounding(state: SearchState, best: Fit, about: Estimator, found: Sequence[Fit]) -> list[Fit]:
    """Propose effects in the place of nuisance parameters in conflict, unless another explains everything.

    Sizes count from stated values.
    """
    if any(state.criteria.explains(fit) for fit in found):
        return []
    here, at = (best, about) if best.members else (state.null, state.about_null)
    near = state.criteria.early_stop(found, here, state.criteria.policy.halfway)
    return taken_over(at, state.probed, here, near)


def taken_over(estimator: Estimator, probed: Sequence[Probed], best: Fit, near: float = inf) -> list[Fit]:
    """Fits of what could take over what nuisance parameters of `best` are strained to do, beside its effects.

    Derivatives are taken anew only about a fit that comes `near` others with those at hand. Where others must
    make room, derivatives at the start lead nowhere; then they are taken once more, unless another fit is
    better than `best` already. A fit that stays above another one is not finished.
    """
    found, lowest = [], inf
    for each in takeovers(estimator, probed, best):
        with suppress(*FIT_ERRORS):
            members = (*best.members, _matched(estimator, each, best))
            if near < inf:
                there = estimator.moved_to(dict.fromkeys(each.values, 0.0))
                if there.fit(members, limit=near, nearby=best).cost > near:
                    continue
            fit = estimator.as_stated(each.values, members).fit(members, limit=lowest, nearby=best)
            if fit.cost > best.cost and lowest > best.cost:
                fit = estimator.about(fit).fit(fit.members, limit=lowest, nearby=fit)
            lowest = min(lowest, fit.cost)
            found.append(fit)
    return found


def takeovers(estimator: Estimator, probed: Sequence[Probed], best: Fit) -> list[Takeover]:
    """Return what is most alike of several strained nuisance parameters together and of each, then what is so
    next.

    The most strained ones come first.
    """
    policy = estimator.problem.policy
    far = conflict(best, policy) > policy.conflict and _stand_in(best, policy.pull)
    strained = _strained(estimator, best) if far else {}
    alike: dict[str, list[tuple[float, Takeover]]] = {key: [] for key in (TOGETHER, *strained)}
    for candidate, moves, of in _moves(estimator, probed, best, strained) if strained else ():
        for key, part, takeover in _takes_over(candidate, moves, of, policy):
            alike[key].append((part, takeover))
    ranked = [[each for _, each in sorted(found, key=lambda one: -one[0])] for found in alike.values()]
    found: dict[tuple[str, Place], Takeover] = {}
    for each in chain.from_iterable(zip_longest(*ranked)):
        if each is not None and len(found) < policy.proposals // 2:
            found.setdefault(each.candidate.place, each)
    return list(found.values())


def _stand_in(best: Fit, pull: float) -> bool:
    """Return True if strained nuisance parameters explain a good part of what would be left with them where
    they are stated.

    Beside a larger gap they are strained by what else is missing, and that comes first.
    """
    far = np.abs(best.projection.solve(best.residual)) > pull * best.nuisance.sigma
    others = Projection(best.projection.jacobian[:, ~far], best.nuisance.sigma[~far]).project(best.residual)
    noise, without = len(best.residual), float(others @ others)
    return without - best.cost > PART * (without - noise)


def _moves(
    estimator: Estimator, probed: Sequence[Probed], best: Fit, strained: Strained
) -> Iterator[tuple[Candidate, Floats, Strained]]:
    """Effects that are not there, with derivatives by the sizes of their probes about a fit.

    Beside them what strained nuisance parameters move in the same simulations. Nothing is simulated for
    clocks alone: late readings look like nothing that an arm does.
    """
    free = [p.candidate for p in probed if not p.candidate.spots & best.spots]
    others: list[Candidate] = []
    for candidate in free:
        moves = linear_response(candidate, best.nuisance.keys, best.projection.jacobian)
        if moves is not None:
            yield candidate, moves, strained
        elif not _unlike(candidate, others):
            others.append(candidate)
    kinds = {unknown.kind for unknown in best.nuisance.parameters if unknown.key in strained}
    if kinds != {"clock"}:
        with suppress(*FIT_ERRORS):  # of the fit itself, in longer steps
            yield from _small_moves(estimator, others, best, strained)


def _unlike(candidate: Candidate, others: Sequence[Candidate]) -> bool:
    """Return True if an effect moves nothing as an unknown does, or as it does in small steps of another
    variant.

    Waves have frequencies of their own, and a spring that another law needs moves the arm by itself.
    """
    again = same_in_small_steps(candidate, others)
    return candidate.effect.is_wave or candidate.needs is not None or again


def _takes_over(
    candidate: Candidate, moves: Floats, strained: Strained, policy: SelectionPolicy
) -> Iterator[tuple[str, float, Takeover]]:
    """NuisanceModel that an effect takes over, R^2 of (1), and how."""
    parts = {key: _part(move, moves) for key, (move, _) in strained.items()}
    found = [
        (key, part, [other for other in parts if other == key or parts[other] > SAME])
        for key, part in parts.items()
    ]
    for key, part, keys in [_together(moves, strained, parts, policy.halfway), *found]:
        if part > policy.confounded and possible(candidate, alphas := _alphas(moves, _moved(strained, keys))):
            yield key, part, Takeover(candidate, alphas, {other: strained[other][1] for other in keys})


def _together(
    moves: Floats, strained: Strained, parts: Mapping[str, float], half: float
) -> tuple[str, float, list[str]]:
    """NuisanceModel that an effect does better for all at once than for any of them, and R^2 of (1)."""
    first, *others = sorted(parts, key=lambda key: -parts[key])
    part, keys = parts[first], [first]
    for key in others:
        more = _part(_moved(strained, [*keys, key]), moves)
        if 1.0 - more < half * (1.0 - part):
            part, keys = more, [*keys, key]
    return TOGETHER, part if len(keys) > 1 else 0.0, keys


def _moved(strained: Strained, keys: Sequence[str]) -> Floats:
    """Return what some nuisance parameters move together."""
    return np.asarray(np.sum([strained[key][0] for key in keys], axis=0))


def _matched(estimator: Estimator, takeover: Takeover, best: Fit) -> Candidate:
    """Return the effect of the size that moves residuals most as the nuisance parameters do where they are.

    A spring, say, adds to what gives way, of which a modulus a sixth too small has a fifth too much. It is
    where a fit starts; longer steps are enough.
    """
    problem = estimator.problem.with_step(LONGER * estimator.problem.step)
    there = estimator.moved_to(dict.fromkeys(takeover.values, 0.0))
    wanted = problem.residual(estimator.moved_to(takeover.values).with_effects(best.members))
    sizes = {}
    for times in SIZES:
        with suppress(*FIT_ERRORS):
            member = takeover.member(times)
            sizes[times] = problem.residual(there.with_effects((*best.members, member))) - wanted
    return takeover.member(min(sizes, key=lambda times: float(sizes[times] @ sizes[times]), default=1.0))


def _strained(estimator: Estimator, best: Fit) -> Strained:
    """Return what each unknown beyond `SelectionPolicy.pull` moves, and where it is, the most strained first.

    That is where it is simulated, or else where it would have to be.
    """
    values = best.projection.solve(best.residual)
    far = np.abs(values) / best.nuisance.sigma
    simulated = dict(zip(estimator.nuisance.keys, estimator.at, strict=True))
    found = {}
    for k in np.argsort(-far):
        unknown = best.nuisance.parameters[k]
        if unknown.kind != "start" and far[k] > estimator.problem.policy.pull:
            at = float(simulated[unknown.key] or values[k])
            found[unknown.key] = (best.projection.jacobian[:, k] * at, at)
    return found


def _small_moves(
    estimator: Estimator, others: Sequence[Candidate], best: Fit, strained: Strained
) -> Iterator[tuple[Candidate, Floats, Strained]]:
    """Those derivatives from small steps of each effect, in simulations of longer steps."""
    problem = estimator.problem.with_step(LONGER * estimator.problem.step)
    there = estimator.with_effects(best.members)
    slopes = problem.jacobian(there, list(strained), estimator.nuisance.steps(there))
    of = {key: (slopes[:, k] * at, at) for k, (key, (_, at)) in enumerate(strained.items())}
    for candidate, steps in zip(others, small_steps(estimator, others, best), strict=True):
        if steps is not None:
            yield candidate, steps.moves, of


def _part(move: Floats, moves: Floats) -> float:
    """R^2 of (1)."""
    left = move - moves @ _alphas(moves, move)
    return 1.0 - float(left @ left) / float(move @ move)


def _alphas(moves: Floats, move: Floats) -> Floats:
    """Sizes of the minimum in (1)."""
    return np.asarray(np.linalg.lstsq(moves, move, rcond=None)[0], dtype=float)
