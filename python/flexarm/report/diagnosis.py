"""The directory of a diagnosis: report.json for programs, report.html for a person, the repaired model.

Which figures a diagnosis gets, and what stands below each; drawn once for its file and the page.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from flexarm.netcdf import save
from flexarm.output import PAGE, stems
from flexarm.report.diagnosis_page import page
from flexarm.report.evidence_figures import candidates, constancy, of_effect
from flexarm.report.files import Drawing, drawn, write_files
from flexarm.report.gap_curves import sides
from flexarm.report.gap_figures import by_band, gap_along, waterfall
from flexarm.report.law_figures import laws
from flexarm.report.state_figures import against_states, main_direction, rotations, shown_joints, states_drawn
from flexarm.report.storage import GAPS, MODEL, REPORT, gap_contents
from flexarm.report.updated_model import write_updated
from flexarm.wording import listed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexarm.diagnosis.result import Diagnosis


def write(diagnosis: Diagnosis, directory: Path, model: Path | None = None) -> None:
    """Write report.json, report.html, updated.toml, gaps.nc and the figures into a directory that is there.

    Parameters
    ----------
    diagnosis : Diagnosis
        What was found.
    directory : Path
        See `flexarm.output.output_directory` for one that is whole or not there.
    model : Path, optional
        File of the nominal model: updated.toml keeps its comments.
    """
    report = diagnosis.to_json_dict()
    drawn = drawings(diagnosis)
    write_files(directory, drawn, (PAGE, page(diagnosis, drawn, report)), (REPORT, report))
    write_updated(diagnosis, directory / MODEL, model)
    save(gap_contents(diagnosis), directory / GAPS)


def drawings(d: Diagnosis) -> list[Drawing]:
    """All figures of a diagnosis, in the order of the page."""
    return drawn(_figures(d))


def _figures(d: Diagnosis) -> Iterator[tuple[str, str, str, Figure | None]]:
    if d.has_gap:
        yield from _of_gap(d)
    yield (
        "laws",
        "laws",
        "What is missing: the curve with its 90 % band, and the latent motion that no curve was assumed for "
        "(dots), of the most probable place and the next one.",
        laws(d),
    )
    yield (
        "candidates",
        "candidates",
        "What was tried. The evidence that a candidate lacks against what was chosen (blue, 0); light blue: "
        "the data cannot tell it apart; grey: out of reach, right of the dashed line.",
        candidates(d),
    )
    yield (
        "constancy",
        "constancy",
        "Each parameter fitted to one record alone (bars: 90 %), beside the value of all records together "
        "(line; band: 90 %). A right name's parameter stays where it is.",
        constancy(d, d.constancy),
    )
    for effect in d.effects:
        for file in d.figures_of(effect):
            yield file.removesuffix(".png"), "effects", "", of_effect(d, effect)


def _of_gap(d: Diagnosis) -> Iterator[tuple[str, str, str, Figure | None]]:
    records = [*d.training[:2], *d.held_out[:1]]
    yield (
        "states",
        "where",
        _of_states(d),
        against_states(d),
    )
    yield (
        "rotations",
        "where",
        "The gap of all positions as small rotations of the joints, of the nominal model, each against its "
        "own states: the joint where the cause sits, if it sits in one.",
        rotations(d),
    )
    yield (
        "bands",
        "where",
        f"The gap of {d.main_signal} by band of frequencies: quasi-static, around the first mode, above.",
        by_band(d, records),
    )
    yield (
        "stages",
        "shrinks",
        f"From the nominal to the updated model: rms gap of {d.main_signal}, all directions, at each step.",
        waterfall(d),
    )
    shown = [name for name in (*d.held_out, *d.training) if sides(d, name)]
    for record, stem in zip(shown, stems(shown), strict=True):
        role = "held out, never used to fit" if record in d.held_out else "training"
        yield (
            f"gap-{stem}",
            "shrinks",
            f"Record {record} ({role}): gap of {d.main_signal} before and after, and the noise.",
            gap_along(d, record),
        )


def _of_states(d: Diagnosis) -> str:
    """Return what stands below the gap against the states of the joints."""
    shown = shown_joints(d)
    joints, states = [each.joint for each in shown], listed(states_drawn(shown))
    if not joints:
        return ""
    whose = f"of {joints[0]}" if len(joints) == 1 else f"of {listed(joints)}, a row each"
    return (
        f"The gap of {d.main_signal}, {main_direction(d)} (where it is greatest), in all of the training, "
        f"against {states} {whose}. A curve over the torque is a spring, two branches by sense "
        "of motion are friction, a wave over the angle is a gear or an encoder."
    )
