"""Planning: which effects an experiment could tell apart, before it is run.

    motions, sensors -> virtual records of the nominal model -> response to every effect at every place
    -> expected log Bayes factors of all pairs -> additions that separate indistinguishable pairs

Candidates, probes and nuisance parameters are those of a diagnosis, without data; `design.separation` has the
equations.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from math import inf, sqrt
from typing import TYPE_CHECKING

from flexarm.arguments import DRIVES, takes
from flexarm.arm import Arm
from flexarm.arm.joint_units import parameters_in
from flexarm.configuration import version
from flexarm.diagnosis.design.candidate_measurements import menu
from flexarm.diagnosis.design.experiment import from_drive, from_record
from flexarm.diagnosis.design.plan_result import Plan, PlannedEffect, Tie
from flexarm.diagnosis.design.separation import (
    VirtualExperiments,
    against_none,
    cliques,
    gaps_of,
    lesser_factor,
    matrix,
    pairs,
    shown_by,
    ties,
)
from flexarm.diagnosis.policy import DESIGN, SelectionPolicy
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter
from flexarm.record import Record

if TYPE_CHECKING:
    from flexarm.arm.effect import Effect
    from flexarm.diagnosis.candidate import Candidate
    from flexarm.diagnosis.design.separation import Shown
    from flexarm.record import Clock, Frame


def planned_effect(
    candidate: Candidate, shown: Shown, seen: float, arm: Arm, signals: Mapping[str, str]
) -> PlannedEffect:
    """Return an effect as it is shown, and the smallest one that is detected.

    `seen` is the expected log Bayes factor at the size shown over no effect, eq. (2) of `separation`;
    `signals` has units of signals, for effects that have that of their signal.
    """
    size = candidate.probes[shown.probe]
    own = signals.get(candidate.effect.at, "")
    units = {name: own if unit == "SI" else unit for name, _, unit in parameters_in(size, arm)}
    moved = (
        name
        for name in candidate.free
        if name not in size.shape and abs(size.value_of(name) - candidate.null.get(name, 0.0)) > 0
    )
    name = next(moved, candidate.free[0])
    value, null = size.value_of(name), candidate.null.get(name, 0.0)
    times = sqrt(SelectionPolicy.strong_evidence / seen) if seen > 0 else inf
    if candidate.effect.is_spring:
        there = candidate.without.value_of(name) if candidate.without is not None else inf
        change = 1.0 / value - 1.0 / there
        least = 1.0 / (1.0 / there + times * change)
    else:
        there, least = null, null + times * (value - null)
    why = hidden(arm, candidate.effect, seen)
    return PlannedEffect(*candidate.spot, name, units[name], value, there, least, seen, why)


def hidden(arm: Arm, effect: Effect, seen: float) -> str:
    """Return why an effect is not seen at any plausible size; empty where it is.

    A torque on a joint that cannot give way is taken by the drive.
    """
    sprung = any(each.is_spring for each in arm.effects_at(effect.at))
    driven = effect.at not in {closure.name for closure in arm.closures}
    if effect.torque_at is not None and seen < DESIGN.nothing and driven and not sprung:
        return f"{effect.at} is rigid in the model: its drive takes the torque, which no sensor shows"
    if not seen > 0:
        return "it moves nothing that is measured"
    return (
        f"not seen at {DESIGN.far:g} times that size either"
        if DESIGN.far**2 * seen < SelectionPolicy.strong_evidence
        else ""
    )


Progress = Callable[[float, str], object] | None


@takes(drives=DRIVES)
def plan(
    arm: Arm,
    drives: Mapping[str, Drive | Record] | Sequence[Drive | Record],
    *,
    clocks: Mapping[str, Clock] | None = None,
    frames: Mapping[str, Frame] | None = None,
    n_jobs: int | None = None,
    step: float = 4e-3,
    alpha: float = -0.05,
    progress: Progress = None,
) -> Plan:
    """Find the effects that an experiment could tell apart, and the cheapest addition for the others.

    Parameters
    ----------
    arm : Arm
        The nominal model, with `[[sensors]]`; without them a tracker of its last point is assumed, and said.
    drives : dict of str to Drive or Record, or sequence of them
        The motions. A record is made again: its signals, rates, noise, clocks, frames and payloads.
    clocks, frames : dict, optional
        How well clocks and frames of the model's sensors are known, as a record would state it.
    n_jobs : int, optional
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
    given = drives if isinstance(drives, Mapping) else {f"run_{k + 1}": each for k, each in enumerate(drives)}
    runs = [
        from_record(name, drive, arm)
        if isinstance(drive, Record)
        else from_drive(name, drive, arm, clocks, frames)
        for name, drive in given.items()
    ]
    if not runs:
        raise InvalidParameter("needs at least one motion", where="drives")
    tell(0.02, "simulating")
    additions = menu(arm, runs, runs[0].run(arm, step, alpha))
    lab = VirtualExperiments(arm, additions, step, alpha, n_jobs or os.cpu_count() or 1)
    responses = lab.base(runs, lambda done: tell(0.05 + 0.5 * done, "probing effects"))
    base = responses.only(lab.rows())
    shown = shown_by(base)
    seen = against_none(base, gaps_of(base, shown))
    factors = matrix(base, shown)
    tied = ties(factors, seen)
    tell(0.6, "looking for additions")
    partings = lab.partings(responses, shown, tied, seen, lambda done: tell(0.6 + 0.4 * done, "additions"))
    said = tuple(dict.fromkeys(sentence for run in runs for sentence in run.assumed))
    places = [each[0].candidate.spot for each in base.effects]
    return Plan(
        arm,
        tuple(run.name for run in runs),
        tuple(
            planned_effect(variants[s.variant].candidate, s, float(e), arm, lab.units)
            for variants, s, e in zip(base.effects, shown, seen, strict=True)
        ),
        factors,
        tuple(cliques(tied)),
        tuple(
            Tie(places[i], places[j], lesser_factor(factors, seen, i, j), tuple(partings.get((i, j), ())))
            for i, j in pairs(tied)
        ),
        said,
        {"version": version(), "seconds": time.monotonic() - begun},
    )
