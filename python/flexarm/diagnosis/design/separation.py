r"""Separation of effects by a planned experiment: linear algebra on the gaps that they would leave.

If effect i is there with gap g_i (over the noise) and another one, j, is named, with probes D_j free in size
and clocks, frames and nominal values u free within their priors, what is left is

.. math:: v = g_i - [J \; D_j] x, \quad x = \arg\min |v|^2 + |u/\sigma|^2 + |\alpha/10|^2               (1)

The right name leaves nothing but noise, so that the expected log Bayes factor of the right over the wrong
name is half the squared length of v [Chaloner1995], reduced by the error of any simulation (eq. (3) of
`diagnosis.evidence`),

.. math:: E \ln B_{ij} = \frac{|v|^2/2}{1 + \delta^2 N_v}                                            (2)

It grows with the square of the size of g_i: the size at which E ln B against no effect at all reaches a
threshold is the smallest that is detected. What the parameters of the models cost is left out of (2); it is
alike for alternatives.

Virtual experiments give the gaps. Their model has all reflectors of the menu of additions, and every run all
sensors of the menu. An addition is then a choice of rows; only another run is simulated anew.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from math import inf

import numpy as np
from numpy.typing import NDArray

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.design.candidate_measurements import Addition, with_points
from flexarm.diagnosis.design.experiment import Experiment
from flexarm.diagnosis.design.plan_result import Parting
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import Projection
from flexarm.diagnosis.nuisance import NuisanceModel, nuisance_model
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.screening import RIDGE, Probed, probe


@dataclass(frozen=True, eq=False)
class Responses:
    """Responses of rows of experiments to nuisance parameters and effects, over the noise."""

    nuisance: NuisanceModel
    """Clocks, frames, nominal values."""
    jacobian: Floats
    """Derivatives of the rows by them. Shape (n, m)."""
    probed: tuple[Probed, ...]
    """Candidates and what their probes do to the rows; variants of an effect one after the other."""

    @property
    def effects(self) -> list[tuple[Probed, ...]]:
        """Variants by effect and place."""
        return [tuple(each) for _, each in groupby(self.probed, key=lambda p: p.candidate.spot)]

    def only(self, rows: NDArray[np.bool_]) -> Responses:
        """Return the same with some of the rows."""
        probed = tuple(Probed(p.candidate, p.moves[rows]) for p in self.probed)
        return Responses(self.nuisance, self.jacobian[rows], probed)

    def of(self, places: Sequence[tuple[str, str]]) -> Responses:
        """Return the same with some of the effects, in their order here."""
        wanted = set(places)
        return Responses(
            self.nuisance, self.jacobian, tuple(p for p in self.probed if p.candidate.spot in wanted)
        )

    def stacked_with(self, other: Responses) -> Responses:
        """Return these rows above those of other responses, for effects with all variants in both."""
        below = {_key(p.candidate): p.moves for p in other.probed}
        lost = {p.candidate.spot for p in self.probed if _key(p.candidate) not in below}
        probed = tuple(
            Probed(p.candidate, np.vstack([p.moves, below[_key(p.candidate)]]))
            for p in self.probed
            if p.candidate.spot not in lost
        )
        return Responses(self.nuisance, np.vstack([self.jacobian, other.jacobian]), probed)


def _key(candidate: Candidate) -> str:
    return repr(candidate.effect) + repr(candidate.probes)


def unexplained_gap(responses: Responses, gaps: Floats, alternative: Probed | None) -> Floats:
    """Return v of (1) for gaps (n, k): rows, then pulls of nuisance parameters and sizes [sigma]."""
    taken = responses.nuisance.taken_by([] if alternative is None else [alternative.candidate.spot])
    keep = [k for k, u in enumerate(responses.nuisance.parameters) if u.key not in taken]
    jacobian, sigma = responses.jacobian[:, keep], responses.nuisance.sigma[keep]
    if alternative is not None:
        jacobian = np.column_stack([jacobian, alternative.moves])
        sigma = np.concatenate([sigma, np.full(alternative.moves.shape[1], 1.0 / RIDGE)])
    if not len(sigma):
        return gaps
    return Projection(jacobian, sigma).project(gaps)  # eq. (1)


def expected_log_bayes_factor(v: Floats, rows: int) -> Floats:
    """Return eq. (2) for each column of v, of which `rows` are data; all pulls together count as one row."""
    asked = np.linalg.norm(v[rows:], axis=0, keepdims=True)
    all_rows = np.vstack([v[:rows], asked])
    square = np.sum(all_rows**2, axis=0)
    spread = square**2 / np.maximum(np.sum(all_rows**4, axis=0), 1e-300)
    found: Floats = square / 2 / (1 + SelectionPolicy.discrepancy**2 * spread)  # eq. (2)
    return found


@dataclass(frozen=True)
class Shown:
    """Variant of an effect that is seen best."""

    variant: int
    probe: int


def shown_by(responses: Responses) -> list[Shown]:
    """Return the variant and probe of every effect that is seen best."""
    found = []
    for variants in responses.effects:
        values = [
            (float(value), Shown(k, i))
            for k, each in enumerate(variants)
            for i, value in enumerate(against_none(responses, each.moves))
        ]
        found.append(max(values, key=lambda pair: pair[0])[1])
    return found


def gaps_of(responses: Responses, shown: Sequence[Shown]) -> Floats:
    """Return g of (1) for every effect, shape (n, effects)."""
    columns = [
        variants[s.variant].moves[:, s.probe] for variants, s in zip(responses.effects, shown, strict=True)
    ]
    return np.stack(columns, axis=1) if columns else np.empty((len(responses.jacobian), 0))


def against_none(responses: Responses, gaps: Floats) -> Floats:
    """Return E ln B of every gap against no effect at all."""
    return expected_log_bayes_factor(unexplained_gap(responses, gaps, None), len(gaps))


def matrix(responses: Responses, shown: Sequence[Shown]) -> Floats:
    """Return E ln B_ij of (2), shape (effects, effects), with 0 on its diagonal.

    An alternative has the best of its variants.
    """
    gaps = gaps_of(responses, shown)
    columns = []
    for variants in responses.effects:
        each = [
            expected_log_bayes_factor(unexplained_gap(responses, gaps, alternative), len(gaps))
            for alternative in variants
        ]
        columns.append(np.min(each, axis=0))
    found = np.stack(columns, axis=1) if columns else np.empty((0, 0))
    np.fill_diagonal(found, 0.0)
    return found


def cliques(tied: NDArray[np.bool_]) -> list[tuple[int, ...]]:
    """Return the largest groups of which all pairs are tied, largest first [Bron1973]."""
    neighbours = [set(np.flatnonzero(row).tolist()) - {i} for i, row in enumerate(tied)]
    found: list[tuple[int, ...]] = []

    def grow(group: set[int], open_: set[int], done: set[int]) -> None:
        if not open_ and not done:
            if len(group) > 1:
                found.append(tuple(sorted(group)))
            return
        pivot = max(open_ | done, key=lambda i: len(open_ & neighbours[i]))
        for i in sorted(open_ - neighbours[pivot]):
            grow(group | {i}, open_ & neighbours[i], done & neighbours[i])
            open_, done = open_ - {i}, done | {i}

    grow(set(), set(range(len(tied))), set())
    return sorted(found, key=lambda group: (-len(group), group))


def ties(factors: Floats, seen: Floats) -> NDArray[np.bool_]:
    """Return True at tied pairs: one effect is seen, and the other would do in its place."""
    count = len(seen)
    found = np.zeros((count, count), dtype=bool)
    for i in range(count):
        for j in range(i):
            found[i, j] = found[j, i] = lesser_factor(factors, seen, i, j) < SelectionPolicy.reach
    return found


def lesser_factor(factors: Floats, seen: Floats, i: int, j: int) -> float:
    """Return the lesser one of E ln B_ij and E ln B_ji, of those whose effect is seen at all."""
    both = [factors[a, b] for a, b in ((i, j), (j, i)) if seen[a] >= SelectionPolicy.strong_evidence]
    return float(min(both, default=inf))


def pairs(tied: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the pairs that are tied, each once."""
    return [(int(i), int(j)) for i, j in np.argwhere(np.triu(tied, 1))]


