"""Pairs of effects that an experiment would leave tied.

The virtual laboratory of a plan: experiments made of a model, with whatever may be added to them.

The model has all reflectors that the menu of additions may glue on, and every run all sensors of the menu;
what an addition would do is then a matter of rows, and only another run is simulated anew.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
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
from flexarm.diagnosis.design.separation import Bench, Shown, matrix
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.nuisance import NuisanceModel, nuisance_model
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.screening import probe
from flexarm.record import Record


def ties(factors: Floats, seen: Floats) -> NDArray[np.bool_]:
    """Which pairs are tied: one of them is seen, and the other would do in its place."""
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


class Laboratory:
    """The virtual laboratory: a model with all reflectors that may be added, and the menu."""

    def __init__(self, arm: Arm, additions: Sequence[Addition], step: float, alpha: float, jobs: int) -> None:
        self.nominal, self.additions = arm, additions
        self.arm = with_points(arm, additions)
        self.step, self.alpha, self.jobs = step, alpha, jobs
        self.nuisance: NuisanceModel | None = None
        self.candidates: list[Candidate] = []
        self.units: dict[str, str] = {}  # of signals

    def problem(self, runs: Mapping[str, Experiment]) -> Problem:
        """Virtual records of runs."""
        records = {name: run.record(self.arm, self.step, self.alpha) for name, run in runs.items()}
        return Problem(self.arm, records, step=self.step, alpha=self.alpha, jobs=self.jobs)

    def base(self, runs: Sequence[Experiment], note: Callable[[float], object]) -> tuple[Bench, Rows]:
        """Return the planned runs, with all sensors of the menu; which rows are whose."""
        more = [sensor for addition in self.additions for sensor in addition.sensors]
        sensors = {sensor.name for run in runs for sensor in run.sensors}
        full = {run.name: replace(run, sensors=(*run.sensors, *more)) for run in runs}
        problem = self.problem(full)
        self.units = {name: s.unit for r in problem.records.values() for name, s in r.signals.items()}
        rows = Rows(problem, sensors)
        self.nuisance = nuisance_model(problem)
        plain = Problem(self.arm, {n: _only(r, sensors) for n, r in problem.records.items()}, step=self.step)
        self.candidates = candidates(plain, self.nuisance.arm)
        return self._bench(problem, self.candidates, note), rows

    def _bench(self, problem: Problem, wanted: Sequence[Candidate], note: Callable[[float], object]) -> Bench:
        assert self.nuisance is not None
        estimator = Estimator.nominal(problem, self.nuisance)
        return Bench(self.nuisance, estimator.jacobian, tuple(probe(estimator, wanted, note)))

    def partings(
        self,
        bench: Bench,
        rows: Rows,
        shown: Sequence[Shown],
        tied: NDArray[np.bool_],
        seen: Floats,
        note: Callable[[float], object],
    ) -> dict[tuple[int, int], list[Parting]]:
        """Return what every addition would do for every tied pair, the cheapest that parts it first."""
        places = [each[0].candidate.spot for each in bench.effects]
        index = np.flatnonzero(tied.any(axis=1))
        wanted = [places[i] for i in index]
        found: dict[tuple[int, int], list[Parting]] = {pair: [] for pair in pairs(tied)}
        if not len(index):
            return found
        for k, addition in enumerate(self.additions):
            with_it = self._added(bench, rows, addition, wanted)
            there = [each[0].candidate.spot for each in with_it.effects]
            factors = matrix(with_it, [shown[places.index(place)] for place in there])
            least = np.array([seen[places.index(place)] for place in there])
            where = {places.index(place): n for n, place in enumerate(there)}
            for (i, j), each in found.items():
                if i in where and j in where:
                    gain = lesser_factor(factors, least, where[i], where[j])
                    each.append(Parting(addition.words, addition.minutes, gain))
            note((k + 1) / len(self.additions))
        return {pair: sorted(each, key=_order) for pair, each in found.items()}

    def _added(
        self, bench: Bench, rows: Rows, addition: Addition, wanted: Sequence[tuple[str, str]]
    ) -> Bench:
        """Return the bench with an addition, for some effects."""
        kept = bench.of(wanted)
        if addition.sensors:
            return kept.only(rows.all(sensor.name for sensor in addition.sensors))
        there = self.problem({f"{run.name}, {addition.words}": run for run in addition.runs})
        mine = [each for each in self.candidates if each.spot in set(wanted)]
        return kept.only(rows.all()).beside(self._bench(there, mine, lambda done: None))


class Rows:
    """Rows of the planned sensors, and of those on the menu."""

    def __init__(self, problem: Problem, planned: set[str]) -> None:
        self.problem, self.planned = problem, planned

    def all(self, more: Iterable[str] = ()) -> NDArray[np.bool_]:
        """Those of the planned sensors, and of some more."""
        wanted = {*self.planned, *more}
        found = np.zeros(len(self.problem), dtype=bool)
        for each, where in self.problem.channels():
            found[where] = each.signal in wanted
        return found


def _order(parting: Parting) -> tuple[bool, float, float]:
    """Those that part first, the cheapest of them, and of these the best; then the best of the rest."""
    return (not parting.parts, parting.minutes if parting.parts else 0.0, -parting.log_bayes_factor)


def _only(record: Record, sensors: set[str]) -> Record:
    """With the drive and some signals."""
    kept = {n: s for n, s in record.signals.items() if n in sensors or n in record.drive}
    return record.replace(signals=kept)
