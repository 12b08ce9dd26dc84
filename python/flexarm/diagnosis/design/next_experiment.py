"""The next experiment: the additional measurement that separates the named effects from their alternatives.

How far one parts them says `design.information_gain`. Where no known effect explains the gap, it is the
repetition that would show of which kind the remainder is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from flexarm.diagnosis.alternatives import Rival
from flexarm.diagnosis.design.candidate_measurements import Addition
from flexarm.diagnosis.design.information_gain import gains
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.selection import Choice
from flexarm.record import Record
from flexarm.wording import listed, number, place_words

ENOUGH = 10.0
"""Of additions that all promise so much ln B, the cheapest is proposed."""
MOST = 3
"""Alternatives that are simulated."""


@dataclass(frozen=True)
class NextExperiment:
    """A proposed next experiment.

    Attributes
    ----------
    sentence : str
        For a person; empty if nothing is left to separate.
    gain : float
        Expected ln Bayes factor of the named effect over the nearest of its alternatives.
    minutes : float
        Cost, roughly.
    """

    sentence: str = ""
    gain: float = 0.0
    minutes: float = 0.0


def next_experiment(choice: Choice, problem: Problem, unexplained: bool = False) -> NextExperiment:
    """Return the addition to the records at hand that parts the named effects from their alternatives best.

    Parameters
    ----------
    choice : Choice
        What was named, and what else is within reach.
    problem : Problem
        The records at hand.
    unexplained : bool
        Whether no known effect explains the gap: then, what would describe the remainder.
    """
    motions = {name: record for name, record in problem.records.items() if record.kind == "motion"}
    if unexplained:
        return NextExperiment(_to_describe(problem, motions))
    pairs = [(k, rival) for k, rivals in enumerate(choice.rivals) for rival in rivals if rival.within_reach]
    pairs = sorted(pairs, key=lambda pair: pair[1].behind)[:MOST]
    if not pairs:
        return NextExperiment()
    if not motions:
        return NextExperiment(
            f"Move the arm slowly through the poses, or weigh another payload in them: static poses alone "
            f"do not part {_words(choice, pairs)}; what that would gain has not been computed."
        )
    name, record = next(iter(motions.items()))
    found = _promising(gains(choice, problem, name, record, pairs))
    if not found:
        return NextExperiment()
    addition, gain = max(found, key=lambda pair: pair[1])
    return NextExperiment(_sentence(choice, name, addition, gain, pairs), gain, addition.minutes)


def _promising(gains: Iterator[tuple[Addition, list[float]]]) -> list[tuple[Addition, float]]:
    """Additions of the least cost at which one promises enough, else all; dearer ones are not simulated."""
    found: list[tuple[Addition, float]] = []
    for _, alike in groupby(gains, key=lambda pair: pair[0].minutes):
        new = [(addition, gain) for addition, each in alike if np.isfinite(gain := min(each))]
        if any(gain >= ENOUGH for _, gain in new):
            return new
        found += new
    return found


def _sentence(
    choice: Choice, name: str, addition: Addition, gain: float, pairs: Sequence[tuple[int, Rival]]
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


def _words(choice: Choice, pairs: Sequence[tuple[int, Rival]]) -> str:
    """Such as "a from b and c"."""
    each = []
    for k in dict.fromkeys(k for k, _ in pairs):
        rivals = listed([place_words(*rival.candidate.place) for i, rival in pairs if i == k])
        each.append(f"{place_words(*choice.best.members[k].place)} from {rivals}")
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
