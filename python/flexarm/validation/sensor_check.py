"""Validation of records before any physics: faulty channels, wrong drives, outliers, clocks and frames.

A nominal model that lacks an effect misses by centimetres. It does not move the other way, 57 times too far,
or not at all. Each channel is therefore compared with one simulation of the nominal model:

1. outliers of drives and channels that hold no value are removed;
2. the gain of each channel tells signs and units, its plateaus tell dead, frozen and saturated channels;
3. the model is driven again with a fault of the drive taken back, if channels that it moves are disturbed;
4. findings of all records are merged by sensor.

Offsets, scales near 1, delays and frames can be estimated and are left to the diagnosis. Units: SI.
Source: docs/diagnosis.md.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from flexarm.arm import Arm
from flexarm.budget import current
from flexarm.comparison.aligned_record import moving_starts, simulate_record
from flexarm.comparison.drive_outliers import RemovedOutliers, blank_rows, clean_drives
from flexarm.comparison.simulated_record import SimulatedRecord
from flexarm.errors import InvalidParameter
from flexarm.measurement.drive_noise import with_drive_noise
from flexarm.record import Record
from flexarm.record.plausibility import disjoint_clocks
from flexarm.record.step_limit import endless
from flexarm.record.time_unit import mismatched_durations
from flexarm.simulation import Progress, reported
from flexarm.validation.channel import Channel, channels
from flexarm.validation.clocks import remarks_on_clocks, remarks_on_late_signals, unshared_clocks
from flexarm.validation.drive_faults import (
    DriveTest,
    apply_known_fault,
    exchanged_drives,
    find_drive_fault,
    refuted_drives,
)
from flexarm.validation.drive_hypotheses import implausible_drives
from flexarm.validation.finding import RecordFindings, ValidationResult, merge_findings
from flexarm.validation.frames import remarks_on_frames, remarks_on_unstated_frames, unshared_frames
from flexarm.validation.gain_faults import find_channel_faults
from flexarm.validation.initial_alignment import initial_alignment, simulate_records
from flexarm.validation.mirrors import exchanged_axes
from flexarm.validation.outliers import clean_evidence
from flexarm.validation.policy import POLICY
from flexarm.validation.record_remarks import (
    drop_missing_channels,
    drop_zero_rows,
    plausibility_doubts,
    remarks_on_few_poses,
    remarks_on_poses,
    remarks_on_skipped,
    remarks_on_stamps,
)
from flexarm.validation.stuck_drives import confirmed_inputs, constant_drive, stuck_drive
from flexarm.validation.unshared import with_own_names


def check(
    arm: Arm,
    records: Mapping[str, Record] | Sequence[Record],
    *,
    step: float = 2e-3,
    alpha: float = -0.05,
    progress: Progress = None,
) -> ValidationResult:
    """Check records for faulty sensors, outliers, clock steps and contradictions.

    Parameters
    ----------
    arm : Arm
        The nominal model.
    records : dict of str to Record, or sequence of Record
        Measured data; of a sequence the names are those of the directories.
    step, alpha : float
        Of the simulation [s], [-].
    progress : bool or callable, optional
        As in `simulate`.

    Raises
    ------
    InvalidParameter
        If there are no records, the model lacks a named object, or no instant is common with the drive.

    Examples
    --------
    >>> print(check(arm, [flexarm.Record.load("measured")]))  # doctest: +SKIP
    """
    with reported(progress, "checking") as report:
        return _checked(arm, named_records(records), step, alpha, report or (lambda done: None))


def _checked(
    arm: Arm, named: dict[str, Record], step: float, alpha: float, report: Callable[[float], object]
) -> ValidationResult:
    """Return the findings; one half of the progress is the simulation, the other the judgement."""
    outliers: list[RemovedOutliers] = []
    remarks: list[str] = []
    doubts: list[str] = []
    for name, record in named.items():
        named[name], removed, notes = _prepare(arm, name, record, step)
        outliers += removed
        remarks += notes
    implausible = {
        name: implausible_drives(arm, record) or refuted_drives(arm, name, record)
        for name, record in named.items()
    }
    untimed = [name for name, record in named.items() if mismatched_durations(record)]  # doubted below
    plausible = {
        name: record for name, record in named.items() if not implausible[name] and name not in untimed
    }
    simulations, failed, empty = (
        simulate_records(arm, plausible, step, alpha, lambda done: report(done / 2))
        if plausible
        else ({}, {}, {})
    )
    failed |= {
        name: f"no joint turns as {', '.join(sorted(at))} say{'s' * (len(at) == 1)}"
        for name, at in implausible.items()
        if at
    }
    tested = partial(DriveTest, arm, step=step, alpha=alpha)
    all_findings: list[RecordFindings] = []
    seen: dict[str, list[Channel]] = {}
    remarks += [
        *remarks_on_stamps(named),
        *(f"{name}: {said}" for name, each in simulations.items() for said in moving_starts(each)),
        *remarks_on_few_poses(simulations),
    ]
    remarks += [f"{name} {why}: a diagnosis leaves it out" for name, why in empty.items()]
    remarks += remarks_on_skipped(simulations)
    for name in (each for each in named if each not in empty):
        if name in untimed:
            all_findings.append(RecordFindings(name))
            continue
        if name in simulations:
            simulated = simulations[name]
            placement = initial_alignment(simulated)
            seen[name] = channels(name, simulated, placement)
            named[name], removed = clean_evidence(name, simulated, placement, seen[name])
            outliers += removed
            if removed:
                simulated = simulate_record(
                    arm, named[name], align=False, simulation=simulated.simulation
                ).simulated
                simulations[name] = simulated
                seen[name] = channels(name, simulated, initial_alignment(simulated))
        findings = _judge(tested(name, named[name]), simulations.get(name), seen.get(name))
        disturbed = any(each.name or each.unexplained for each in findings.channels)
        doubt = exchanged_drives(arm, name, named[name]) if disturbed and findings.drive is None else None
        if doubt is not None:
            findings = RecordFindings(name)
            doubts.append(doubt)
        all_findings.append(findings)
        named[name], notes = _without_frozen(named[name], findings)
        remarks += notes
        if name in failed and findings.drive is None:
            doubts.append(f"{name}: the model cannot be simulated: {failed[name]}")
        report(0.5 + len(all_findings) / len(named) / 2)
    remarks += remarks_on_poses(named)
    faults = merge_findings(
        [_reconsider(tested(v.record, named[v.record]), v, all_findings) for v in all_findings]
    )
    if not faults:
        remarks += [*remarks_on_clocks(simulations, seen), *remarks_on_frames(simulations)]
        remarks += remarks_on_unstated_frames(simulations)
        named, told = _separated(arm, named, simulations, seen)
        remarks += told
        remarks += remarks_on_late_signals(simulations)
    sure = {
        v.record: confirmed_inputs(arm, named[v.record], v.channels) for v in all_findings if v.drive is None
    }
    compared = {name: tuple(simulated.evidence) for name, simulated in simulations.items()}
    return ValidationResult(
        named,
        faults,
        tuple(outliers),
        (*remarks, *current().remarks),
        {**compared, **dict.fromkeys(empty, ())},
        (*plausibility_doubts(arm, named, sure), *exchanged_axes(seen), *doubts),
    )


def clean_records(
    arm: Arm, records: Mapping[str, Record], *, step: float = 2e-3, alpha: float = -0.05
) -> ValidationResult:
    """Return records without outliers, their sensors taken as they are, for validation data.

    `step` [s] and `alpha` are of the simulation. Raise InvalidParameter if the model lacks an object that a
    record names, or nothing can be compared, NotConverged if the model cannot be simulated along one.
    """
    named = dict(records)
    outliers: list[RemovedOutliers] = []
    remarks: list[str] = []
    simulations: dict[str, SimulatedRecord] = {}
    seen: dict[str, list[Channel]] = {}
    for name, record in named.items():
        record, removed, notes = _prepare(arm, name, record, step)
        try:
            simulated = simulate_record(arm, record, align=False, step=step, alpha=alpha).simulated
        except InvalidParameter as error:
            raise InvalidParameter(str(error), where=name) from None
        placement = initial_alignment(simulated)
        simulations[name], seen[name] = simulated, channels(name, simulated, placement)
        named[name], more = clean_evidence(name, simulated, placement, seen[name])
        outliers += [*removed, *more]
        remarks += notes
    named, told = _separated(arm, named, simulations, seen)
    return ValidationResult(named, (), tuple(outliers), (*remarks, *told))


def _separated(
    arm: Arm,
    named: Mapping[str, Record],
    simulations: Mapping[str, SimulatedRecord],
    seen: Mapping[str, list[Channel]],
) -> tuple[dict[str, Record], list[str]]:
    """Return the records with names of their own for what they do not share, and remarks."""
    return with_own_names(arm, named, [*unshared_frames(simulations), *unshared_clocks(simulations, seen)])


def named_records(records: Mapping[str, Record] | Sequence[Record]) -> dict[str, Record]:
    """Return records by name: the keys, or the names of their directories.

    Raise InvalidParameter if there are none, or something else is among them.
    """
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
            what = f"must be a Record, such as Record.load gives, got {type(record).__name__}"
            raise InvalidParameter(what, where=f"records.{name}")
        if record.kind == "frequency_response":
            raise InvalidParameter(
                "is a frequency response, which `compare` puts beside the linear model; records of kind "
                '"motion" and "static" can be judged and fitted',
                where=f"{name}.kind",
            )
    return named


def _prepare(
    arm: Arm, name: str, record: Record, step: float
) -> tuple[Record, list[RemovedOutliers], list[str]]:
    """Return a record without missing channels and outliers of its drives, these, and remarks.

    Raise InvalidParameter if the model lacks a named object, no instant is common with the drive, or a
    simulation would not end.
    """
    record.check_against(arm)
    for problem in (*disjoint_clocks(record), *endless(record, step)):
        raise InvalidParameter(problem.what, where=f"records.{name}.{problem.where}")
    record, notes = drop_missing_channels(name, record.with_units_of(arm))
    record, lost = drop_zero_rows(name, record)
    record, removed = clean_drives(name, record)
    record, smoothed = with_drive_noise(record)
    return record, removed, [*notes, *lost, *(f"{name}: {remark}" for remark in smoothed)]


def _judge(test: DriveTest, simulated: SimulatedRecord | None, seen: list[Channel] | None) -> RecordFindings:
    """Judge one record: its channels as recorded, or with a drive's fault if that explains more."""
    arm, name, record = test.arm, test.name, test.record
    if simulated is None:
        return RecordFindings(name, (), find_drive_fault(test))
    found = find_channel_faults(name, simulated, seen)
    if (stuck := stuck_drive(arm, record, found)) is not None:
        return RecordFindings(name, (), stuck)
    if not any(each.name or each.unexplained for each in found):
        return RecordFindings(name, found)
    drive = find_drive_fault(replace(test, channels=found))
    if drive is None:
        constant = constant_drive(arm, record, found)
        return RecordFindings(name, found if constant is None else (), constant)
    if drive.log_bayes > POLICY.clear_log_odds:
        return RecordFindings(name, drive.channels, drive)
    return RecordFindings(name, found, drive, ambiguous=True)  # both explain the record alike


def _reconsider(
    test: DriveTest, findings: RecordFindings, all_of_them: Sequence[RecordFindings]
) -> RecordFindings:
    """Replace faults of channels by a fault of their drive that another record shows clearly."""
    sure = [v.drive for v in all_of_them if v.drive is not None and v.drive.channels and not v.ambiguous]
    if findings.drive is not None or not any(each.name for each in findings.channels):
        return findings
    for fault in sure:
        found = apply_known_fault(replace(test, channels=findings.channels), fault)
        if found is not None:
            return RecordFindings(test.name, found.channels, found)
    return findings


def _without_frozen(record: Record, findings: RecordFindings) -> tuple[Record, list[str]]:
    """Return the record without frozen rows, and remarks on channels that are no faults."""
    notes = []
    for each in findings.channels:
        if each.frozen_rows:
            record = blank_rows(record, each.channel.signal.name, each.frozen_rows)
            notes.append(f"{findings.record}: {each.sentence}; these rows are removed")
        elif each.sentence and not each.name:
            notes.append(f"{findings.record}: {each.sentence}")
    return record, notes
