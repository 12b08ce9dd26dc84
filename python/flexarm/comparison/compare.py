"""The gap between a model and a record: the model is driven as the arm was, and seen as the arm was seen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.comparison.align import Aligned
from flexarm.comparison.align import align as align_to
from flexarm.comparison.bands import alias
from flexarm.comparison.comparison import Comparison
from flexarm.comparison.gap import SignalGap, signal_gap
from flexarm.comparison.poses import is_input, pose_numbers, solve_poses
from flexarm.comparison.start import first_guess
from flexarm.comparison.subject import Subject, subject
from flexarm.comparison.unknowns import drive_clock, stated
from flexarm.drive import Drive, true_time
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.record.against_arm import unplaced_effects

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record

NEEDS_ROTATIONS = ("orientation", "inclination", "angular_rate", "acceleration")


def compare(
    arm: Arm,
    record: Record,
    align: bool = True,
    *,
    simulation: Any = None,
    step: float = 2e-3,
    alpha: float = -0.05,
    bands: Sequence[float] | None = None,
) -> Comparison:
    """The gap between a model and a record, per signal, direction and band, against the noise.

    The record's drive, smoothed by its stated noise, drives the model, with the model's effects on its sensor
    taken back; what the run carried and where undriven joints stood comes from the record. Every other signal
    that the simulation predicts is evidence, at its own instants. Clocks and frames are aligned within their
    stated sigmas (see `flexarm.comparison.align`), which costs no simulation. Poses of a static record are
    equilibria.

    Parameters
    ----------
    arm : Arm
        The model.
    record : Record
        What was measured.
    align : bool
        Whether to align clocks and frames; False takes them as stated.
    simulation : Simulation, optional
        A run of this model along this record, to be used instead of a new one. Effects on sensors, clocks and
        frames count as `arm` has them; those on signals that drive must be those of the run.
    step, alpha : float
        Of the simulation [s], [-].
    bands : sequence of float, optional
        Inner edges of the bands [Hz]; default: half and twice the arm's first mode.

    Returns
    -------
    Comparison

    Raises
    ------
    InvalidParameter
        If the record names what the model does not have, or nothing in it can be compared.
    NotConverged
        If the simulation fails.

    Examples
    --------
    >>> print(flexarm.compare(arm, flexarm.Record.load("measured")))  # doctest: +SKIP
    """
    from flexarm.record import Record

    if not isinstance(record, Record):
        raise InvalidParameter(
            f"must be a Record, such as Record.load gives, got {type(record).__name__}", where="record"
        )
    carried = record.applied_to(arm)
    pair = _subject(carried, record, simulation, step, alpha)
    if not pair.evidence:
        reasons = "; ".join(f"{name}: {why}" for name, why in pair.skipped.items())
        raise InvalidParameter(
            f"holds nothing to compare with a simulation ({reasons or 'only drives'})", where="signals"
        )
    start = stated(record)
    aligned = align_to(pair, first_guess(pair, start)) if align else Aligned(start)
    modes_hz = _modes(carried, record, pair) if bands is None and record.kind == "motion" else []
    joint = _only_joint(pair)
    gaps = {
        name: signal_gap(pair, signal, aligned.placement, joint, modes_hz, bands)
        for name, signal in pair.signals.items()
    }
    return Comparison(
        arm.name,
        record.description,
        gaps,
        aligned,
        dict(pair.skipped),
        tuple(modes_hz),
        (*_about_effects(carried, record), *_notes(record, gaps, modes_hz, aligned, align)),
    )


def _subject(arm: Arm, record: Record, simulation: Any, step: float, alpha: float) -> Subject:
    """The simulation beside the record."""
    if record.kind == "static":
        inputs = {
            name: "is an input of the poses"
            for name, signal in record.signals.items()
            if is_input(record, signal)
        }
        return subject(simulation or solve_poses(arm, record), record, pose_numbers(record), inputs, arm)
    return subject(_run(arm, record, step, alpha) if simulation is None else simulation, record, arm=arm)


def _run(arm: Arm, record: Record, step: float, alpha: float) -> Any:
    """The record's drive through the model, up to the last stamp that a known clock gave."""
    from flexarm.simulation import simulate

    quantities = {signal.quantity for signal in record.signals.values()}
    drive = Drive.from_record(record, arm)
    return simulate(
        arm,
        drive,
        step=step,
        alpha=alpha,
        end=_end(record, arm, drive.start),
        rotations=bool(quantities & set(NEEDS_ROTATIONS)),
        forces="strain" in quantities,
    )


