"""Comparison of a model with a record."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arguments import ROW, takes
from flexarm.arm import Arm
from flexarm.comparison.align import Alignment
from flexarm.comparison.aligned_record import AlignedRecord, moving_starts, simulate_record
from flexarm.comparison.alignment_parameters import uncertain_clock_and_frame
from flexarm.comparison.bands import alias
from flexarm.comparison.comparison import Comparison
from flexarm.comparison.drive_outliers import RemovedOutliers, clean_drives
from flexarm.comparison.free_vibration import rings_freely
from flexarm.comparison.gap import SignalGap, signal_gap
from flexarm.comparison.simulated_record import SimulatedRecord
from flexarm.comparison.step_check import step_notes
from flexarm.drive.lead_in import LEAD
from flexarm.measurement.drive_noise import with_drive_noise
from flexarm.measurement.outliers import SMOOTH, row_list
from flexarm.record import Record
from flexarm.record.compatibility import unplaced_effects
from flexarm.wording import with_unit


@takes(bands=ROW)
def compare(
    arm: Arm,
    record: Record,
    align: bool = True,
    *,
    simulation: Any = None,
    step: float = 2e-3,
    alpha: float = -0.05,
    bands: Sequence[float] | None = None,
    check_step: bool = False,
) -> Comparison:
    """Compare a model with a record: the gap by signal, direction and band, and the noise.

    The record's drive, smoothed by its stated noise, drives the model, with the model's effects on its sensor
    taken back; what the run carried and where undriven joints stood comes from the record. Every other signal
    that the simulation predicts is evidence, at its own instants. Clocks and frames are aligned within their
    stated sigmas (see `flexarm.comparison.align`), which costs no simulation; gross outliers of places and
    angles count neither there nor in the gap, those of drives do not drive, and all are said. Poses of a
    static record are equilibria.

    Parameters
    ----------
    arm : Arm
        The model.
    record : Record
        Measured data.
    align : bool
        Align clocks and frames; False takes them as stated, and all rows.
    simulation : Simulation, optional
        A run of this model along this record, to be used instead of a new one. Effects on sensors, clocks and
        frames count as `arm` has them; those on signals that drive must be those of the run.
    step, alpha : float
        Of the simulation [s], [-].
    bands : sequence of float, optional
        Inner edges of the bands [Hz]; default: half and twice the first mode that the sensors see.
    check_step : bool
        Simulate once more with half the step, and note predictions that move by more than half their noise.

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
    record, removed = clean_drives("", record) if align and simulation is None else (record, [])
    record, smoothed = with_drive_noise(record) if simulation is None else (record, [])
    pair = simulate_record(arm, record, align, simulation=simulation, step=step, alpha=alpha)
    steps = step_notes(arm, pair, step, alpha) if check_step else ()
    return comparison_of(pair, align, bands, (*map(_about_removed, removed), *smoothed, *steps))


def comparison_of(
    pair: AlignedRecord,
    align: bool = True,
    bands: Sequence[float] | None = None,
    notes: Iterable[str] = (),
    other: Comparison | None = None,
) -> Comparison:
    """Return the gap of an aligned record, as `compare` does, with more `notes`.

    Bands are those of an `other` model's comparison where one is given.
    """
    simulated, aligned, record = pair.simulated, pair.aligned, pair.record
    modes_hz = pair.modes_hz if bands is None else ()
    around = modes_hz if other is None else other.modes_hz
    gaps = {}
    for name, signal in simulated.signals.items():
        outliers = aligned.outliers.get(name) if signal.quantity in SMOOTH else None
        gaps[name] = signal_gap(simulated, signal, aligned.placement, pair.joint, around, bands, outliers)
    unplaced = [f"{problem.where} {problem.what}" for problem in unplaced_effects(record, simulated.arm)]
    return Comparison(
        simulated.arm.name,
        record.description,
        gaps,
        aligned,
        dict(simulated.skipped),
        modes_hz,
        (
            *unplaced,
            *moving_starts(simulated),
            *_unknown_ends(pair),
            *_notes(record, gaps, modes_hz, aligned, align),
            *notes,
        ),
        _found_frames(simulated, aligned) if align else {},
    )


def _found_frames(
    simulated: SimulatedRecord, aligned: Alignment
) -> dict[str, tuple[list[float], list[float]]]:
    """Return poses of the frames of which the record knows nothing, with effects of the model on them."""
    seen = {signal.frame: signal for signal in simulated.evidence.values()}
    return {
        name: simulated.frame(seen[name], aligned.placement).pose
        for name, frame in simulated.record.frames.items()
        if frame.unknown and name in seen
    }


