"""Planning: which effects an experiment could tell apart, before it is run.

    motions, sensors -> virtual records of the nominal model -> what every effect at every place would do to
    them -> expected log Bayes factors of all pairs -> what would part those that are tied

The same candidates, probes and unknowns as in a diagnosis, without data; see `flexarm.diagnosis.separation`
for the numbers.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.arm import Arm
from flexarm.configuration import version
from flexarm.diagnosis.additions import Addition, menu, with_points
from flexarm.diagnosis.candidates import SPRINGS, Candidate, candidates, value_of
from flexarm.diagnosis.choose import REACH, STRONG
from flexarm.diagnosis.experiment import Experiment, from_drive, from_record
from flexarm.diagnosis.fit import Fitter
from flexarm.diagnosis.observed import Observed
from flexarm.diagnosis.plan_result import Parting, Plan, PlannedEffect, Tie
from flexarm.diagnosis.screen import probe
from flexarm.diagnosis.separation import (
    Bench,
    Shown,
    against_none,
    cliques,
    gaps_of,
    matrix,
    shown_by,
)
from flexarm.diagnosis.unknowns import Unknowns, unknowns
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter
from flexarm.record import Record

if TYPE_CHECKING:
    from flexarm.record import Clock, Frame

Floats = NDArray[np.float64]
Progress = Callable[[float, str], object] | None


def plan(
    arm: Arm,
    drives: Mapping[str, Drive | Record] | Sequence[Drive | Record],
    *,
    clocks: Mapping[str, Clock] | None = None,
    frames: Mapping[str, Frame] | None = None,
    jobs: int | None = None,
    step: float = 4e-3,
    alpha: float = -0.05,
    progress: Progress = None,
) -> Plan:
    """Which effects at which places an experiment could tell apart, and the cheapest addition for the rest.

    Parameters
    ----------
    arm : Arm
        The nominal model, with `[[sensors]]`; without them a tracker of its last point is assumed, and said.
    drives : dict of str to Drive or Record, or sequence of them
        The motions. A record is made again: its signals, rates, noise, clocks, frames and payloads.
    clocks, frames : dict, optional
        How well clocks and frames of the model's sensors are known, as a record would state it.
    jobs : int, optional
        Number of simulations at once; default one a core.
    step, alpha : float
        Of all simulations [s], [-].
    progress : callable, optional
        Gets the share done and what is being done.

    Returns
    -------
    Plan

    Raises
    ------
    InvalidParameter
        If there is no motion, or nothing that a sensor could see.
    NotConverged
        If the nominal model cannot be simulated.

    Examples
    --------
    >>> found = flexarm.plan(arm, {"swing": flexarm.Drive.from_csv("swing.csv", arm)})  # doctest: +SKIP
    >>> print(found)  # doctest: +SKIP
    """
    begun = time.monotonic()
    tell = progress or (lambda done, what: None)
    runs = [_experiment(name, drive, arm, clocks, frames) for name, drive in _by_name(drives).items()]
    if not runs:
        raise InvalidParameter("needs at least one motion", where="drives")
    tell(0.02, "simulating")
    additions = menu(arm, runs, runs[0].run(arm, step, alpha))
    lab = _Lab(arm, additions, step, alpha, jobs or os.cpu_count() or 1)
    bench, rows = lab.base(runs, lambda done: tell(0.05 + 0.5 * done, "probing effects"))
    base = bench.only(rows.all())
    shown = shown_by(base)
    seen = against_none(base, gaps_of(base, shown))
    factors = matrix(base, shown)
    tied = ties(factors, seen)
    tell(0.6, "looking for additions")
    partings = lab.partings(bench, rows, shown, tied, seen, lambda done: tell(0.6 + 0.4 * done, "additions"))
    said = tuple(dict.fromkeys(sentence for run in runs for sentence in run.assumed))
    places = [each[0].candidate.place for each in base.effects]
    return Plan(
        arm,
        tuple(run.name for run in runs),
        tuple(
            _planned(variants[s.variant].candidate, s, float(e))
            for variants, s, e in zip(base.effects, shown, seen, strict=True)
        ),
        factors,
        tuple(cliques(tied)),
        tuple(
            Tie(places[i], places[j], _pair(factors, seen, i, j), tuple(partings.get((i, j), ())))
            for i, j in _pairs(tied)
        ),
        said,
        {"version": version(), "seconds": time.monotonic() - begun},
    )


def ties(factors: Floats, seen: Floats) -> NDArray[np.bool_]:
    """Which pairs are tied: one of them is seen, and the other would do in its place."""
    count = len(seen)
    found = np.zeros((count, count), dtype=bool)
    for i in range(count):
        for j in range(i):
            found[i, j] = found[j, i] = _pair(factors, seen, i, j) < REACH
    return found


def _pair(factors: Floats, seen: Floats, i: int, j: int) -> float:
    """The lesser one of E ln B_ij and E ln B_ji, of those whose effect is seen at all."""
    both = [factors[a, b] for a, b in ((i, j), (j, i)) if seen[a] >= STRONG]
    return float(min(both, default=inf))


def _pairs(tied: NDArray[np.bool_]) -> list[tuple[int, int]]:
    return [(int(i), int(j)) for i, j in np.argwhere(np.triu(tied, 1))]


class _Lab:
    """The virtual laboratory: a model with all reflectors that may be added, and the menu."""

    def __init__(self, arm: Arm, additions: Sequence[Addition], step: float, alpha: float, jobs: int) -> None:
        self.nominal, self.additions = arm, additions
        self.arm = with_points(arm, additions)
        self.step, self.alpha, self.jobs = step, alpha, jobs
        self.unknowns: Unknowns | None = None
        self.candidates: list[Candidate] = []

    def observed(self, runs: Mapping[str, Experiment]) -> Observed:
        """Virtual records of runs."""
        records = {name: run.record(self.arm, self.step, self.alpha) for name, run in runs.items()}
        return Observed(self.arm, records, step=self.step, alpha=self.alpha, jobs=self.jobs)

    def base(self, runs: Sequence[Experiment], note: Callable[[float], object]) -> tuple[Bench, _Rows]:
        """The planned runs, with all sensors of the menu; which rows are whose."""
        more = [sensor for addition in self.additions for sensor in addition.sensors]
        sensors = {sensor.name for run in runs for sensor in run.sensors}
        full = {run.name: replace(run, sensors=(*run.sensors, *more)) for run in runs}
        observed = self.observed(full)
        rows = _Rows(observed, sensors)
        self.unknowns = unknowns(observed)
        plain = Observed(
            self.arm, {n: _only(r, sensors) for n, r in observed.records.items()}, step=self.step
        )
        self.candidates = candidates(plain, self.unknowns.arm)
        return self._bench(observed, self.candidates, note), rows

    def _bench(
        self, observed: Observed, wanted: Sequence[Candidate], note: Callable[[float], object]
    ) -> Bench:
        assert self.unknowns is not None
        fitter = Fitter.nominal(observed, self.unknowns)
        return Bench(self.unknowns, fitter.slopes, tuple(probe(fitter, wanted, note)))

    def partings(
        self,
        bench: Bench,
        rows: _Rows,
        shown: Sequence[Shown],
        tied: NDArray[np.bool_],
        seen: Floats,
        note: Callable[[float], object],
    ) -> dict[tuple[int, int], list[Parting]]:
        """What every addition would do for every tied pair, the cheapest that parts it first."""
        places = [each[0].candidate.place for each in bench.effects]
        index = np.flatnonzero(tied.any(axis=1))
        wanted = [places[i] for i in index]
        found: dict[tuple[int, int], list[Parting]] = {pair: [] for pair in _pairs(tied)}
        if not len(index):
            return found
        for k, addition in enumerate(self.additions):
            with_it = self._added(bench, rows, addition, wanted)
            there = [each[0].candidate.place for each in with_it.effects]
            factors = matrix(with_it, [shown[places.index(place)] for place in there])
            least = np.array([seen[places.index(place)] for place in there])
            where = {places.index(place): n for n, place in enumerate(there)}
            for (i, j), each in found.items():
                if i in where and j in where:
                    gain = _pair(factors, least, where[i], where[j])
                    each.append(Parting(addition.words, addition.minutes, gain))
            note((k + 1) / len(self.additions))
        return {pair: sorted(each, key=_order) for pair, each in found.items()}

    def _added(
        self, bench: Bench, rows: _Rows, addition: Addition, wanted: Sequence[tuple[str, str]]
    ) -> Bench:
        """The bench with an addition, for some effects."""
        kept = bench.of(wanted)
        if addition.sensors:
            return kept.only(rows.all(sensor.name for sensor in addition.sensors))
        there = self.observed({f"{run.name}, {addition.words}": run for run in addition.runs})
        mine = [each for each in self.candidates if each.place in set(wanted)]
        return kept.only(rows.all()).beside(self._bench(there, mine, lambda done: None))


class _Rows:
    """Rows of the planned sensors, and of those on the menu."""

    def __init__(self, observed: Observed, planned: set[str]) -> None:
        self.observed, self.planned = observed, planned

    def all(self, more: object = ()) -> NDArray[np.bool_]:
        """Those of the planned sensors, and of some more."""
        wanted = {*self.planned, *more}  # type: ignore[misc]
        found = np.zeros(len(self.observed), dtype=bool)
        for each, where in self.observed.channels():
            found[where] = each.signal in wanted
        return found


def _order(parting: Parting) -> tuple[bool, float, float]:
    """Those that part first, the cheapest of them, and of these the best; then the best of the rest."""
    return (not parting.parts, parting.minutes if parting.parts else 0.0, -parting.log_bayes_factor)


def _only(record: Record, sensors: set[str]) -> Record:
    """With the drive and some signals."""
    kept = {n: s for n, s in record.signals.items() if n in sensors or n in record.drive}
    return record.replace(signals=kept)


def _planned(candidate: Candidate, shown: Shown, seen: float) -> PlannedEffect:
    """An effect as it is shown, and the smallest one that is seen; see eq. (2) of `separation`."""
    size = candidate.probes[shown.probe]
    units = {name: unit.removeprefix("SI") for name, _, unit in size.parameters()}
    name = _parameter(candidate, size)
    value, null = value_of(size, name), candidate.null.get(name, 0.0)
    times = np.sqrt(STRONG / seen) if seen > 0 else inf
    if candidate.name in SPRINGS:
        there = value_of(candidate.without, "stiffness") if candidate.without is not None else inf
        change = 1.0 / value - 1.0 / there
        least = 1.0 / (1.0 / there + times * change)
        return PlannedEffect(*candidate.place, name, units[name], value, there, least, seen)
    return PlannedEffect(
        *candidate.place, name, units[name], value, null, null + times * (value - null), seen
    )


def _parameter(candidate: Candidate, size: object) -> str:
    """The parameter that says how large an effect is: the one that differs most from none."""
    from flexarm.arm.effect import Effect

    assert isinstance(size, Effect)
    moved = {
        name: abs(value_of(size, name) - candidate.null.get(name, 0.0))
        for name in candidate.free
        if name not in ("phase", "frequency", "width", "damping", "time_constant", "multiple")
    }
    names = [name for name, move in moved.items() if move > 0]
    return names[0] if names else candidate.free[0]


def _experiment(
    name: str,
    drive: Drive | Record,
    arm: Arm,
    clocks: Mapping[str, Clock] | None,
    frames: Mapping[str, Frame] | None,
) -> Experiment:
    if isinstance(drive, Record):
        return from_record(name, drive, arm)
    return from_drive(name, drive, arm, clocks, frames)


def _by_name(
    drives: Mapping[str, Drive | Record] | Sequence[Drive | Record],
) -> dict[str, Drive | Record]:
    if isinstance(drives, Mapping):
        return dict(drives)
    return {f"run_{k + 1}": drive for k, drive in enumerate(drives)}
