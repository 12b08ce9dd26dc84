"""Records split into those that are fitted and those that are held out to check what was fitted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm import Arm
from flexarm.diagnosis.hold_out import hold_back, hold_out_kind, hold_out_why
from flexarm.diagnosis.masked_outliers import left_out, strays, strays_told
from flexarm.diagnosis.problem import Problem
from flexarm.errors import InvalidParameter
from flexarm.validation.finding import ValidationResult
from flexarm.validation.sensor_check import named_records

if TYPE_CHECKING:
    from flexarm.record import Record


@dataclass(frozen=True)
class Split:
    """Records to fit, those to check the repair with, how these were held out and why so, and remarks."""

    training: dict[str, Record]
    held_out: dict[str, Record]
    kind: str
    why: str
    remarks: tuple[str, ...]

    def without_strays(self, model: Arm, like: Problem) -> Split:
        """Return what is held out loses its outliers too, beside the model that explains the rest."""
        motions = {name: record for name, record in self.held_out.items() if record.kind == "motion"}
        if not motions:
            return self
        held = Problem(model, motions, step=like.step, alpha=like.alpha, jobs=like.jobs)
        out = strays(held.residual(model), held)
        told = (*self.remarks, *strays_told(out, held))
        return replace(self, held_out=left_out(self.held_out, out, held), remarks=told)


def named_hold_out(arm: Arm, hold_out: Record | None, given: Mapping[str, Record]) -> dict[str, Record]:
    """Return a record of its own to check the repair with, by name, if there is one; it must fit the
    model.
    """
    if hold_out is None:
        return {}
    [record] = named_records({"hold_out": hold_out}).values()
    record.check_against(arm)
    for name, training in given.items():
        if _same_values(record, training):
            raise InvalidParameter(
                f"holds the same values as {name!r}, which is fitted: nothing would be held out",
                where="hold_out",
            )
    return {_name(record, given): record}


def _same_values(one: Record, other: Record) -> bool:
    """Return True if two records show the same, under whatever names and places they are kept."""
    return set(one.signals) == set(other.signals) and all(
        np.array_equal(signal.values, other.signals[name].values, equal_nan=True)
        for name, signal in one.signals.items()
    )


def split(arm: Arm, checked: ValidationResult, held_out: ValidationResult) -> Split:
    """Training and check: a record of its own, or else blocks of time of each."""
    named = checked.comparable()
    remarks = (*map(str, held_out.outliers), *held_out.remarks)
    for record in held_out.records.values():
        kind, why = hold_out_kind(arm, named, record), hold_out_why(arm, named, record)
        return Split(named, dict(held_out.records), kind, why, remarks)
    parts = {name: hold_back(record, checked.compared.get(name)) for name, record in named.items()}
    whole = [name for name, (_, back) in parts.items() if back is None]
    return Split(
        {name: fitted for name, (fitted, _) in parts.items()},
        {f"{name}, held-back blocks": back for name, (_, back) in parts.items() if back is not None},
        "blocks",
        "",
        tuple(f"{name} is too short to hold a part of it back" for name in whole),
    )


def _name(record: Record, taken: Mapping[str, Record]) -> str:
    """Of the held-out record: its directory's, with as many parents as names of the training have."""
    parents = max(each.count("/") for each in taken)
    parts = ("held_out",) if record.path is None else record.path.resolve().parts[-1 - parents :]
    name = "/".join(parts)
    return name if name not in taken else f"{name} (held out)"
