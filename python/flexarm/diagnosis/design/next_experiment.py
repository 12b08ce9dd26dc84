r"""The next experiment: the additional measurement that separates the named effects from their alternatives.

The named model and each alternative have been fitted to the data at hand. Their predictions of another run
differ by d. An alternative may be refitted to both, data at hand (rows 0) and to come (rows 1), its
parameters z within their priors, with clocks, frames and nominal values u,

.. math:: v = \begin{pmatrix} d_0 \\ d_1 \end{pmatrix} - \begin{pmatrix} J_0 & Z_0 \\ J_1 & Z_1 \end{pmatrix}
   \begin{pmatrix} u \\ z \end{pmatrix}                                                                (1)

The expected log Bayes factor of the named effect, if it is right, is eq. (2) of `design.separation`. Where no
known effect explains the gap, the next experiment is the repetition that would show the kind of remainder.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import groupby

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.diagnosis.alternatives import AlternativeModel
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.design.candidate_measurements import Addition, menu, with_points
from flexarm.diagnosis.design.experiment import Experiment, from_record
from flexarm.diagnosis.design.separation import expected_log_bayes_factor
from flexarm.diagnosis.fit import Fit, Projection
from flexarm.diagnosis.nuisance import NuisanceParameter, nominal
from flexarm.diagnosis.policy import DESIGN, SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.selection import Choice
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.record import Record
from flexarm.wording import listed, number, place_words


def gains(
    choice: Choice, problem: Problem, name: str, record: Record, pairs: Sequence[tuple[int, AlternativeModel]]
) -> Iterator[tuple[Addition, list[float]]]:
    """Yield each addition with E ln B of every pair."""
    arm = choice.estimator.with_effects(choice.best.members)
    noise = {row.signal: row.sigma for row in problem.rows if row.record == name}
    step = problem.step
    try:
        run = from_record(name, record, arm, noise)
        additions = menu(problem.arm, [run], run.run(arm, step, problem.alpha))
    except (InvalidParameter, NotConverged):
        return
    there = with_points(arm, additions)
    estimator = choice.estimator
    best = estimator.problem.residual(estimator.with_effects(choice.best.members))
    apart = [estimator.problem.residual(estimator.with_effects(r.fit.members)) - best for _, r in pairs]
    present = _Rows(
        estimator.nuisance.parameters,
        estimator.jacobian,
        apart,
        [alternative.fit.jacobian for _, alternative in pairs],
    )
    sensors = [sensor for addition in additions for sensor in addition.sensors]
    logged = replace(run, sensors=(*run.sensors, *sensors))

    @cache
    def rows_of(run: Experiment) -> _Rows | None:
        return _Rows.of(run, there, choice, problem, pairs)

    for addition in additions:
        own = {*(s.name for s in run.sensors), *(s.name for s in addition.sensors)}
        rows = rows_of(logged if addition.sensors else addition.runs[0])  # one run serves all added sensors
        if rows is not None:
            yield addition, [_expected(present, rows, k, own) for k in range(len(pairs))]


@dataclass(frozen=True, eq=False)
class _Rows:
    """Rows of (1): differences d and derivatives Z for each pair, derivatives J by nuisance parameters."""

    nuisance: tuple[NuisanceParameter, ...]
    jacobian: Floats
    apart: list[Floats]
    moves: list[Floats]
    signals: Sequence[str] = ()
    """Which one each of rows 1 belongs to."""

    @classmethod
    def of(
        cls,
        run: Experiment,
        arm: Arm,
        choice: Choice,
        problem: Problem,
        pairs: Sequence[tuple[int, AlternativeModel]],
    ) -> _Rows | None:
        """Return rows 1, of a run; None if it cannot be simulated."""
        step = problem.step
        try:
            record = run.record(arm, step, problem.alpha)
            there = Problem(arm, {run.name: record}, step=step, alpha=problem.alpha, jobs=problem.jobs)
            best = there.residual(arm)
            known = choice.estimator.nuisance.parameters
            keys = {u.key for u in known}  # and the places of reflectors that are added
            added = (u for u in nominal(arm, there.records) if u.key.startswith("points."))
            each = (*known, *(u for u in added if u.key not in keys))
            jacobian = there.jacobian(arm, [u.key for u in each])
            models = [_model_of(arm, choice, alternative.fit) for _, alternative in pairs]
            apart = [there.residual(model) - best for model in models]
            moves = [
                _derivatives(there, arm, choice, alternative.fit, best + d)
                for (_, alternative), d in zip(pairs, apart, strict=True)
            ]
        except (InvalidParameter, NotConverged):
            return None
        signals = [row.signal for row, where in there.channels() for _ in range(where.stop - where.start)]
        return cls(each, jacobian, apart, moves, signals)


def _model_of(arm: Arm, choice: Choice, fit: Fit, members: Sequence[Candidate] | None = None) -> Arm:
    """Return a fitted model with the points and nuisance parameters of `arm`."""
    found = choice.estimator.with_effects(fit.members if members is None else members)
    return found.replace(points=arm.points, uncertainty=arm.uncertainty)


def _derivatives(problem: Problem, arm: Arm, choice: Choice, fit: Fit, here: Floats) -> Floats:
    """Return Z of (1) by finite steps."""
    columns = []
    for parameter, z in zip(fit.parameters, fit.z, strict=True):
        members = list(fit.members)
        member = members[parameter.candidate]
        step = parameter.step(float(z), problem.seconds)
        members[parameter.candidate] = member.with_parameters(
            {parameter.name: parameter.value(float(z) + step)}
        )
        try:
            columns.append((problem.residual(_model_of(arm, choice, fit, members)) - here) / step)
        except (InvalidParameter, NotConverged):
            columns.append(np.zeros_like(here))
    return np.stack(columns, axis=1) if columns else np.empty((len(here), 0))


def _expected(present: _Rows, new: _Rows, k: int, signals: Iterable[str]) -> float:
    """Return E ln B of pair k given the signals of an addition."""
    wanted = set(signals)
    kept = np.array([signal in wanted for signal in new.signals])
    more = len(new.nuisance) - len(present.nuisance)
    before = np.column_stack([present.jacobian, np.zeros((len(present.jacobian), more)), present.moves[k]])
    after = np.column_stack([new.jacobian, new.moves[k]])[kept]
    sigma = np.concatenate(
        [[u.sigma for u in new.nuisance], np.full(present.moves[k].shape[1], DESIGN.prior_sigma)]
    )
    apart = np.concatenate([present.apart[k], new.apart[k][kept]])
    v = Projection(np.vstack([before, after]), sigma).project(apart[:, None])  # eq. (1)
    return float(expected_log_bayes_factor(v, len(apart))[0])


@dataclass(frozen=True)
class NextExperiment:
    """A proposed next experiment."""

    sentence: str = ""
    """For a person; empty if nothing is left to separate."""
    gain: float = 0.0
    """Expected ln Bayes factor of the named effect over the nearest of its alternatives."""
    minutes: float = 0.0
    """Cost, roughly."""


def next_experiment(choice: Choice, problem: Problem, unexplained: bool = False) -> NextExperiment:
    """Return the addition to the records at hand that best separates named effects from alternatives.

    If no known effect explains the gap (`unexplained`), it is the repetition that would describe the
    remainder.
    """
    motions = {name: record for name, record in problem.records.items() if record.kind == "motion"}
    if unexplained:
        return NextExperiment(_to_describe(problem, motions))
    pairs = [
        (k, alternative)
        for k, alternatives in enumerate(choice.alternatives)
        for alternative in alternatives
        if alternative.within_reach
    ]
    pairs = sorted(pairs, key=lambda pair: pair[1].behind)[: DESIGN.alternatives]
    if not pairs:
        return NextExperiment()
    if not motions:
        return NextExperiment(
            f"Move the arm slowly through the poses, or weigh another payload in them: static poses alone "
            f"do not part {_words(choice, pairs)}; what that would gain has not been computed."
        )
    name, record = next(iter(motions.items()))
    found = _worthwhile(gains(choice, problem, name, record, pairs))
    if not found:
        return NextExperiment()
    addition, gain = max(found, key=lambda pair: pair[1])
    return NextExperiment(_sentence(choice, name, addition, gain, pairs), gain, addition.minutes)


def _worthwhile(gains: Iterator[tuple[Addition, list[float]]]) -> list[tuple[Addition, float]]:
    """Return the additions of the least cost of which one suffices, else all; no dearer one is simulated."""
    found: list[tuple[Addition, float]] = []
    for _, alike in groupby(gains, key=lambda pair: pair[0].minutes):
        new = [(addition, gain) for addition, each in alike if np.isfinite(gain := min(each))]
        if any(gain >= DESIGN.enough for _, gain in new):
            return new
        found += new
    return found


def _sentence(
    choice: Choice, name: str, addition: Addition, gain: float, pairs: Sequence[tuple[int, AlternativeModel]]
) -> str:
    """Return what to do and what it would bring."""
    parted = _words(choice, pairs)
    if gain < SelectionPolicy.reach:
        return (
            f"Nothing that is easily added parts {parted}: the most, an expected ln Bayes factor of "
            f"{number(gain, 2)}, comes from repeating '{name}' {addition.words}."
        )
    least = "at least " if len(pairs) > 1 else ""
    return (
        f"Repeat '{name}' {addition.words}: it would part {parted} with an expected ln Bayes factor of "
        f"{least}{number(gain, 2)} (some {addition.minutes:g} min)."
    )


def _words(choice: Choice, pairs: Sequence[tuple[int, AlternativeModel]]) -> str:
    """Return the pairs in words, such as "a from b and c"."""
    each = []
    for k in dict.fromkeys(k for k, _ in pairs):
        alternatives = listed(
            [place_words(*alternative.candidate.place) for i, alternative in pairs if i == k]
        )
        each.append(f"{place_words(*choice.best.members[k].place)} from {alternatives}")
    return listed(each)


def _to_describe(problem: Problem, motions: dict[str, Record]) -> str:
    """Return what would show of which kind a remainder is, as far as the records have not varied it yet."""
    if not motions:
        return "Repeat the poses on another day: what returns is a law, what does not is a disturbance."
    name, record = next(iter(motions.items()))
    wishes = []
    if len(motions) < 2:
        wishes.append("at half the speed")
    loads = {tuple(sorted((n, p.mass) for n, p in r.payloads.items())) for r in motions.values()}
    if len(loads) < 2 and problem.arm.payloads:
        wishes.append("with another payload that is weighed")
    torques = any(s.quantity == "motor_torque" for r in motions.values() for s in r.signals.values())
    if not torques and record.drive:
        wishes.append("with the motor torque logged")
    if not wishes:
        return (
            f"Repeat '{name}' unchanged: what returns of the remainder is a law that no known effect has, "
            "what does not is a disturbance."
        )
    return (
        f"Repeat '{name}' {listed(wishes)}: whether the remainder follows speed, load, torque or time alone "
        "shows what kind of law is missing."
    )
