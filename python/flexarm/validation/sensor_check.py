"""The data before the physics: which channels cannot be what they say, which samples are off.

A nominal model misses by centimetres where a joint gives way; it does not move the other way, 57 times too
far, or not at all. Every channel is laid beside one simulation of the nominal model and judged by how it
follows it (`checks`): slopes for signs and units, plateaus for dead and cut-off channels,
and drives by driving the model again with the fault taken back. What can be repaired (offsets, scales near 1,
delays, frames) is left to the diagnosis. Units: SI. Source: docs/diagnosis.md.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from flexarm.comparison.aligned_record import simulate_record
from flexarm.errors import InvalidParameter
from flexarm.record.plausibility import disjoint_clocks
from flexarm.simulation.endless import endless
from flexarm.validation.clock_steps import remarks_on_clocks, remarks_on_stamps, remarks_on_starts
from flexarm.validation.consensus import Verdict, merged
from flexarm.validation.drive_faults import CLEAR, DriveFinding, drive_fault, same_fault
from flexarm.validation.drive_hypotheses import wild_drives
from flexarm.validation.finding import Checked, Finding, Removed
from flexarm.validation.frame_bias import remarks_on_frames, remarks_on_poses, remarks_on_shifts
from flexarm.validation.gain_faults import findings
from flexarm.validation.initial_alignment import placing, run
from flexarm.validation.outliers import clean_drives, clean_evidence, without_rows
from flexarm.validation.record_remarks import (
    doubted,
    remarks_on_few_poses,
    remarks_on_skipped,
    without_lost_channels,
)
from flexarm.validation.stuck_drives import borne_out, constant_drive, standing_drive

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.comparison.simulated_record import SimulatedRecord
    from flexarm.record import Record
    from flexarm.simulation import Progress


def check(
    arm: Arm,
    records: Mapping[str, Record] | Sequence[Record],
    *,
    step: float = 2e-3,
    alpha: float = -0.05,
    progress: Progress = None,
) -> Checked:
    """What is wrong with records before any physics: faulty sensors, outliers, clocks, contradictions.

    Parameters
    ----------
    arm : Arm
        The nominal model.
    records : dict of str to Record, or sequence of Record
        What was measured; of a sequence the names are those of the directories.
    step, alpha : float
        Of the simulation [s], [-].
    progress : bool or callable, optional
        As in `simulate`.

    Returns
    -------
    Checked

    Raises
    ------
    InvalidParameter
        If there are no records, one names what the model does not have, or its signals have no instant in
        common with its drive.

    Examples
    --------
    >>> print(check(arm, [flexarm.Record.load("measured")]))  # doctest: +SKIP
    """
    named = named_records(records)
    outliers: list[Removed] = []
    remarks: list[str] = []
    doubts: list[str] = []
    for name, record in named.items():
        named[name], removed, notes = _readable(arm, name, record, step)
        outliers += removed
        remarks += notes
    wild = {name: wild_drives(arm, record) for name, record in named.items()}
    tame = {name: record for name, record in named.items() if not wild[name]}
    simulations, failed, empty = run(arm, tame, step, alpha, progress) if tame else ({}, {}, {})
    failed |= {
        name: f"no joint turns as {', '.join(sorted(at))} say{'s' * (len(at) == 1)}"
        for name, at in wild.items()
        if at
    }
    verdicts = []
    remarks += [
        *remarks_on_stamps(named),
        *remarks_on_starts(simulations),
        *remarks_on_few_poses(simulations),
    ]
    remarks += [f"{name} {why}: a diagnosis leaves it out" for name, why in empty.items()]
    remarks += remarks_on_skipped(simulations)
    for name in (each for each in named if each not in empty):
        if name in simulations:
            named[name], removed = clean_evidence(name, simulations[name], placing(simulations[name]))
            outliers += removed
            simulations[name] = _beside(arm, named[name], simulations[name])
        verdict = _judged(arm, name, named[name], simulations.get(name), step, alpha)
        verdicts.append(verdict)
        named[name], notes = _without_frozen(named[name], verdict)
        remarks += notes
        if name in failed and verdict.drive is None:
            doubts.append(f"{name}: the model cannot be simulated: {failed[name]}")
    remarks += remarks_on_poses(named)
    faults = merged([_again(arm, verdict, verdicts, named, step, alpha) for verdict in verdicts])
    if not faults:
        remarks += [*remarks_on_clocks(simulations), *remarks_on_frames(simulations)]
        remarks += remarks_on_shifts(simulations)
    sure = {v.record: borne_out(arm, named[v.record], v.channels) for v in verdicts if v.drive is None}
    compared = {name: tuple(simulated.evidence) for name, simulated in simulations.items()}
    return Checked(
        named,
        faults,
        tuple(outliers),
        tuple(remarks),
        {**compared, **dict.fromkeys(empty, ())},
        (*doubted(arm, named, sure), *doubts),
    )


def cleaned(arm: Arm, records: Mapping[str, Record], *, step: float = 2e-3, alpha: float = -0.05) -> Checked:
    """Records without their outliers, their sensors taken as they are: of those that no model is chosen by.

    Parameters
    ----------
    arm : Arm
        The nominal model.
    records : dict of str to Record
        What was measured.
    step, alpha : float
        Of the simulation [s], [-].

    Raises
    ------
    InvalidParameter
        If a record names what the model does not have, or holds nothing to compare.
    NotConverged
        If the model cannot be simulated along one.
    """
    named = dict(records)
    outliers: list[Removed] = []
    remarks: list[str] = []
    for name, record in named.items():
        record, removed, notes = _readable(arm, name, record, step)
        try:
            simulated = simulate_record(arm, record, align=False, step=step, alpha=alpha).simulated
        except InvalidParameter as error:
            raise InvalidParameter(str(error), where=name) from None
        named[name], more = clean_evidence(name, simulated, placing(simulated))
        outliers += [*removed, *more]
        remarks += notes
    return Checked(named, (), tuple(outliers), tuple(remarks))


def named_records(records: Mapping[str, Record] | Sequence[Record]) -> dict[str, Record]:
    """Records by name: the keys, or the names of their directories.

    Raises
    ------
    InvalidParameter
        If there are none, or something else is among them.
    """
    from flexarm.record import Record

    given: Any = records
    if isinstance(given, Mapping):
        named = dict(given)
    else:
        listed = [given] if isinstance(given, Record) else list(given)
        labels = [
            record.path.name if isinstance(record, Record) and record.path is not None else f"record_{k + 1}"
            for k, record in enumerate(listed)
        ]
        twice = len(set(labels)) < len(labels)
        named = {
            f"{label}_{k + 1}" if twice else label: r
            for k, (label, r) in enumerate(zip(labels, listed, strict=True))
        }
    if not named:
        raise InvalidParameter("must hold at least one record, got none", where="records")
    for name, record in named.items():
        if not isinstance(record, Record):
            raise InvalidParameter(
                f"must be a Record, such as Record.load gives, got {type(record).__name__}",
                where=f"records.{name}",
            )
    return named


def _readable(arm: Arm, name: str, record: Record, step: float) -> tuple[Record, list[Removed], list[str]]:
    """A record that fits the model, without empty channels and the outliers of its drives.

    Raises
    ------
    InvalidParameter
        If it names what the model does not have, a signal has no instant in common with the drive, or a run
        of it would not end.
    """
    record.check_against(arm)
    for problem in (*disjoint_clocks(record), *endless(record, step)):
        raise InvalidParameter(problem.what, where=f"records.{name}.{problem.where}")
    record, notes = without_lost_channels(name, record)
    record, removed = clean_drives(name, record)
    return record, removed, notes


def _judged(
    arm: Arm, name: str, record: Record, simulated: SimulatedRecord | None, step: float, alpha: float
) -> Verdict:
    """One record: its channels as they are, or with a drive's fault taken back if that explains more."""
    if simulated is None:
        return Verdict(name, (), drive_fault(arm, name, record, None, step, alpha))
    found = findings(name, simulated)
    standing = standing_drive(arm, record, found)
    if standing is not None:
        return Verdict(name, (), standing)
    if not any(each.name or each.strange for each in found):
        return Verdict(name, found)
    verdict = _weighed(name, found, drive_fault(arm, name, record, found, step, alpha))
    if verdict.drive is None and (still := constant_drive(arm, record, found)) is not None:
        return Verdict(name, (), still)
    return verdict


