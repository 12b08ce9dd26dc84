"""Simulation of a record: the model is driven as the arm was, and clocks and frames are aligned."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from flexarm.arm import Arm
from flexarm.assembly import following_joints
from flexarm.comparison.align import Alignment
from flexarm.comparison.align import align as align_to
from flexarm.comparison.alignment_parameters import drive_clock, is_unknown_clock, stated_placement
from flexarm.comparison.free_vibration import rings_freely, simulate_free_vibration
from flexarm.comparison.initial_guess import initial_guess
from flexarm.comparison.poses import pair_poses, solve_poses
from flexarm.comparison.simulated_record import SimulatedRecord, pair_record
from flexarm.drive import Drive
from flexarm.drive.from_record import moving_end, true_time
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.modal import Modes, modes
from flexarm.record import Record
from flexarm.record.plausibility import disjoint_clocks, unknown_motion
from flexarm.record.time_unit import mismatched_durations

MODES = 3
NEEDS_ROTATIONS = ("orientation", "inclination", "angular_rate", "acceleration")


@dataclass(frozen=True, eq=False)
class AlignedRecord:
    """Hold a record, its simulation and their alignment."""

    simulated: SimulatedRecord
    """Simulation and record; its arm carries what the record says."""
    aligned: Alignment

    @property
    def record(self) -> Record:
        """Return the record."""
        return self.simulated.record

    @cached_property
    def modes(self) -> tuple[tuple[float, float], ...]:
        """Return frequency [Hz] and damping ratio of the first three visible modes; none for poses."""
        return tuple(_modes(self)) if self.record.kind == "motion" else ()

    @property
    def modes_hz(self) -> tuple[float, ...]:
        """Return the frequencies of these modes [Hz]."""
        return tuple(frequency for frequency, _ in self.modes)

    @cached_property
    def joint(self) -> str | None:
        """Return the only joint that is driven, or that can move if none is driven; None for several."""
        moved = {self.record.signals[name].joint for name in self.record.drive}
        moved = moved or {joint.name for joint in self.simulated.simulation.arm.moving_joints}
        return moved.pop() if len(moved) == 1 else None


def by_name(pairs: Mapping[str, AlignedRecord] | AlignedRecord) -> dict[str, AlignedRecord]:
    """Return aligned records by name, a single one as "record".

    Raise InvalidParameter if there is none.
    """
    records = {"record": pairs} if isinstance(pairs, AlignedRecord) else dict(pairs)
    if not records:
        raise InvalidParameter("needs at least one record beside its simulation, got none", where="pairs")
    return records


def simulate_record(
    arm: Arm,
    record: Record,
    align: bool = True,
    *,
    simulation: Any = None,
    step: float = 2e-3,
    alpha: float = -0.05,
) -> AlignedRecord:
    """Simulate a record and align it; parameters and errors as of `compare`."""
    if not isinstance(record, Record):
        raise InvalidParameter(
            f"must be a Record, such as Record.load gives, got {type(record).__name__}", where="record"
        )
    if record.kind == "frequency_response":
        what = "is a frequency response, which no simulation repeats; flexarm.compare_responses takes it"
        raise InvalidParameter(what, where="kind")
    record = record.with_units_of(arm)
    carried = record.applied_to(arm)
    if record.kind == "static":
        pair = pair_poses(solve_poses(carried, record) if simulation is None else simulation, record, carried)
    else:
        run = _simulate(carried, record, step, alpha) if simulation is None else simulation
        pair = pair_record(run, record, arm=carried)
    if not pair.evidence:
        reasons = "; ".join(f"{name}: {why}" for name, why in pair.skipped.items())
        what = f"holds nothing to compare with a simulation ({reasons or 'only drives'})"
        raise InvalidParameter(what, where="signals")
    start = stated_placement(record)
    return AlignedRecord(pair, align_to(pair, initial_guess(pair, start)) if align else Alignment(start))


def _simulate(arm: Arm, record: Record, step: float, alpha: float) -> Any:
    """Simulate the record's drive up to the last stamp of a known clock."""
    from flexarm.simulation import simulate

    if rings_freely(record):
        return simulate_free_vibration(arm, record, step)
    require_known_drive(record)
    drive = Drive.from_record(record, arm)
    end = end_of_simulation(record, arm, drive.start)
    return simulate(arm, drive, step=step, alpha=alpha, end=end, **needed_outputs([record]))


