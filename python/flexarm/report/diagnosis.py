"""The directory of a diagnosis: report.json for programs, report.html for a person, the repaired model."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from flexarm.report.diagnosis_drawings import drawings
from flexarm.report.diagnosis_page import page
from flexarm.report.updated_model import write_updated

if TYPE_CHECKING:
    from flexarm.diagnosis.result import Diagnosis

REPORT, PAGE, MODEL = "report.json", "report.html", "updated.toml"
"""Names of the files beside the figures."""


def write(diagnosis: Diagnosis, directory: Path) -> None:
    """Writes report.json, report.html, updated.toml and the figures into a directory that is there.

    Parameters
    ----------
    diagnosis : Diagnosis
        What was found.
    directory : Path
        See `flexarm.output.output_directory` for one that is whole or not there.
    """
    report = diagnosis.to_json_dict()
    drawn = drawings(diagnosis)
    for drawing in drawn:
        (directory / f"{drawing.name}.png").write_bytes(drawing.png)
    (directory / PAGE).write_text(page(diagnosis, drawn, report), encoding="utf-8")
    text = json.dumps(report, indent=2, allow_nan=False)
    (directory / REPORT).write_text(text + "\n", encoding="utf-8")
    write_updated(diagnosis, directory / MODEL)
