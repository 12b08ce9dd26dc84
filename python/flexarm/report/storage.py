"""A diagnosis as files that are read again: report.json, updated.toml, and gaps.nc with gaps and model.

`gaps.nc` holds the nominal model and, by number k, the gap of each signal that is evidence in each record, of
the nominal and of the updated model: `gap_k` (rows, directions) in the signal's unit at `time_k` [s], or at
numbers of poses; attributes say whose they are. The gap sample by sample against the states of the joints
(`Diagnosis.located`) is not kept: pictures against states are those that were drawn.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel, TypeAdapter

from flexarm.arm import Arm
from flexarm.arm.parameter import parameters
from flexarm.comparison.align import Alignment
from flexarm.comparison.alignment_parameters import AlignmentParameter
from flexarm.comparison.bands import Band
from flexarm.comparison.comparison import Comparison
from flexarm.comparison.gap import SignalGap
from flexarm.comparison.simulated_record import Placement
from flexarm.configuration import version
from flexarm.errors import InvalidFile
from flexarm.fit_statistics import FitStatistics
from flexarm.law_curve import LawCurve
from flexarm.named_effects import NamedEffect, Nuisance, Refined, Rejected, Stage
from flexarm.netcdf import Contents, Variable
from flexarm.reading import reading
from flexarm.report.report_file import ReportFile
from flexarm.result import load, model_of
from flexarm.tables import toml_text
from flexarm.tables.toml import read_text

if TYPE_CHECKING:
    import xarray as xr

    from flexarm.report.gap_figures import BeforeAfter


REPORT, MODEL, GAPS = "report.json", "updated.toml", "gaps.nc"
"""Names of the files."""
KIND = "diagnosis"
Entry = Mapping[str, Any]


# ---------------------------------------------------------------------- writing


def gap_contents(diagnosis: BeforeAfter, kind: str = KIND) -> Contents:
    """Return what `gaps.nc` of a kind of result holds."""
    variables: dict[str, Variable] = {}
    labels: dict[str, list[str]] = {}
    told: list[dict[str, Any]] = []
    for side in ("before", "after"):
        for record, comparison in getattr(diagnosis, side).items():
            told.append({"side": side, "record": record, **_comparison_facts(comparison)})
            for gap in comparison.evidence.values():
                k = len(variables) // 2
                labels[f"direction_{k}"] = [name for name, part in gap.parts.items() if part is not None]
                facts = {
                    **{key: getattr(gap, key) for key in _GAP_KEYS},
                    "directions": list(gap.parts),
                    "bands": [[band.low, band.high, band.rms] for band in gap.bands],
                    "gross": list(gap.gross),
                    "poses": list(gap.poses),
                }
                about = {"units": gap.unit, "side": side, "record": record, "facts": json.dumps(facts)}
                parts = [gap.parts[name] for name in labels[f"direction_{k}"]]
                values = np.stack(parts, axis=1) if parts else np.empty((len(gap.time), 0))
                variables[f"time_{k}"] = ((f"row_{k}",), gap.time, {})
                variables[f"gap_{k}"] = ((f"row_{k}", f"direction_{k}"), values, about)
    attributes = {
        "kind": kind,
        "flexarm_version": version(),
        "model": toml_text(diagnosis.arm.to_dict()),
        "comparisons": json.dumps(told),
    }
    return Contents(variables, labels, attributes)


def _comparison_facts(comparison: Comparison) -> dict[str, Any]:
    """Return the contents of a comparison besides its gaps; clocks and frames as they were aligned."""
    aligned = comparison.aligned
    return {
        "arm": comparison.arm,
        "description": comparison.record,
        "skipped": dict(comparison.skipped),
        "modes_hz": list(comparison.modes_hz),
        "notes": list(comparison.notes),
        "unknowns": [[u.place, u.kind, u.axis, u.centre, u.sigma, u.step] for u in aligned.parameters],
        "values": [float(value) for value in aligned.values],
        "std": [float(value) for value in aligned.std],
        "frames": comparison.frames,
    }


_GAP_KEYS = ("name", "quantity", "rms", "max", "noise_rms", "removed")


# ---------------------------------------------------------------------- reading


def stored(path: str | Path) -> dict[str, Any]:
    """Return the attributes of the diagnosis in a directory, which may be given by its report.json.

    Raise InvalidFile if a file is missing, or is not what a diagnosis wrote.
    """
    told, common = stored_parts(path, KIND, REPORT, ReportFile)
    details = told["details"]
    return {
        **common,
        "verdict": told["verdict"],
        "effects": tuple_of(NamedEffect, told["effects"]),
        "nuisances": tuple_of(Nuisance, told["nuisances"]),
        "refined": tuple(_refined(common["updated"], common["before"], entry) for entry in told["refined"]),
        "rejected": tuple_of(Rejected, told["provenance"]["rejected"], -math.inf),
        "where": tuple(told["where"]),
        "hold_out_why": details["hold_out_why"],
        "stages": tuple_of(Stage, details["stages"]),
        "constancy": tuple(details["constancy"]),
        "remainder": details["remainder"],
        "next_experiment": told["next_experiment"],
        "statistics": TypeAdapter(FitStatistics).validate_python(details["statistics"]),
        "laws": tuple_of(LawCurve, [{**law, **law.pop("gap")} for law in told["laws"]], None),
        "provenance": {key: value for key, value in told["provenance"].items() if key != "rejected"},
    }


def stored_parts(
    path: str | Path, kind: str, name: str, form: type[BaseModel]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the object of a result's JSON file, and the attributes that results of every kind have.

    The directory may be given by its JSON file.

    Raise InvalidFile if a file is missing, or is not what such a result wrote.
    """
    given = Path(path)
    file = given if given.suffix == ".json" else given / name
    text = read_text(file)
    try:
        told = form.model_validate(json.loads(text)).model_dump()
    except (ValueError, RecursionError) as error:  # no JSON, or another format
        what = str(error).splitlines()[0]
        raise InvalidFile(file, "file", f"is no report of a {kind} ({what})") from None
    gaps, details = file.parent / GAPS, told["details"]
    dataset = load(gaps, kind)
    with reading(gaps, f"gaps of a {kind}"):
        arm, comparisons = model_of(dataset, gaps), _comparisons(dataset)
    return told, {
        "arm": arm,
        "updated": Arm.from_toml(file.parent / MODEL),
        **comparisons,
        "training": tuple(details["training"]),
        "held_out": tuple(details["held_out"]),
        "hold_out_kind": details["hold_out_kind"],
        "main_signal": told["gap"]["signal"],
        "remarks": tuple(details["remarks"]),
    }