def needed_outputs(records: Iterable[Record]) -> dict[str, Any]:
    """Return options of `simulate` for the outputs that signals of some records are read from."""
    seen = {signal.quantity for record in records for signal in record.signals.values()}
    return {"rotations": not seen.isdisjoint(NEEDS_ROTATIONS), "forces": "strain" in seen}


def require_known_drive(record: Record) -> None:
    """Refuse a record that shows what its drive does not.

    Raise InvalidParameter if a signal has no instant in common with the drive, shows a motion while that is
    unknown, or has stamps in another unit.
    """
    for problem in (*mismatched_durations(record), *disjoint_clocks(record), *unknown_motion(record)):
        raise InvalidParameter(problem.what, where=problem.where)


def end_of_simulation(record: Record, arm: Arm, start: float) -> float:
    """Return the last instant of all stamps, less delays of their clocks, and three sigma more [s].

    That is no later than a drive is known that moves at its end.
    """
    own = record.clocks[drive_clock(record)].offset
    ends = []
    for signal in record.signals.values():
        clock = record.clocks[signal.clock]
        if len(signal.time) and (signal.name in record.drive or not is_unknown_clock(record, signal.clock)):
            late = clock.offset - own - (0.0 if signal.name in record.drive else 3 * clock.sigma)
            ends.append(float(true_time(signal, arm, start, late)[-1]))
    return min(max(ends, default=record.duration) + 1e-9, moving_end(record, arm, start))


def _modes(pair: AlignedRecord) -> list[tuple[float, float]]:
    """Return modes of the arm at the middle of its motion; none if it has no equilibrium there."""
    run, arm, record = pair.simulated.simulation, pair.simulated.arm, pair.record
    angles = np.asarray(run.drive_angle)
    driven = {*record.joints, *(str(record.signals[name].joint) for name in record.drive)}
    follow = following_joints(arm, (), driven)
    middle = {
        name: float((angles[:, j].min() + angles[:, j].max()) / 2)
        for j, name in enumerate(run.joints)
        if arm.joint(name).moves and name not in follow
    }
    try:
        found = modes(arm, joints=middle, count=2 * MODES)
    except (InvalidParameter, NotConverged):
        return []
    pairs = zip(found.frequency_hz.tolist(), found.damping_ratio.tolist(), strict=True)
    return [pair for pair, seen in zip(pairs, _visible(pair, found), strict=True) if seen][:MODES]


def _visible(pair: AlignedRecord, found: Modes) -> list[bool]:
    """Return True for modes that move a point along a measured axis; for all without such axes."""
    # Part of a mode's motion of the points that a measured axis must show; a frame may be turned by as
    # much.
    visible = 0.01
    simulated, largest = pair.simulated, np.zeros(len(found.frequency_hz))
    for signal in simulated.evidence.values():
        if signal.quantity == "position":
            axes = simulated.axes(signal, pair.aligned.placement)
            moved = found.shape[:, found.points.index(signal.point), :3] @ axes
            largest = np.maximum(largest, np.abs(moved).max(axis=1))
        elif signal.point is not None or signal.link is not None:
            return [True] * len(largest)
    if not np.any(largest):
        return [True] * len(largest)
    return [bool(seen) for seen in largest > visible * np.abs(found.shape[:, :, :3]).max(axis=(1, 2))]


MOVING_RATE = 0.05
"""Share of its greatest rate above which a drive moves [-]; `ValidationPolicy` has it too."""


def moving_starts(simulated: SimulatedRecord) -> Iterator[str]:
    """Yield a sentence on each drive that moves in the first sample, if the record states a start at rest.

    A simulation that begins at rest with a moving drive rings, which the arm did not.
    """
    record, run = simulated.record, simulated.simulation
    if record.kind == "static" or record.initial == "moving":
        return
    for signal in (record.signals[drive] for drive in record.drive):
        if signal.quantity != "joint_angle":
            continue
        rate = np.abs(run.drive_rate[:, run.joints.index(signal.joint)])
        if len(rate) > 1 and rate[1] > MOVING_RATE * rate.max():
            share = f"{100 * rate[1] / rate.max():.0f} % of its greatest rate"
            yield (
                f"{signal.name} moves in the first sample, at {share}, and the record says that it begins at "
                'rest; if it does not, state initial = "moving"'
            )
