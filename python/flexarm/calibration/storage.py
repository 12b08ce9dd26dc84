"""A calibration read again from its files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from flexarm.arm import Arm
from flexarm.calibration.estimates import (
    CalibratedFamily,
    CalibratedFrame,
    CalibratedParameter,
    ChiSquare,
    Range,
    matrix,
)
from flexarm.errors import InvalidFile
from flexarm.report.calibration import KIND, REPORT
from flexarm.report.calibration_file import CalibrationFile
from flexarm.report.storage import GAPS, MODEL, stored_gaps
from flexarm.tables.toml import read_text


def stored(path: str | Path) -> dict[str, Any]:
    """Return the attributes of the calibration in a directory, which may be given by its calibration.json.

    Raises
    ------
    InvalidFile
        If a file is missing, or is not what a calibration wrote.
    """
    given = Path(path)
    directory = given.parent if given.suffix == ".json" else given
    told = _told(given if given.suffix == ".json" else directory / REPORT)
    arm, comparisons = stored_gaps(directory / GAPS, KIND)
    details = told["details"]
    return {
        "arm": arm,
        "updated": Arm.from_toml(directory / MODEL),
        "parameters": tuple(
            CalibratedParameter(**{**each, "prior": Range(**each["prior"])}) for each in told["parameters"]
        ),
        "correlations": matrix(told["correlations"]["matrix"]),
        "families": tuple(_family(each) for each in told["families"]),
        "frames": tuple(
            CalibratedFrame(each["name"], tuple(each["xyz"]), tuple(each["rpy"])) for each in told["frames"]
        ),
        "chi_square": ChiSquare(**{k: v for k, v in told["chi_square"].items() if k != "reduced"}),
        **comparisons,
        "training": tuple(details["training"]),
        "held_out": tuple(details["held_out"]),
        "hold_out_kind": details["hold_out_kind"],
        "main_signal": told["gap"]["signal"],
        "remarks": tuple(details["remarks"]),
        "provenance": told["provenance"],
    }


def _told(path: Path) -> dict[str, Any]:
    text = read_text(path)
    try:
        return CalibrationFile.model_validate(json.loads(text)).model_dump()
    except (ValueError, RecursionError) as error:  # no JSON, or another format
        what = str(error).splitlines()[0]
        raise InvalidFile(path, "file", f"is no report of a calibration ({what})") from None


def _family(told: dict[str, Any]) -> CalibratedFamily:
    shared = None if told["shared"] is None else Range(**told["shared"])
    return CalibratedFamily(**{**told, "at": tuple(told["at"]), "shared": shared})
