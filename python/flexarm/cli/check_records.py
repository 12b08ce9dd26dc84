"""`flexarm check MODEL RECORD...`: could the sensors of a record be what they say, beside this model?"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.cli.options import load_arm
from flexarm.cli.progress import progress
from flexarm.cli.records import blame_one_of, load_record, record_names
from flexarm.errors import Problem

if TYPE_CHECKING:
    from flexarm.validation.finding import ValidationResult


Faults = list[tuple[Path, Problem]]


def check_records(
    model: Path, paths: list[Path], max_seconds: float | None = None, json: bool = False
) -> tuple[dict[str, Any], list[str], Faults]:
    """Return the findings of the sensor check as a dictionary, as lines, and the faults.

    Raise InvalidFile if model or records cannot be read, or do not belong together.
    """
    arm = load_arm(model)
    files = record_names(paths)
    records = {name: load_record(path, arm) for name, path in files.items()}
    next_step = f"how far they are from the model: flexarm compare {model} {paths[0]}"
    responses = [name for name, record in records.items() if record.kind == "frequency_response"]
    judged = {name: record for name, record in records.items() if name not in responses}
    said = [f"frequency responses, of which no sensor is judged: {', '.join(responses)}"] if responses else []
    if not judged:
        return {"kind": "records", "records": responses, "usable": True, "faults": []}, [*said, next_step], []
    from flexarm.budget import limited
    from flexarm.validation.sensor_check import check

    with blame_one_of(model, files, judged, arm), progress(json) as tell, limited(max_seconds):
        found = check(arm, judged, progress=lambda done: tell(done, "checking"))
    ready = found.usable and found.judged
    return _told(found), [found.summary(), *said, *([next_step] if ready else [])], _faults(found, files)


def _faults(found: ValidationResult, files: dict[str, Path]) -> Faults:
    """Each sensor at fault, with every record that shows it."""
    return [
        (files[name], Problem(f"signals.{fault.at}", f"{fault.name}: {fault.evidence}"))
        for fault in found.faults
        for name in fault.records
    ]


def _told(found: ValidationResult) -> dict[str, Any]:
    keys = ("name", "at", "channels", "records", "probability")
    return {
        "kind": "records",
        "records": list(found.records),
        "usable": found.usable,
        "faults": [
            {
                **{key: getattr(fault, key) for key in keys},
                "parameters": [{"name": p.name, "value": p.value, "unit": p.unit} for p in fault.parameters],
                "evidence": fault.evidence,
            }
            for fault in found.faults
        ],
        "outliers": [
            {"record": each.record, "signal": each.signal, "rows": list(each.rows), "size": each.size}
            for each in found.outliers
        ],
        "remarks": list(found.remarks),
        "doubts": list(found.doubts),
    }