def tuple_of(kind: type[Any], entries: Any, unknown: float | None = math.nan) -> tuple[Any, ...]:
    """Return entries as data classes, nested ones too; `unknown` in place of each null."""
    return TypeAdapter(tuple[kind, ...]).validate_python(_filled(entries, unknown))  # type: ignore[valid-type]


def _filled(value: Any, unknown: float | None) -> Any:
    if isinstance(value, dict):
        return {key: _filled(item, unknown) for key, item in value.items()}
    if isinstance(value, list):
        return [_filled(item, unknown) for item in value]
    return unknown if value is None else value


def _refined(updated: Arm, before: Mapping[str, Comparison], entry: Entry) -> Refined:
    """Return a refined value; the zero of a sensor is in the unit of its signal."""
    [parameter] = parameters(updated, [entry["parameter"]])
    std = math.nan if entry["std"] is None else entry["std"]
    unit, signal = parameter.unit, parameter.key.split(".")[2]
    if unit == "SI":
        unit = next((each.signals[signal].unit for each in before.values() if signal in each.signals), unit)
    return Refined(parameter.key, entry["value"], std, entry["nominal"], unit)


def _comparisons(dataset: xr.Dataset) -> dict[str, dict[str, Comparison]]:
    """Before and after, by record."""
    signals: dict[tuple[str, str], dict[str, SignalGap]] = {}
    for side, record, gap in _gaps(dataset):
        signals.setdefault((side, record), {})[gap.name] = gap
    found: dict[str, dict[str, Comparison]] = {"before": {}, "after": {}}
    for told in json.loads(dataset.attrs["comparisons"]):
        aligned = Alignment(
            Placement(),
            tuple(AlignmentParameter(*each) for each in told["unknowns"]),
            tuple(told["values"]),
            tuple(told["std"]),
        )
        found[told["side"]][told["record"]] = Comparison(
            told["arm"],
            told["description"],
            signals.get((told["side"], told["record"]), {}),
            aligned,
            told["skipped"],
            tuple(told["modes_hz"]),
            tuple(told["notes"]),
            {name: (xyz, rpy) for name, (xyz, rpy) in told.get("frames", {}).items()},
        )
    return found


def _gaps(dataset: xr.Dataset) -> Iterator[tuple[str, str, SignalGap]]:
    """Side, record and gap of each signal."""
    for k in range(sum(str(name).startswith("gap_") for name in dataset)):
        values = dataset[f"gap_{k}"]
        told = json.loads(values.attrs["facts"])
        there = dict(zip(map(str, dataset[f"direction_{k}"].values), values.values.T, strict=True))
        yield (
            values.attrs["side"],
            values.attrs["record"],
            SignalGap(
                **{key: told[key] for key in _GAP_KEYS},
                unit=values.attrs["units"],
                time=dataset[f"time_{k}"].values,
                parts={name: there.get(name) for name in told["directions"]},
                bands=tuple(Band(*each) for each in told["bands"]),
                gross=tuple(told["gross"]),
                poses=tuple(told.get("poses", ())),
            ),
        )
