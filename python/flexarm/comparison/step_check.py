"""Check whether the time step is fine enough for what the sensors see.

The method is of second order: with the change c of a prediction where a step h is halved, the step

    h' = h sqrt(fine noise / c)                                                                       (1)

brings the change to `fine` of the noise.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import floor, log10, sqrt
from typing import TYPE_CHECKING

import numpy as np

from flexarm.comparison.aligned_record import simulate_record
from flexarm.errors import NotConverged

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.comparison.aligned_record import AlignedRecord
    from flexarm.record import Signal


def step_notes(arm: Arm, pair: AlignedRecord, step: float, alpha: float) -> Iterator[str]:
    """Yield a sentence for each signal that half a time step moves by more than `fine` of its noise.

    Takes one more simulation of twice the work; nothing for poses.
    """
    if pair.record.kind == "static":
        return
    step = step_taken(pair, step)
    try:
        finer = simulate_record(arm, pair.record, align=False, step=step / 2, alpha=alpha)
    except NotConverged:
        return
    for signal in pair.simulated.evidence.values():
        noise = float(np.sqrt(np.sum(pair.simulated.noise(signal) ** 2)))
        said = step_note(change(pair, finer, signal), noise, step)
        if said:
            yield f"{signal.name}: {said}"


def step_taken(pair: AlignedRecord, asked: float) -> float:
    """Return the step of a simulation [s]: less than is asked for where controllers sample more often."""
    solver = getattr(pair.simulated.simulation, "solver", {})  # of poses and free motions there is none
    return float(solver.get("step", asked))


def step_note(moved: float, noise: float, step: float) -> str:
    """Return in words that half a step moves a prediction too far, and what step would do (1); else ""."""
    fine = 0.5  # least change of a prediction over its noise, where the step is halved, that is reported
    if not 0 < fine * noise < moved < np.inf:
        return ""
    enough = step * sqrt(fine * noise / moved)  # eq. (1)
    digit = 10.0 ** (floor(log10(enough)) - 1)
    return (
        f"half the time step of {1e3 * step:.3g} ms moves the prediction by {moved / noise:.2g} times the "
        f"noise; take a step of {1e3 * floor(enough / digit) * digit:.3g} ms or less (--step)"
    )


def change(pair: AlignedRecord, other: AlignedRecord, signal: Signal) -> float:
    """Return the rms change of a prediction, all channels together, at the record's own instants."""
    placement = pair.aligned.placement
    there = other.simulated.residual(signal, placement) - pair.simulated.residual(signal, placement)
    squares = np.sum(there**2, axis=1)
    return float(np.sqrt(np.nanmean(squares))) if np.isfinite(squares).any() else 0.0
