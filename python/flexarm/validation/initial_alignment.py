"""Initial alignment of clocks and frames, and the simulations of all records by the nominal model.

The first guess of an unknown frame (`flexarm.comparison.initial_guess`) turns with a faulty channel. The
candidates are therefore the guess of all signals of the frame and that of each signal alone. The one is
chosen for which the median signal has the least scatter relative to its motion.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from flexarm.arm import Arm
from flexarm.budget import allows, current
from flexarm.comparison.aligned_record import needed_outputs, simulate_record
from flexarm.comparison.alignment_parameters import stated_placement
from flexarm.comparison.free_vibration import rings_freely, simulate_free_vibration
from flexarm.comparison.initial_guess import initial_guess
from flexarm.comparison.poses import solve_poses
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.record import Record
from flexarm.simulation import Progress
from flexarm.simulation.simulate_all import simulate_all


def initial_alignment(simulated: SimulatedRecord) -> Placement:
    """Return clocks and frames as stated, unknown ones as most signals have them."""
    start = stated_placement(simulated.record)
    found = initial_guess(simulated, start)
    for name, frame in simulated.record.frames.items():
        seen = [s for s in simulated.evidence.values() if s.frame == name and s.quantity == "position"]
        if not frame.unknown or len(seen) < 2:
            continue
        guesses = [found]
        for signal in seen:
            alone = initial_guess(replace(simulated, signals={signal.name: signal}), start)
            guesses.append(Placement(found.clocks, {**found.frames, name: alone.frames[name]}))
        found = min(guesses, key=lambda placement: _relative_scatter(simulated, placement, name))
    return found


def _relative_scatter(simulated: SimulatedRecord, placement: Placement, frame: str) -> float:
    """Return scatter over motion of the median signal of a frame, offsets aside."""
    shares = []
    for signal in simulated.evidence.values():
        if signal.frame == frame and signal.quantity == "position":
            residual = simulated.residual(signal, placement, hold=True)
            motion = float(np.nanstd(simulated.predicted(signal, placement, hold=True)))
            shares.append(float(np.nanstd(residual - np.nanmean(residual, axis=0))) / (motion or 1.0))
    return float(np.median(shares))


def simulate_records(
    arm: Arm, records: Mapping[str, Record], step: float, alpha: float, progress: Progress = None
) -> tuple[dict[str, SimulatedRecord], dict[str, str], dict[str, str]]:
    """Return simulated records by name, and reasons for those that fail and those with nothing to compare."""
    try:
        runs = _simulations(arm, records, step, alpha, progress)
    except (InvalidParameter, NotConverged):
        runs = {}  # one of them fails: simulate each by itself
    found: dict[str, SimulatedRecord] = {}
    failed: dict[str, str] = {}
    empty: dict[str, str] = {}
    for name, record in records.items():
        if name not in runs and not allows(f"the simulation of {name}"):
            failed[name] = f"not within {current().seconds:g} s"
            continue
        try:
            mine = runs[name] if name in runs else _simulations(arm, {name: record}, step, alpha)[name]
        except KeyError:
            failed[name] = f"not within {current().seconds:g} s"
            continue
        except (InvalidParameter, NotConverged) as error:
            failed[name] = str(error)
            continue
        try:
            found[name] = simulate_record(arm, record, align=False, simulation=mine, step=step).simulated
        except InvalidParameter as error:
            empty[name] = error.problems[0].what
    return found, failed, empty


def _simulations(
    arm: Arm, records: Mapping[str, Record], step: float, alpha: float, progress: Progress = None
) -> dict[str, Any]:
    """Simulate motions in parallel and poses one after the other."""
    moving = {
        name: record
        for name, record in records.items()
        if record.kind == "motion" and not rings_freely(record)
    }
    budget = current()
    runs = simulate_all(
        [(arm, record) for record in moving.values()],  # `simulate` applies the record
        progress=progress,
        stop=lambda: budget.spent,
        step=step,
        alpha=alpha,
        **needed_outputs(moving.values()),
    )
    found: dict[str, Any] = dict(zip(moving, runs, strict=False))
    for name, record in records.items():
        if record.kind == "static":
            found[name] = solve_poses(record.applied_to(arm), record)
        elif rings_freely(record):
            found[name] = simulate_free_vibration(record.applied_to(arm), record, step)
    return found