class VirtualExperiments:
    """The virtual laboratory: a model with all reflectors that may be added, and the menu."""

    def __init__(self, arm: Arm, additions: Sequence[Addition], step: float, alpha: float, jobs: int) -> None:
        self.nominal, self.additions = arm, additions
        self.arm = with_points(arm, additions)
        self.step, self.alpha, self.jobs = step, alpha, jobs
        self.nuisance: NuisanceModel | None = None
        self.candidates: list[Candidate] = []
        self.units: dict[str, str] = {}  # of signals
        self.planned: set[str] = set()  # names of sensors
        self.signals: list[tuple[str, slice]] = []  # of the rows of the planned runs

    def problem(self, runs: Mapping[str, Experiment]) -> Problem:
        """Return the virtual records of runs."""
        records = {name: run.record(self.arm, self.step, self.alpha) for name, run in runs.items()}
        return Problem(self.arm, records, step=self.step, alpha=self.alpha, jobs=self.jobs)

    def base(self, runs: Sequence[Experiment], note: Callable[[float], object]) -> Responses:
        """Return the responses in the planned runs, with all sensors of the menu."""
        more = [sensor for addition in self.additions for sensor in addition.sensors]
        self.planned = sensors = {sensor.name for run in runs for sensor in run.sensors}
        full = {run.name: replace(run, sensors=(*run.sensors, *more)) for run in runs}
        problem = self.problem(full)
        self.units = {name: s.unit for r in problem.records.values() for name, s in r.signals.items()}
        self.signals = [(each.signal, where) for each, where in problem.channels()]
        self.nuisance = nuisance_model(problem)
        records = {
            name: record.replace(
                signals={n: s for n, s in record.signals.items() if n in sensors or n in record.drive}
            )
            for name, record in problem.records.items()
        }
        self.candidates = candidates(Problem(self.arm, records, step=self.step), self.nuisance.arm)
        return self._responses(problem, self.candidates, note)

    def rows(self, more: Iterable[str] = ()) -> NDArray[np.bool_]:
        """Return True at rows of the planned sensors, and of some more on the menu."""
        wanted = {*self.planned, *more}
        return np.concatenate([np.full(where.stop - where.start, s in wanted) for s, where in self.signals])

    def _responses(
        self, problem: Problem, wanted: Sequence[Candidate], note: Callable[[float], object]
    ) -> Responses:
        assert self.nuisance is not None
        estimator = Estimator.nominal(problem, self.nuisance)
        return Responses(self.nuisance, estimator.jacobian, tuple(probe(estimator, wanted, note)))

    def partings(
        self,
        responses: Responses,
        shown: Sequence[Shown],
        tied: NDArray[np.bool_],
        seen: Floats,
        note: Callable[[float], object],
    ) -> dict[tuple[int, int], list[Parting]]:
        """Return what every addition would do for every tied pair, the cheapest that parts it first."""
        places = [each[0].candidate.spot for each in responses.effects]
        index = np.flatnonzero(tied.any(axis=1))
        wanted = [places[i] for i in index]
        found: dict[tuple[int, int], list[Parting]] = {pair: [] for pair in pairs(tied)}
        if not len(index):
            return found
        for k, addition in enumerate(self.additions):
            with_it = self._added(responses, addition, wanted)
            there = [each[0].candidate.spot for each in with_it.effects]
            factors = matrix(with_it, [shown[places.index(place)] for place in there])
            least = np.array([seen[places.index(place)] for place in there])
            where = {places.index(place): n for n, place in enumerate(there)}
            for (i, j), each in found.items():
                if i in where and j in where:
                    gain = lesser_factor(factors, least, where[i], where[j])
                    each.append(Parting(addition.words, addition.minutes, gain))
            note((k + 1) / len(self.additions))
        for each in found.values():  # those that part by cost and gain, then the others by gain
            each.sort(key=lambda p: (not p.parts, p.parts * p.minutes, -p.log_bayes_factor))
        return found

    def _added(
        self, responses: Responses, addition: Addition, wanted: Sequence[tuple[str, str]]
    ) -> Responses:
        """Return the responses with an addition, for some effects."""
        kept = responses.of(wanted)
        if addition.sensors:
            return kept.only(self.rows(sensor.name for sensor in addition.sensors))
        there = self.problem({f"{run.name}, {addition.words}": run for run in addition.runs})
        mine = [each for each in self.candidates if each.spot in set(wanted)]
        return kept.only(self.rows()).stacked_with(self._responses(there, mine, lambda done: None))
