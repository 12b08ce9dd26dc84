"""A calibration read again from its files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from flexarm.arm import Arm
from flexarm.calibration.estimates import (
    CalibratedFamily,
    CalibratedFrame,
    CalibratedParameter,
    ChiSquare,
    matrix,
)
from flexarm.report.calibration import KIND, REPORT, CalibrationFile
from flexarm.report.storage import GAPS, MODEL, stored_gaps, stored_object, tuple_of


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
        "parameters": tuple_of(CalibratedParameter, told["parameters"], None),
        "correlations": matrix(told["correlations"]["matrix"]),
        "families": tuple_of(CalibratedFamily, told["families"], None),
        "frames": tuple_of(CalibratedFrame, told["frames"], None),
        "chi_square": ChiSquare(**{k: v for k, v in told["chi_square"].items() if k != "reduced"}),
        **comparisons,
        "training": tuple(details["training"]),
        "held_out": tuple(details["held_out"]),
        "hold_out_kind": details["hold_out_kind"],
        "main_signal": told["gap"]["signal"],
        "remarks": tuple(details["remarks"]),
        "provenance": told["provenance"],
    }
