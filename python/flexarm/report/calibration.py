"""A calibration as a directory (JSON, page, updated.toml, gaps.nc, figures) and as text in a terminal.

Programs read `calibration.json`, format `flexarm-calibration/1`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from math import exp
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from pydantic import model_validator

from flexarm.calibration_estimates import CalibratedFamily, CalibratedFrame, CalibratedParameter
from flexarm.comparison.comparison import frame_words
from flexarm.json_values import plain
from flexarm.named_effects import Estimate
from flexarm.netcdf import save
from flexarm.output import PAGE, stems, write_file
from flexarm.report.diagnosis import gap_lines
from flexarm.report.files import (
    WIDTH,
    Drawing,
    drawn,
    filled,
    log_if_wide,
    margin_for,
    sheet,
    text_of,
    write_files,
)
from flexarm.report.gap_figures import AFTER, gaps_along
from flexarm.report.report_file import Entry, GapsEntry, gaps_of, provenance_of
from flexarm.report.sentences import gap_tables
from flexarm.report.storage import GAPS, MODEL, gap_contents
from flexarm.wording import effect_words, interval, labelled_scale, number, with_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexarm.calibration.result import Calibration


REPORT, KIND = "calibration.json", "calibration"


def write(found: Calibration, directory: Path, model: Path | None = None) -> None:
    """Write the files into a directory that is there; updated.toml keeps the comments of the model file."""
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
        one_sided=[one_sided_words(each) for each in found.parameters if each.one_sided],
        one_sided_title=ONE_SIDED,
        unknown=[row(each) for each in found.parameters if not (each.determined or each.one_sided)],
        pairs=[pair_sentence(pair) for pair in found.confounded],
        drawn=drawings,
        provenance=provenance_of(found.provenance),
    )


def _figures(found: Calibration) -> Iterator[tuple[str, str, str, Figure | None]]:
    what = (
        "Members with 90 % intervals; the line is the shared size, the band its 90 % interval. Grey: the "
        "data hardly know the member, which stays near the others."
    )
    names = stems([f"{family.effect}-{family.parameter}" for family in found.families])
    for name, family in zip(names, found.families, strict=True):
        yield name, "families", what, members(found, family)
    yield from gaps_along(found, "gap")
    what = "Correlations of the parameters that the data determine, in the order of the table."
    yield "correlations", "correlations", what, correlations(found)


UNKNOWN = "#999999"


def members(found: Calibration, family: CalibratedFamily) -> Figure:
    """Return the members of a family with 90 % intervals."""
    keys = [f"effects.{family.effect}.{at}.{family.parameter}" for at in family.at]
    estimates = [found.parameter(key) for key in keys]
    factor, unit = labelled_scale([each.value for each in estimates], family.unit)
    figure, axes = sheet(1, 1, 0.2 * len(keys) + 0.2, left=margin_for(family.at), legend=False)
    ax = axes[0, 0]
    if family.shared is not None:
        ax.axvspan(factor * family.shared.low90, factor * family.shared.high90, color=AFTER, alpha=0.2, lw=0)
        ax.axvline(factor * family.shared.value, color=AFTER, lw=0.8)
    for k, each in enumerate(estimates):
        colour = AFTER if each.determined else UNKNOWN
        # The most probable value of a skewed posterior may lie outside the interval.
        ax.plot([factor * each.low90, factor * each.high90], [k, k], "|-", ms=6, color=colour)
        ax.plot([factor * each.value], [k], "o", ms=4, color=colour)
    ax.set(yticks=range(len(keys)), yticklabels=list(family.at), ylim=(len(keys) - 0.5, -0.5))
    ax.set_xlabel(f"{family.parameter} [{unit}]")
    ax.set_title(effect_words(family.effect))
    if family.shared is not None:
        log_if_wide(ax, "x", [factor * end for each in estimates for end in (each.low90, each.high90)])
    return figure


def correlations(found: Calibration) -> Figure | None:
    """Return the matrix of determined parameters; None of less than two."""
    known = [k for k, each in enumerate(found.parameters) if each.determined]
    if len(known) < 2:
        return None
    names = [found.parameters[k].name for k in known]
    few = len(names) <= 30
    taken = 0.85  # of the sheet's width; the rest is for the scale of colours
    left = margin_for(names, 6.0) if few else 0.4
    size = taken * (WIDTH - left)
    figure, axes = sheet(1, 1, size, left=left, legend=False)
    ax = axes[0, 0]
    box = ax.get_position()
    ax.set_position((box.x0, box.y0, taken * box.width, box.height))
    scale_of = figure.add_axes((box.x0 + (taken + 0.03) * box.width, box.y0, 0.02, box.height))
    values = found.correlations[np.ix_(known, known)]
    image = ax.imshow(values, cmap="RdBu_r", vmin=-1, vmax=1, aspect="auto", interpolation="nearest")
    ax.grid(visible=False)
    if few:
        ax.set_yticks(range(len(names)), names, fontsize=6)
        ax.set_xticks(range(len(names)), [str(k + 1) for k in range(len(names))], fontsize=6)
    ax.set_xlabel("parameter, in the order of the table")
    figure.colorbar(image, ax=ax, cax=scale_of, label="correlation [-]")
    return figure


def headline(found: Calibration) -> str:
    """Return how the gap shrinks on what was held out, or on the training where nothing was."""
    records = found.held_out or found.training
    gap = found.gap(records)
    sizes = (gap.before_rms, gap.after_rms, gap.noise_rms)
    before, after, noise = (with_unit(value, found.unit) for value in sizes)
    where = "held-out data" if found.held_out else "the training"
    return f"{found.main_signal}: rms gap on {where} {before} -> {after}, noise {noise}"


def fit_sentence(found: Calibration) -> str:
    """Return the number of parameters and chi-square in a sentence."""
    chi, known = found.chi_square, sum(each.determined for each in found.parameters)
    return (
        f"{len(found.parameters)} parameters, {known} of them determined by the data; chi-square "
        f"{number(chi.value, 4)} of {chi.rows} residuals and {number(chi.parameters)} effective parameters, "
        f"reduced {number(chi.reduced)}"
    )


def family_sentence(family: CalibratedFamily) -> str:
    """Return what a family shares, and how its members differ."""
    places = family.at[0] if len(family.at) == 1 else f"{len(family.at)} places"
    name = f"{effect_words(family.effect)}, {family.parameter}, at {places}"
    if family.shared is None:
        return f"{name}: rms size {with_unit(family.spread, family.unit)}"
    shared = family.shared
    value, low, high, unit = interval(
        Estimate(family.parameter, shared.value, 0.0, shared.low90, shared.high90, family.unit)
    )
    return (
        f"{name}: shared size {value} {unit}, 90 % interval {low} to {high}; "
        f"members differ by a factor {number(exp(family.spread))} (1 sigma)"
    )


def row(each: CalibratedParameter) -> tuple[str, str, str, str, str]:
    """Return name, value, interval, unit and identifiability of an estimate."""
    value, low, high, unit = interval(
        Estimate(each.name, each.value, each.std, each.low90, each.high90, each.unit)
    )
    return each.name, value, f"{low} to {high}", unit, f"{100 * each.identifiability:.0f} %"


ONE_SIDED = "cannot be told from rigid, or from none: data alone set one end of the 90 % interval"


def one_sided_words(each: CalibratedParameter) -> str:
    """Return the end of an interval that data alone set."""
    end = each.low90 if each.one_sided == "low" else each.high90
    return f"{each.name} {'above' if each.one_sided == 'low' else 'below'} {with_unit(end, each.unit)}"


def pair_sentence(pair: tuple[str, str, float]) -> str:
    """Return a pair of correlated parameters."""
    return f"{pair[0]} and {pair[1]}: {pair[2]:+.3f}"


def summary(found: Calibration) -> str:
    """Return all that matters on one screen."""
    free = [each for each in found.parameters if not each.determined]
    return text_of(
        "calibration.txt.j2",
        c=found,
        headline=headline(found),
        fit=fit_sentence(found),
        families=[family_sentence(family) for family in found.families],
        known="\n".join(_table([row(each) for each in found.parameters if each.determined])),
        one_sided=[one_sided_words(each) for each in free if each.one_sided],
        one_sided_title=ONE_SIDED,
        unknown=[each.name for each in free if not each.one_sided],
        pairs=[pair_sentence(pair) for pair in found.confounded],
        most=12,  # pairs; calibration.json has all
        frame_words=frame_words,
        gaps=gap_lines(found, {name: f"{name} (held out)" for name in found.held_out}),
    )


def _table(rows: list[tuple[str, str, str, str, str]]) -> list[str]:
    """Return rows with columns that align."""
    widths = [max((len(each[k]) for each in rows), default=0) for k in range(5)]
    return [
        f"  {name:<{widths[0]}}  {value:>{widths[1]}} {unit:<{widths[3]}}  {ends:>{widths[2]}}  {share:>5}"
        for name, value, ends, unit, share in rows
    ]


FORMAT = "flexarm-calibration/1"


class CorrelationsEntry(Entry):
    """Correlations of the parameters, in their order."""

    parameters: list[str]
    matrix: list[list[float]]

    @model_validator(mode="after")
    def _square(self) -> Self:
        count = len(self.parameters)
        if len(self.matrix) != count or any(len(row) != count for row in self.matrix):
            raise ValueError("correlations.matrix must have a row and a column for each parameter")
        return self


class ChiSquareEntry(Entry):
    """Goodness of fit."""

    value: float
    rows: int
    parameters: float
    reduced: float
    inflation: dict[str, float]


class ProvenanceEntry(Entry):
    """Where the calibration comes from."""

    version: str
    git: str
    inputs_sha256: dict[str, str]
    step: float
    seconds: float


class DetailsEntry(Entry):
    """Records, and sentences for a person."""

    training: list[str]
    held_out: list[str]
    hold_out_kind: str
    remarks: list[str]


class CalibrationFile(Entry):
    """The whole file."""

    format: Literal["flexarm-calibration/1"]
    parameters: list[CalibratedParameter]
    families: list[CalibratedFamily]
    correlations: CorrelationsEntry
    frames: list[CalibratedFrame]
    chi_square: ChiSquareEntry
    gap: GapsEntry
    provenance: ProvenanceEntry
    details: DetailsEntry


def calibration_dict(found: Calibration) -> dict[str, Any]:
    """Return the object of `calibration.json`, checked against the format."""
    digits = 4  # of a correlation: more are noise
    provenance = provenance_of(found.provenance)
    content = {
        "format": FORMAT,
        "parameters": [asdict(each) for each in found.parameters],
        "families": [asdict(each) for each in found.families],
        "correlations": {
            "parameters": [each.name for each in found.parameters],
            "matrix": found.correlations.round(digits),
        },
        "frames": [asdict(each) for each in found.frames],
        "chi_square": {**asdict(found.chi_square), "reduced": found.chi_square.reduced},
        "gap": gaps_of(found),
        "provenance": {key: provenance[key] for key in ProvenanceEntry.model_fields},
        "details": {key: getattr(found, key) for key in DetailsEntry.model_fields},
    }
    return CalibrationFile.model_validate(plain(content)).model_dump(mode="json")