def _end(record: Record, arm: Arm, start: float) -> float:
    """Last instant that is needed: every stamp less what its clock is late, and three sigma more."""
    own = record.clocks[drive_clock(record)].offset
    ends = []
    for signal in record.signals.values():
        clock = record.clocks[signal.clock]
        if len(signal.time) and (not clock.unknown or signal.name in record.drive):
            late = 0.0 if signal.name in record.drive else clock.offset - own - 3 * clock.sigma
            ends.append(float(true_time(signal, arm, start, late)[-1]))
    return max(ends, default=record.duration) + 1e-9


def _modes(arm: Arm, record: Record, pair: Subject) -> list[float]:
    """Frequencies of the arm at the middle of its motion [Hz]; none if it has no equilibrium there."""
    from flexarm.modal import modes

    run = pair.simulation
    angles = np.asarray(run.drive_angle)
    middle = {
        name: float((angles[:, j].min() + angles[:, j].max()) / 2)
        for j, name in enumerate(run.joints)
        if arm.joint(name).moves
    }
    try:
        return [float(f) for f in modes(arm, joints=middle, count=3).frequency_hz]
    except (InvalidParameter, NotConverged):
        return []


def _only_joint(pair: Subject) -> str | None:
    """The one joint that the record drives, or that could move where nothing is driven; None: several."""
    record = pair.record
    moved = {record.signals[name].joint for name in record.drive}
    moved = moved or {joint.name for joint in pair.simulation.arm.moving_joints}
    return moved.pop() if len(moved) == 1 else None


def _notes(
    record: Record, gaps: dict[str, SignalGap], modes_hz: list[float], aligned: Aligned, wanted: bool
) -> list[str]:
    """What a reader of the numbers should know."""
    found = _about_drives(record)
    if aligned.undetermined:
        found.append(f"not determined by the data, left as stated: {', '.join(aligned.undetermined)}")
    if aligned.far:
        found.append(f"moved further than the record allows for: {', '.join(aligned.far)}")
    found += [
        f"{count} outliers of {name} were not used to align" for name, count in aligned.left_out.items()
    ]
    found += [
        f"{gap.removed} of {gap.removed + len(gap.time)} rows of {gap.name} are outliers as the model has "
        "them, and removed"
        for gap in gaps.values()
        if gap.removed
    ]
    if wanted:
        unweighed = [g.name for g in gaps.values() if not g.noise_rms and not g.is_drive]
        if unweighed and aligned.unknowns:
            found.append(f"no noise is stated for {', '.join(unweighed)}: not used to align")
    for gap in gaps.values():
        nyquist = gap.bands[-1].high if gap.bands else np.inf
        if modes_hz and modes_hz[0] > nyquist:
            found.append(
                f"{gap.name} is sampled at {2 * nyquist:.3g} Hz: the first mode, {modes_hz[0]:.3g} Hz, "
                f"appears at {alias(modes_hz[0], 2 * nyquist):.3g} Hz"
            )
    return found


def _about_effects(arm: Arm, record: Record) -> list[str]:
    """Effects whose place the record has not."""
    return [f"{problem.where} {problem.what}" for problem in unplaced_effects(record, arm)]


def _about_drives(record: Record) -> list[str]:
    """What may ring the model and not the arm."""
    found = []
    if record.initial == "moving":
        found.append("the record starts moving, the simulation from rest in equilibrium: it rings at first")
    rough = [name for name in record.drive if record.signals[name].noise_std is None]
    if rough and record.kind == "motion":
        found.append(
            f"no noise is stated for the drive {', '.join(rough)}: its samples are joined as they are"
        )
    return found
