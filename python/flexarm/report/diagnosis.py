"""The directory of a diagnosis: report.json for programs, report.html for a person, the repaired model."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from flexarm.diagnosis.outcome.stored import GAPS, MODEL, REPORT, gap_contents
from flexarm.netcdf import save
from flexarm.report.diagnosis_drawings import drawings
from flexarm.report.diagnosis_page import page
from flexarm.report.files import write_files
from flexarm.report.updated_model import write_updated

if TYPE_CHECKING:
    from flexarm.diagnosis.outcome.result import Diagnosis

PAGE = "report.html"
"""The page, beside the files that `Diagnosis.load` reads and the figures."""


def write(diagnosis: Diagnosis, directory: Path) -> None:
    """Writes report.json, report.html, updated.toml, gaps.nc and the figures into a directory that is there.

    Parameters
    ----------
    diagnosis : Diagnosis
        What was found.
    directory : Path
        See `flexarm.output.output_directory` for one that is whole or not there.
    """
    report = diagnosis.to_json_dict()
    drawn = drawings(diagnosis)
    write_files(directory, drawn, (PAGE, page(diagnosis, drawn, report)), (REPORT, report))
    write_updated(diagnosis, directory / MODEL)
    save(gap_contents(diagnosis), directory / GAPS)