def _unknown_ends(pair: AlignedRecord) -> list[str]:
    """Return notes on rows after the end of a drive that moves there."""
    simulated, found = pair.simulated, []
    for name, signal in simulated.evidence.items() if pair.record.kind == "motion" else ():
        instants = simulated.instants(signal, pair.aligned.placement)
        if late := int(np.sum(instants > simulated.simulation.time[-1])):
            found.append(f"{late} of {len(signal)} rows of {name} lie after the drives, and are not compared")
    return found


def _notes(
    record: Record, gaps: dict[str, SignalGap], modes_hz: Sequence[float], aligned: Alignment, wanted: bool
) -> list[str]:
    """Return notes on the numbers."""
    found = _about_drives(record)
    if aligned.undetermined:
        found.append(f"not determined by the data, left as stated: {', '.join(aligned.undetermined)}")
    found += aligned.overfitted
    if aligned.beyond_prior:
        found.append(f"moved further than the record allows for: {', '.join(aligned.beyond_prior)}")
    found += [_about_outliers(gaps[name], rows) for name, rows in aligned.outliers.items()]
    found += [
        f"{gap.removed} of {gap.removed + len(gap.time)} rows of {gap.name} are outliers as the model has "
        "them, and removed"
        for gap in gaps.values()
        if gap.removed
    ]
    if wanted:
        found += _about_noise(record, [g.name for g in gaps.values() if not g.noise_rms and not g.is_drive])
    for gap in gaps.values():
        nyquist = gap.bands[-1].high if gap.bands else np.inf
        if modes_hz and modes_hz[0] > nyquist:
            found.append(
                f"{gap.name} is sampled at {2 * nyquist:.3g} Hz: the first mode, {modes_hz[0]:.3g} Hz, "
                f"appears at {alias(modes_hz[0], 2 * nyquist):.3g} Hz"
            )
    return found


def _about_noise(record: Record, unweighed: Sequence[str]) -> list[str]:
    """Report clocks and frames that signals without a stated noise do not align."""
    found: dict[tuple[str, ...], list[str]] = {}
    for name in unweighed:
        if places := uncertain_clock_and_frame(record, record.signals[name]):
            found.setdefault(places, []).append(name)
    return [
        f"no noise is stated for {', '.join(names)}: not used to align {' and '.join(places)}"
        for places, names in found.items()
    ]


def _about_outliers(gap: SignalGap, rows: NDArray[np.bool_]) -> str:
    """Describe the use of the gross outliers of a signal."""
    if gap.gross:
        many = len(gap.gross) > 1
        return (
            f"{len(gap.gross)} outlier{'s' * many} of {gap.name}, {row_list(gap.gross)}, "
            f"{'count' if many else 'counts'} neither in the alignment nor in these numbers (--raw: in all)"
        )
    return f"{int(rows.sum())} outliers of {gap.name} were not used to align, but count in these numbers"


def _about_removed(drive: RemovedOutliers) -> str:
    """Describe the outliers of a drive."""
    many = "s" * (len(drive.rows) > 1)
    off = with_unit(drive.size, drive.unit)
    return (
        f"{len(drive.rows)} outlier{many} of the drive {drive.signal}, {row_list(drive.rows)}, {off} off, "
        "left out (--raw: all rows drive)"
    )


def _about_drives(record: Record) -> list[str]:
    """Report causes of ringing of the model but not of the arm."""
    found = []
    if rings_freely(record):
        found.append(
            "nothing drives the arm: its modes ring freely about the equilibrium, from amplitudes that the "
            "record shows"
        )
    elif record.initial == "moving":
        found.append(
            f"the record starts moving: the simulation comes from rest in {LEAD:g} s before it, and what the "
            "arm rang with is not known"
        )
    rough = [name for name in record.drive if record.signals[name].noise_std is None]
    if rough and record.kind == "motion":
        found.append(
            f"no noise is stated for the drive {', '.join(rough)}: its samples are joined as they are"
        )
    first = record.signals[record.drive[0]].clock if record.drive else ""
    for name in record.drive:
        clock = record.signals[name].clock
        if clock != first and (sigma := record.clocks[clock].sigma) > 0:
            by = with_unit(sigma, "s")
            found.append(f"the clock of the drive {name} is uncertain by {by}; its offset is taken as stated")
    return found
