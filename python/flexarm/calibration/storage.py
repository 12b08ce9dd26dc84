"""A calibration read again from its files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from flexarm.arm import Arm
from flexarm.calibration.estimates import (
    CalibratedFamily,
    CalibratedFrame,
    CalibratedParameter,
    ChiSquare,
    matrix,
)
from flexarm.report.calibration import KIND, REPORT
from flexarm.report.calibration_file import CalibrationFile
from flexarm.report.storage import GAPS, MODEL, stored_gaps, stored_object


def stored(path: str | Path) -> dict[str, Any]:
    """Return the attributes of the calibration in a directory, which may be given by its calibration.json.

    Raise InvalidFile if a file is missing, or is not what a calibration wrote.
    """
    directory, told = stored_object(path, KIND, REPORT, CalibrationFile)
    arm, comparisons = stored_gaps(directory / GAPS, KIND)
    details = told["details"]
    return {
        "arm": arm,
        "updated": Arm.from_toml(directory / MODEL),
        "parameters": _tuple_of(CalibratedParameter, told["parameters"]),
        "correlations": matrix(told["correlations"]["matrix"]),
        "families": _tuple_of(CalibratedFamily, told["families"]),
        "frames": _tuple_of(CalibratedFrame, told["frames"]),
        "chi_square": ChiSquare(**{k: v for k, v in told["chi_square"].items() if k != "reduced"}),
        **comparisons,
        "training": tuple(details["training"]),
        "held_out": tuple(details["held_out"]),
        "hold_out_kind": details["hold_out_kind"],
        "main_signal": told["gap"]["signal"],
        "remarks": tuple(details["remarks"]),
        "provenance": told["provenance"],
    }


def _tuple_of(kind: type[Any], entries: list[dict[str, Any]]) -> tuple[Any, ...]:
    """Return entries as data classes, nested ones too."""
    return TypeAdapter(tuple[kind, ...]).validate_python(entries)  # type: ignore[valid-type]
