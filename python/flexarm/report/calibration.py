"""The directory of a calibration: calibration.json, report.html, updated.toml, gaps.nc and the figures."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from flexarm.netcdf import save
from flexarm.output import PAGE, stems, write_file
from flexarm.report.calibration_figures import correlations, members
from flexarm.report.calibration_summary import family_sentence, fit_sentence, headline, pair_sentence, row
from flexarm.report.files import Drawing, drawn, write_files
from flexarm.report.gap_curves import sides
from flexarm.report.gap_figures import gap_along
from flexarm.report.gap_tables import gap_tables
from flexarm.report.report_file import provenance_of
from flexarm.report.storage import GAPS, MODEL, gap_contents
from flexarm.report.template import filled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexarm.calibration.result import Calibration

REPORT, KIND = "calibration.json", "calibration"


def write(found: Calibration, directory: Path, model: Path | None = None) -> None:
    """Write the files into a directory that is there.

    Parameters
    ----------
    found : Calibration
        What was estimated.
    directory : Path
        See `flexarm.output.output_directory` for one that is whole or not there.
    model : Path, optional
        File of the nominal model: updated.toml keeps its comments.
    """
    drawings = drawn(_figures(found))
    write_files(directory, drawings, (PAGE, page(found, drawings)), (REPORT, found.to_json_dict()))
    path = directory / MODEL
    head = f"# Made by flexarm calibrate from {', '.join(found.training)}: {fit_sentence(found)}\n\n"
    write_file(path, head + found.updated.toml_for(directory, model))
    save(gap_contents(found, KIND), directory / GAPS)


def page(found: Calibration, drawings: list[Drawing]) -> str:
    """Return the page as HTML."""
    return filled(
        "calibration.html.j2",
        c=found,
        headline=headline(found),
        fit=fit_sentence(found),
        families=[family_sentence(family) for family in found.families],
        gaps=gap_tables(found),
        known=[row(each) for each in found.parameters if each.determined],
        unknown=[row(each) for each in found.parameters if not each.determined],
        pairs=[pair_sentence(pair) for pair in found.confounded],
        drawn=drawings,
        provenance=provenance_of(found.provenance),
    )


def _figures(found: Calibration) -> Iterator[tuple[str, str, str, Figure | None]]:
    for name, figure in members(found):
        yield (
            name,
            "families",
            "Members with 90 % intervals; the line is the shared size, the band its 90 % interval. Grey: the "
            "data hardly know the member, which stays near the others.",
            figure,
        )
    shown = [name for name in (*found.held_out, *found.training) if sides(found, name)]
    for record, stem in zip(shown, stems(shown), strict=True):
        role = "held out, never used to fit" if record in found.held_out else "training"
        yield (
            f"gap-{stem}",
            "gap",
            f"Record {record} ({role}): gap of {found.main_signal} before and after, and the noise.",
            gap_along(found, record),
        )
    yield (
        "correlations",
        "correlations",
        "Correlations of the parameters that the data determine, in the order of the table.",
        correlations(found),
    )
