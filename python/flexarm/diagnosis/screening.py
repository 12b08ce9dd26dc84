"""Screening: how much of the gap every effect at every place could explain, from finite steps.

With q the residual and D the responses to the probes of a candidate (`diagnosis.candidates`), both projected
orthogonally to nuisance parameters,

    min over alpha of |q + D alpha|^2 + |alpha/10|^2,      share = 1 - min/|q|^2                       (1)

The probes of all candidates are simulated once; sets of two and more are then linear algebra. A probe is
about one sigma of what is plausible: the second term keeps alphas below some ten of them. Laws that cannot be
negative are not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from types import MappingProxyType

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.budget import allows, until
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import FIT_ERRORS, Fit, Projection
from flexarm.diagnosis.problem import KEPT_RESIDUALS
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.named_effects import Place
from flexarm.simulation import Progress, reported

Ranked = tuple[float, tuple[int, ...]]
"""Share that a set explains, and which candidates are in it."""

RIDGE = 0.1
LONGER = 2.0
"""Time steps of probes over those of fits: only differences count."""
HARDLY = 0.02
"""Part of the greatest move below which a component of a vector is not fitted."""
SCREENED = 0.5
"""Part of a budget of time at which screening ends."""
KEPT = 100
"""Most sets whose sizes are computed."""
NONE: Mapping[str, str] = MappingProxyType({})


@dataclass(frozen=True, eq=False)
class Probed:
    """A candidate and the response of the residual to its probes, shape (n, probes)."""

    candidate: Candidate
    moves: Floats


@dataclass(frozen=True, eq=False)
class Share:
    """The share of the residual that a set of candidates explains."""

    members: tuple[Candidate, ...]
    """Effects at the sizes that explain most, the start of a fit."""
    share: float
    """Explained share of the squared gap, eq. (1)."""

    @property
    def places(self) -> tuple[tuple[str, Place], ...]:
        """Name and place of each member."""
        return tuple(member.place for member in self.members)


def probe(estimator: Estimator, found: Sequence[Candidate], progress: Progress = None) -> list[Probed]:
    """Simulate the probes of all candidates; those that cannot be simulated are left out."""
    problem, probed = estimator.problem.with_step(LONGER * estimator.problem.step), []
    size = KEPT_RESIDUALS // 8  # candidates have a few probes each
    with until(SCREENED), reported(progress, "probing effects") as report:
        for k, candidate in enumerate(found):
            if not allows("all effects were screened"):
                break
            if k % size == 0:
                some = [_to_simulate(each, estimator) for each in found[k : k + size]]
                problem.prepare(model for models in some for model in models)
            with suppress(InvalidParameter, NotConverged):
                moves = linear_response(candidate, estimator.nuisance.keys, estimator.jacobian)
                if moves is None and some[k % size]:
                    before, *after = map(problem.residual, some[k % size])
                    moves = np.stack([r - before for r in after], axis=1)
                if moves is not None:
                    probed.append(_seen(Probed(candidate, moves)))
            if report is not None:
                report((k + 1) / len(found))
    return probed


def _to_simulate(candidate: Candidate, estimator: Estimator) -> list[Arm]:
    """Return the model without a candidate and those with its probes; none if it is linear or invalid."""
    with suppress(InvalidParameter):
        if linear_response(candidate, estimator.nuisance.keys, estimator.jacobian) is None:
            there = candidate.base(estimator.arm)
            return [there, *(there.with_effect(each) for each in candidate.probes)]
    return []


def linear_response(candidate: Candidate, keys: Sequence[str], jacobian: Floats) -> Floats | None:
    """Return the linear response of a nuisance-type candidate from its Jacobian columns, or None for any
    other.

    Clocks, frames and reflectors then explain as effects what they explain as nuisance parameters, without a
    simulation.
    """
    own = [candidate.effect.model_key(name) for name in candidate.free]
    if not set(own) <= set(keys):
        return None
    steps = [
        [probe.value_of(name) - candidate.null[name] for probe in candidate.probes] for name in candidate.free
    ]
    moves: Floats = jacobian[:, [keys.index(key) for key in own]] @ np.array(steps)
    return moves


def _seen(probed: Probed) -> Probed:
    """Return a candidate without vector components of negligible response, as across the plane of a planar
    arm.
    """
    candidate, moves = probed.candidate, probed.moves
    size = np.linalg.norm(moves, axis=0)
    sized = [name for name in candidate.free if name not in candidate.effect.shape]
    if len(sized) != len(size) or not all("." in name for name in sized):
        return probed
    keep = [k for k in range(len(size)) if size[k] > HARDLY * size.max()]
    if not 0 < len(keep) < len(size):
        return probed
    seen = {sized[k] for k in keep}
    free = tuple(name for name in candidate.free if name in seen or name in candidate.effect.shape)
    probes = tuple(candidate.probes[k] for k in keep)
    none = {name: candidate.null[name] for name in sized if name not in seen}
    effect = candidate.effect.with_parameters(none)
    return Probed(replace(candidate, effect=effect, free=free, probes=probes), moves[:, keep])


def screen(
    estimator: Estimator,
    probed: Sequence[Probed],
    fit: Fit,
    pairs: Mapping[str, str] = NONE,
    seen: Callable[[Floats], Floats] | None = None,
) -> list[Share]:
    """Return candidates by the share of a fit's residual that they explain, the best first.

    Parameters of the fit are refitted to first order. `pairs` are joints of one place
    (`candidates.cardan_joints`), where a law at both is one candidate. `seen` is a linear filter of residual
    columns, such as `proposals.slow_part`.
    """
    linear = Linear(estimator, probed, fit, seen)
    sets = [(k,) for k in linear.free] + list(linear.at_both_axes(pairs))
    return linear.shares(linear.ranked(sets))


def screen_sets(
    estimator: Estimator,
    probed: Sequence[Probed],
    fit: Fit,
    size: int,
    seen: Callable[[Floats], Floats] | None = None,
) -> list[Share]:
    """Return sets of two or three candidates that explain most of the `seen` residual, the best first.

    All pairs are screened. Triples are those of the `among` places of the policy that explain most alone, and
    of half as many that explain most in a pair.
    """
    linear = Linear(estimator, probed, fit, seen)
    two = linear.ranked(linear.sets(linear.free, 2))
    if size == 2:
        return linear.shares(two, KEPT)
    alone = linear.ranked((k,) for k in linear.free)
    few: dict[tuple[str, Place], int] = {}
    among = estimator.problem.policy.among
    for ranked, most in ((alone, among), (two, among + among // 2)):
        for k in (k for _, chosen in ranked for k in chosen):
            if len(few) < most:
                few.setdefault(probed[k].candidate.place, k)
    return linear.shares(linear.ranked(linear.sets(list(few.values()), size)), KEPT)


def rescreened_at_size(estimator: Estimator, shares: Sequence[Share], fit: Fit) -> list[Share]:
    """Return shares from simulations of each set at its size, since laws are nonlinear between probe and
    size.

    Responses are differences, simulated in longer time steps as probes are.
    """
    coarse = replace(estimator, problem=estimator.problem.with_step(LONGER * estimator.problem.step))
    models = []
    for share in shares:
        members = (*fit.members, *share.members)
        with suppress(InvalidParameter):  # such as a ripple that turns the output back
            models.append((share, members, estimator.with_effects(members)))
    coarse.problem.prepare(arm for _, _, arm in models)
    if not models:
        return []
    try:
        before = coarse.residual(fit.members)
    except FIT_ERRORS:  # non-smooth laws may not follow longer steps
        coarse, before = estimator, estimator.residual(fit.members)
    found = []
    for share, members, _ in models:
        try:
            move = coarse.residual(members) - before
        except (InvalidParameter, NotConverged):
            continue
        _, projection = estimator.eliminated(members)
        rest = projection.project(np.column_stack([fit.residual, move]))
        q, d = rest[:, 0], rest[:, 1]
        times = max(-float(d @ q) / max(float(d @ d), 1e-300), 0.0)
        left = q + times * d
        found.append(replace(share, share=1.0 - float(left @ left) / fit.cost))
    return sorted(found, key=lambda s: -s.share)


class Linear:
    """Eq. (1) for any set of candidates about a fit, from one Gram matrix of all moves.

    With D the moves of all candidates and the derivatives of the fit by its own effects, less what nuisance
    parameters explain, G = D^T D and b = D^T q hold everything: a set takes its rows and columns,

        alpha = -(G + ridge)^-1 b,   |q + D alpha|^2 = |q|^2 + 2 alpha b + alpha G alpha               (2)

    Sets that take different nuisance parameters into their effects have matrices of their own.
    """

    def __init__(
        self,
        estimator: Estimator,
        probed: Sequence[Probed],
        fit: Fit,
        seen: Callable[[Floats], Floats] | None = None,
    ) -> None:
        self.estimator, self.probed, self.fit, self.seen = estimator, probed, fit, seen
        self.free = [k for k, p in enumerate(probed) if not p.candidate.spots & fit.spots]
        ends = np.cumsum([0, *(p.moves.shape[1] for p in probed)])
        self._columns = [np.arange(ends[k], ends[k + 1]) for k in range(len(probed))]
        self._own = np.arange(ends[-1], ends[-1] + fit.jacobian.shape[1])
        self._moves = np.concatenate([*(p.moves for p in probed), fit.jacobian], axis=1)
        self._takes = [estimator.taken([p.candidate]) for p in probed]
        self._fitted = estimator.taken(fit.members)
        self._grams: dict[frozenset[str], tuple[Floats, Floats, float]] = {}

    def sets(self, among: Sequence[int], size: int) -> Iterator[tuple[int, ...]]:
        """All sets of different places."""
        for found in combinations(among, size):
            if len({self.probed[k].candidate.place for k in found}) == size:
                yield found

    def at_both_axes(self, pairs: Mapping[str, str]) -> Iterator[tuple[int, ...]]:
        """Yield the same variant of a law at both axes of a cardan joint."""
        for i in self.free:
            one = self.probed[i].candidate
            for j in self.free:
                other = self.probed[j].candidate
                if pairs.get(one.effect.at) == other.at and other.effect == one.effect.replace(
                    at=other.effect.at
                ):
                    yield i, j

    def ranked(self, sets: Iterable[tuple[int, ...]]) -> list[Ranked]:
        """Return share and members of sets with admissible signs, the best first.

        A law that requires a spring which model and fit lack is screened only together with that spring.
        """
        found = [(self._solved(each)[0], each) for each in sets if self._stands(each)]
        return sorted((pair for pair in found if pair[0] > 0), key=lambda pair: -pair[0])

    def _stands(self, chosen: tuple[int, ...]) -> bool:
        members = [self.probed[k].candidate for k in chosen]
        there = {None, *self.fit.spots, *(member.place for member in members)}
        return all(member.required_place in there for member in members)

    def shares(self, ranked: Sequence[Ranked], most: int | None = None) -> list[Share]:
        """Return the first of them at the sizes of eq. (2)."""
        found = []
        for share, chosen in ranked[:most]:
            _, alphas = self._solved(chosen)
            members = []
            try:
                for index, mine in zip(chosen, alphas, strict=True):
                    candidate = self.probed[index].candidate
                    members.append(candidate.at_size(mine.tolist()))
            except FIT_ERRORS:
                continue
            found.append(Share(tuple(members), share))
        return found

    def _solved(self, chosen: tuple[int, ...]) -> tuple[float, list[Floats]]:
        """Eq. (2) for one set; a share of -1 where a law would have to be negative."""
        gram, b, square = self._gram(self._fitted.union(*(self._takes[k] for k in chosen)))
        parts = [self._columns[k] for k in chosen]
        columns = np.concatenate([*parts, self._own])
        own = len(columns) - len(self._own)
        G, b = gram[np.ix_(columns, columns)], b[columns]
        ridge = np.diag([RIDGE**2] * own + [1.0] * len(self._own))
        alphas = np.asarray(np.linalg.solve(G + ridge, -b), dtype=float)  # eq. (2)
        mine = np.split(alphas[:own], np.cumsum([len(part) for part in parts])[:-1])
        if not all(possible(self.probed[k].candidate, a) for k, a in zip(chosen, mine, strict=True)):
            return -1.0, mine
        left = square + float(2 * alphas @ b + alphas @ G @ alphas)  # eq. (2)
        return 1.0 - left / self._before, mine

    @cached_property
    def _before(self) -> float:
        """Return the squared residual of the fit, filtered by `seen`."""
        if self.seen is None:
            return self.fit.cost
        rest = self._rest(self._fitted, self.fit.residual[:, None])[:, 0]
        return float(rest @ rest)

    def _rest(self, taken: frozenset[str], columns: Floats) -> Floats:
        """Return filtered columns, projected orthogonally to nuisance parameters."""
        nuisance, projection = self.estimator.without(taken)
        if self.seen is None:
            return projection.project(columns)
        return Projection(self.seen(projection.jacobian), nuisance.sigma).project(self.seen(columns))

    def _gram(self, taken: frozenset[str]) -> tuple[Floats, Floats, float]:
        if taken not in self._grams:
            rest = self._rest(taken, np.column_stack([self.fit.residual, self._moves]))
            q, d = rest[:, 0], rest[:, 1:]
            self._grams[taken] = (d.T @ d, d.T @ q, float(q @ q))
        return self._grams[taken]


def possible(candidate: Candidate, alphas: Floats) -> bool:
    """Return True if the size of a law has an admissible sign."""
    return not candidate.effect.one_signed or candidate.without is not None or bool(alphas.max() > 0)
