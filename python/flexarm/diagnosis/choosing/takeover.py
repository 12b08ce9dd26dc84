r"""Effects that take over what a clock, a frame or a nominal value is strained to do.

A value far outside of what is stated of it stands in for an effect that moves the arm as it does: a modulus
for a link that is stiffer, a clock for a sensor that is late. About the nominal model the two may look apart,
as the finite steps of probes bend, and as that model's arm swings out of step with the machine's. So both are
laid side by side about the fit that is strained, with small steps. An effect with the derivatives D takes
over the move :math:`J_u x_u` of an unknown u where

.. math:: R_u^2 = 1 - \min_\alpha |J_u x_u - D \alpha|^2 / |J_u x_u|^2 > \text{ALIKE},               (1)

and with it what else it is the `SAME` as, such as all of a frame. Its fit starts with these unknowns back
where they are stated, and with the size that makes up for them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain, zip_longest
from math import isfinite

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.diagnosis.candidates.candidate import SPRINGS, WAVES, Candidate, value_of
from flexarm.diagnosis.candidates.candidate_probes import nulls
from flexarm.diagnosis.choosing.acceptance import FORBIDDEN, STRAINED, strain
from flexarm.diagnosis.choosing.screen import LONGER, Probed, in_proportion, possible
from flexarm.diagnosis.fitting.fit import FAILED, Fit
from flexarm.diagnosis.fitting.fitter import Fitter
from flexarm.diagnosis.fitting.projection import Projection

ALIKE, SAME = 0.8, 0.98
"""Least part of what an unknown moves that an effect takes over, eq. (1); of others that it takes along."""
SMALL = 1e-3
"""Part of a probe that is a small step; at 0.03 a spring in a joint that was rigid bends too much."""
PART = 1 / 3
"""Least part of what would be left without strained unknowns that they explain."""
TAKEN = 3
"""Effects that are fitted."""
SIZES = (0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0)
"""Times what makes up for the unknowns to first order that are tried, to start where it does so best."""

Strained = dict[str, tuple[Floats, float]]
"""What unknowns move, and where they are, by their keys."""


@dataclass(frozen=True, eq=False)
class Takeover:
    """An effect that does what some unknowns are strained to do.

    Attributes
    ----------
    candidate : Candidate
        The effect.
    alphas : ndarray
        How much of its probes that is, to first order.
    values : dict of str to float
        The unknowns that it takes over, and where they are.
    """

    candidate: Candidate
    alphas: Floats
    values: Mapping[str, float]

    def member(self, times: float = 1.0) -> Candidate:
        """The effect of that size, or of so many times that size."""
        sized = self.candidate.sized((times * self.alphas).tolist())
        return replace(self.candidate, effect=sized)


def taken_over(fitter: Fitter, probed: Sequence[Probed], best: Fit) -> list[Fit]:
    """Fits of what could take over what unknowns of `best` are strained to do, beside its effects.

    Where others must make room, derivatives at the start lead nowhere; then they are taken anew.
    """
    found = []
    for each in takeovers(fitter, probed, best):
        with suppress(*FAILED):
            members = (*best.members, _matched(fitter, each, best))
            fit = fitter.as_stated(each.values, members).fit(members, nearby=best)
            if fit.cost > best.cost:
                fit = fitter.about(fit).fit(fit.members, nearby=fit)
            found.append(fit)
    return found


def takeovers(fitter: Fitter, probed: Sequence[Probed], best: Fit) -> list[Takeover]:
    """Of each strained unknown what is most alike, then what is so next, the most strained ones first."""
    strained = _strained(fitter, best) if strain(best) > STRAINED and _stand_in(best) else {}
    alike: dict[str, list[tuple[float, Takeover]]] = {key: [] for key in strained}
    for candidate, moves, of in _moves(fitter, probed, best, strained) if strained else ():
        for key, part, takeover in _takes_over(candidate, moves, of):
            alike[key].append((part, takeover))
    ranked = [[each for _, each in sorted(found, key=lambda one: -one[0])] for found in alike.values()]
    found: dict[tuple[str, str], Takeover] = {}
    for each in chain.from_iterable(zip_longest(*ranked)):
        if each is not None and len(found) < TAKEN:
            found.setdefault(each.candidate.place, each)
    return list(found.values())


def _stand_in(best: Fit) -> bool:
    """Whether strained unknowns explain a good part of what would be left with them where they are stated.

    Beside a larger gap they are strained by what else is missing, and that comes first.
    """
    far = np.abs(best.projection.best(best.residual)) > FORBIDDEN * best.unknowns.sigma
    others = Projection(best.projection.slopes[:, ~far], best.unknowns.sigma[~far]).rest(best.residual)
    noise, without = len(best.residual), float(others @ others)
    return without - best.cost > PART * (without - noise)


def _moves(
    fitter: Fitter, probed: Sequence[Probed], best: Fit, strained: Strained
) -> Iterator[tuple[Candidate, Floats, Strained]]:
    """Effects that are not there, with derivatives by the sizes of their probes about a fit.

    Beside them what strained unknowns move in the same simulations. Nothing is simulated for clocks alone:
    late readings look like nothing that an arm does.
    """
    free = [p.candidate for p in probed if p.candidate.place not in best.places]
    others: list[Candidate] = []
    for candidate in free:
        moves = in_proportion(candidate, best.unknowns.keys, best.projection.slopes)
        if moves is not None:
            yield candidate, moves, strained
        elif not _unlike(candidate, others):
            others.append(candidate)
    kinds = {unknown.kind for unknown in best.unknowns.each if unknown.key in strained}
    if kinds != {"clock"}:
        with suppress(*FAILED):  # of the fit itself, in longer steps
            yield from _small_moves(fitter, others, best, strained)


def _unlike(candidate: Candidate, others: Sequence[Candidate]) -> bool:
    """Whether an effect moves nothing as an unknown does, or as it does in small steps of another variant.

    Waves have frequencies of their own, and a spring that another law needs moves the arm by itself.
    """
    again = candidate.name in SPRINGS and candidate.place in {other.place for other in others}
    return candidate.name in WAVES or candidate.needs is not None or again


def _takes_over(
    candidate: Candidate, moves: Floats, strained: Strained
) -> Iterator[tuple[str, float, Takeover]]:
    """Unknowns that an effect takes over, R^2 of (1), and how."""
    parts = {key: _part(move, moves) for key, (move, _) in strained.items()}
    for key in (key for key, part in parts.items() if part > ALIKE):
        taken = {other: at for other, (_, at) in strained.items() if other == key or parts[other] > SAME}
        alphas = _alphas(moves, np.sum([strained[other][0] for other in taken], axis=0))
        if possible(candidate, alphas):
            yield key, parts[key], Takeover(candidate, alphas, taken)


def _matched(fitter: Fitter, takeover: Takeover, best: Fit) -> Candidate:
    """The effect of the size that moves residuals most as the unknowns do where they are.

    A spring, say, adds to what gives way, of which a modulus a sixth too small has a fifth too much. It is
    where a fit starts; longer steps are enough.
    """
    observed = fitter.observed.with_step(LONGER * fitter.observed.step)
    there = fitter.moved_to(dict.fromkeys(takeover.values, 0.0))
    wanted = observed.residual(fitter.moved_to(takeover.values).with_effects(best.members))
    sizes = {}
    for times in SIZES:
        with suppress(*FAILED):
            member = takeover.member(times)
            sizes[times] = observed.residual(there.with_effects((*best.members, member))) - wanted
    return takeover.member(min(sizes, key=lambda times: float(sizes[times] @ sizes[times]), default=1.0))


def _strained(fitter: Fitter, best: Fit) -> Strained:
    """What each unknown beyond `FORBIDDEN` sigmas moves, and where it is, the most strained first.

    That is where it is simulated, or else where it would have to be.
    """
    values = best.projection.best(best.residual)
    far = np.abs(values) / best.unknowns.sigma
    simulated = dict(zip(fitter.unknowns.keys, fitter.at, strict=True))
    found = {}
    for k in np.argsort(-far):
        unknown = best.unknowns.each[k]
        if unknown.kind != "start" and far[k] > FORBIDDEN:
            at = float(simulated[unknown.key] or values[k])
            found[unknown.key] = (best.projection.slopes[:, k] * at, at)
    return found


def _small_moves(
    fitter: Fitter, others: Sequence[Candidate], best: Fit, strained: Strained
) -> Iterator[tuple[Candidate, Floats, Strained]]:
    """Those derivatives from small steps of each effect, in simulations of longer steps."""
    observed = fitter.observed.with_step(LONGER * fitter.observed.step)
    there = fitter.with_effects(best.members)
    slopes = observed.slopes(there, list(strained), fitter.unknowns.steps(there))
    of = {key: (slopes[:, k] * at, at) for k, (key, (_, at)) in enumerate(strained.items())}
    nudged = [_nudged(fitter, _from(each, there), best) for each in others]
    observed.prepare([there, *(arm for arms in nudged for arm in arms)])
    before = observed.residual(there)
    for candidate, arms in zip(others, nudged, strict=True):
        with suppress(*FAILED):
            after = [observed.residual(arm) for arm in arms]
            moves = np.array([(r - before) / SMALL for r in after]).T
            if moves.any():
                yield candidate, moves, of


def _nudged(fitter: Fitter, candidate: Candidate, best: Fit) -> list[Arm]:
    """Models with a small part of each probe of an effect; none where one of them cannot be."""
    arms = []
    for k in range(len(candidate.probes)):
        with suppress(*FAILED):
            small = replace(candidate, effect=candidate.nudged(k, SMALL))
            arms.append(fitter.with_effects((*best.members, small)))
    return arms if len(arms) == len(candidate.probes) else []


def _from(candidate: Candidate, there: Arm) -> Candidate:
    """The same from a model's own values, where an effect states what a fit has elsewhere than it is stated.

    A small step of a load's mass would else begin with all that the fit has moved it.
    """
    without = there.effect(candidate.name, candidate.at)
    null = nulls(candidate.effect, without, there)
    away = {key: value - candidate.null[key] for key, value in null.items() if isfinite(value)}
    if not any(away[key] for key in candidate.free if key in away):
        return candidate
    probes = [
        each.with_parameters({key: value_of(each, key) + away.get(key, 0.0) for key in candidate.free})
        for each in candidate.probes
    ]
    return replace(candidate, probes=tuple(probes), null=null, without=without)


def _part(move: Floats, moves: Floats) -> float:
    """R^2 of (1)."""
    left = move - moves @ _alphas(moves, move)
    return 1.0 - float(left @ left) / float(move @ move)


def _alphas(moves: Floats, move: Floats) -> Floats:
    """Sizes of the minimum in (1)."""
    return np.asarray(np.linalg.lstsq(moves, move, rcond=None)[0], dtype=float)