def _again(
    arm: Arm,
    verdict: Verdict,
    all_of_them: Sequence[Verdict],
    records: Mapping[str, Record],
    step: float,
    alpha: float,
) -> Verdict:
    """Channels at fault where another record shows that it is their drive: a small motion shows little."""
    sure = [v.drive for v in all_of_them if v.drive is not None and v.drive.rest and not v.tied]
    if verdict.drive is not None or not any(each.name for each in verdict.channels):
        return verdict
    for fault in sure:
        name = verdict.record
        found = same_fault(arm, name, records[name], fault, verdict.channels, step, alpha)
        if found is not None:
            return Verdict(name, found.rest, found)
    return verdict


def _beside(arm: Arm, record: Record, simulated: SimulatedRecord) -> SimulatedRecord:
    """The simulation beside the record without its outliers."""
    return simulate_record(arm, record, align=False, simulation=simulated.simulation).simulated


def _weighed(name: str, found: Sequence[Finding], drive: DriveFinding | None) -> Verdict:
    """Whichever explains the record; both where they explain it alike."""
    if drive is None:
        return Verdict(name, found)
    if drive.log_bayes > CLEAR:
        return Verdict(name, drive.rest, drive)
    return Verdict(name, found, drive, tied=True)


def _without_frozen(record: Record, verdict: Verdict) -> tuple[Record, list[str]]:
    """The record without rows that repeat a value, and what else channels show that is no fault."""
    notes = []
    for each in verdict.channels:
        if each.frozen:
            record = without_rows(record, each.channel.signal.name, each.frozen)
            notes.append(f"{verdict.record}: {each.sentence}; these rows are removed")
        elif each.sentence and not each.name:
            notes.append(f"{verdict.record}: {each.sentence}")
    return record, notes
