r"""Effects that are confounded with nuisance parameters in prior-data conflict.

A nuisance parameter far outside of its prior may compensate for an effect of the same response: a modulus for
a stiffer link, a clock for a late sensor. About the nominal model the responses may differ, as probes take
finite steps and the nominal arm swings out of phase with the machine. So both are compared about the fit in
conflict, with small steps. An effect with the derivatives D is confounded with a parameter u, of the response
:math:`J_u x_u`, where

.. math:: R_u^2 = 1 - \min_\alpha |J_u x_u - D \alpha|^2 / |J_u x_u|^2 > \text{confounded},               (1)

and with all that it is the `SAME` as, such as all of a frame. Its fit starts with these parameters at their
stated values, and with the size of equal response.

One effect may be confounded with several nuisance parameters at once: a longer link with two points off along
it. Their responses are added up, the most alike first, while each leaves at most half of what (1) misses. An
effect that explains such a sum better than any single response comes first.
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
"""Least R^2 of (1) of a further parameter that an effect replaces."""
TOGETHER = ""
"""Stands for several parameters in place of the key of one."""
PART = 1 / 3
"""Least part of the residual without parameters in conflict that these explain."""
SIZES = (0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0)
"""Factors of the size of equal response to first order, of which the best is the start of a fit."""

Conflicting = dict[str, tuple[Floats, float]]
"""Responses to nuisance parameters and their estimates, by key."""


@dataclass(frozen=True, eq=False)
class ConfoundedEffect:
    """An effect with the response of some nuisance parameters in conflict."""

    candidate: Candidate
    alphas: Floats
    """Multiples of its probes of equal response, to first order."""
    values: Mapping[str, float]
    """Estimates of the nuisance parameters that it replaces, by key."""

    def member(self, times: float = 1.0) -> Candidate:
        """Return the effect of the size of equal response, times a factor."""
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
    return confounded_fits(at, state.probed, here, near)


def confounded_fits(
    estimator: Estimator, probed: Sequence[Probed], best: Fit, near: float = inf
) -> list[Fit]:
    """Return fits of effects of `best` with one that is confounded with its parameters in conflict.

    The model is relinearised only about a fit with a cost below `near`. A fit that is worse than `best` is
    relinearised once more, unless another fit is better than `best` already. A fit that stays above another
    one is terminated.
    """
    found, lowest = [], inf
    for each in confounded_effects(estimator, probed, best):
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


def confounded_effects(estimator: Estimator, probed: Sequence[Probed], best: Fit) -> list[ConfoundedEffect]:
    """Return the effect most alike to all parameters in conflict together and to each, then the next ones.

    The parameters of the largest pull come first.
    """
    policy = estimator.problem.policy
    far = conflict(best, policy) > policy.conflict and _explain_residual(best, policy.pull)
    conflicting = _in_conflict(estimator, best) if far else {}
    alike: dict[str, list[tuple[float, ConfoundedEffect]]] = {key: [] for key in (TOGETHER, *conflicting)}
    for candidate, moves, of in _moves(estimator, probed, best, conflicting) if conflicting else ():
        for key, part, effect in _confounded(candidate, moves, of, policy):
            alike[key].append((part, effect))
    ranked = [[each for _, each in sorted(found, key=lambda one: -one[0])] for found in alike.values()]
    found: dict[tuple[str, Place], ConfoundedEffect] = {}
    for each in chain.from_iterable(zip_longest(*ranked)):
        if each is not None and len(found) < policy.proposals // 2:
            found.setdefault(each.candidate.place, each)
    return list(found.values())


def _explain_residual(best: Fit, pull: float) -> bool:
    """Return True if parameters in conflict explain a good part of the residual without them.

    Given a larger gap the conflict may be due to a missing effect, and that comes first.
    """
    far = np.abs(best.projection.solve(best.residual)) > pull * best.nuisance.sigma
    others = Projection(best.projection.jacobian[:, ~far], best.nuisance.sigma[~far]).project(best.residual)
    noise, without = len(best.residual), float(others @ others)
    return without - best.cost > PART * (without - noise)


def _moves(
    estimator: Estimator, probed: Sequence[Probed], best: Fit, conflicting: Conflicting
) -> Iterator[tuple[Candidate, Floats, Conflicting]]:
    """Yield absent effects, their responses about a fit, and those of parameters in conflict.

    Waves, and springs that another law needs, are never confounded.
    For clocks alone nothing is simulated: no motion of an arm looks like late readings.
    """
    free = [p.candidate for p in probed if not p.candidate.spots & best.spots]
    others: list[Candidate] = []
    for candidate in free:
        moves = linear_response(candidate, best.nuisance.keys, best.projection.jacobian)
        if moves is not None:
            yield candidate, moves, conflicting
        elif not (candidate.effect.is_wave or candidate.needs or same_in_small_steps(candidate, others)):
            others.append(candidate)
    kinds = {unknown.kind for unknown in best.nuisance.parameters if unknown.key in conflicting}
    if kinds != {"clock"}:
        with suppress(*FIT_ERRORS):  # the fit itself may fail in longer steps
            yield from _small_moves(estimator, others, best, conflicting)


def _confounded(
    candidate: Candidate, moves: Floats, conflicting: Conflicting, policy: SelectionPolicy
) -> Iterator[tuple[str, float, ConfoundedEffect]]:
    """Yield the key of a parameter, R^2 of (1), and the effect that is confounded with it."""
    parts = {key: _part(move, moves) for key, (move, _) in conflicting.items()}
    found = [
        (key, part, [other for other in parts if other == key or parts[other] > SAME])
        for key, part in parts.items()
    ]
    for key, part, keys in [_together(moves, conflicting, parts, policy.halfway), *found]:
        if part > policy.confounded and possible(
            candidate, alphas := _alphas(moves, _moved(conflicting, keys))
        ):
            yield (
                key,
                part,
                ConfoundedEffect(candidate, alphas, {other: conflicting[other][1] for other in keys}),
            )


def _together(
    moves: Floats, conflicting: Conflicting, parts: Mapping[str, float], half: float
) -> tuple[str, float, list[str]]:
    """Return the parameters that an effect replaces better together than any alone, and R^2 of (1)."""
    first, *others = sorted(parts, key=lambda key: -parts[key])
    part, keys = parts[first], [first]
    for key in others:
        more = _part(_moved(conflicting, [*keys, key]), moves)
        if 1.0 - more < half * (1.0 - part):
            part, keys = more, [*keys, key]
    return TOGETHER, part if len(keys) > 1 else 0.0, keys


def _moved(conflicting: Conflicting, keys: Sequence[str]) -> Floats:
    """Return the joint response of some nuisance parameters."""
    return np.asarray(np.sum([conflicting[key][0] for key in keys], axis=0))


def _matched(estimator: Estimator, effect: ConfoundedEffect, best: Fit) -> Candidate:
    """Return the effect of the size whose simulated response is closest to that of the parameters.

    It is the start of a fit, so longer time steps are enough.
    """
    problem = estimator.problem.with_step(LONGER * estimator.problem.step)
    there = estimator.moved_to(dict.fromkeys(effect.values, 0.0))
    wanted = problem.residual(estimator.moved_to(effect.values).with_effects(best.members))
    models, sizes = {}, {}
    for times in SIZES:
        with suppress(*FIT_ERRORS):
            models[times] = there.with_effects((*best.members, effect.member(times)))
    problem.prepare(models.values())
    for times, arm in models.items():
        with suppress(*FIT_ERRORS):
            sizes[times] = problem.residual(arm) - wanted
    return effect.member(min(sizes, key=lambda times: float(sizes[times] @ sizes[times]), default=1.0))


def _in_conflict(estimator: Estimator, best: Fit) -> Conflicting:
    """Return response and estimate of each parameter beyond `SelectionPolicy.pull`, the largest pull first.

    The estimate is the simulated value, or else that of the linear fit.
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
    estimator: Estimator, others: Sequence[Candidate], best: Fit, conflicting: Conflicting
) -> Iterator[tuple[Candidate, Floats, Conflicting]]:
    """Yield the same for effects whose response takes simulations, with small changes and longer steps."""
    problem = estimator.problem.with_step(LONGER * estimator.problem.step)
    there = estimator.with_effects(best.members)
    slopes = problem.jacobian(there, list(conflicting), estimator.nuisance.steps(there))
    of = {key: (slopes[:, k] * at, at) for k, (key, (_, at)) in enumerate(conflicting.items())}
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
