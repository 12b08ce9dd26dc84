"""Figures of a calibration: members of families, and correlations."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexarm.report.gap_curves import AFTER
from flexarm.report.sheets import WIDTH, log_if_wide, margin_for, sheet
from flexarm.wording import effect_words, scale

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexarm.calibration.estimates import CalibratedFamily
    from flexarm.calibration.result import Calibration

UNKNOWN = "#999999"
NAMED = 30
"""Parameters up to which a matrix of correlations names them."""

BAR = 0.85
"""Part of a sheet's width that a matrix takes; the rest is its scale's."""


def members(found: Calibration) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of each family: its members with 90 % intervals."""
    for family in found.families:
        yield f"{family.effect}-{family.parameter}", _members(found, family)


def _members(found: Calibration, family: CalibratedFamily) -> Figure:
    keys = [f"effects.{family.effect}.{at}.{family.parameter}" for at in family.at]
    estimates = [found.parameter(key) for key in keys]
    factor, unit = scale([each.value for each in estimates], family.unit)
    figure, axes = sheet(1, 1, 0.2 * len(keys) + 0.2, left=margin_for(family.at), legend=False)
    ax = axes[0, 0]
    if family.shared is not None:
        ax.axvspan(factor * family.shared.low90, factor * family.shared.high90, color=AFTER, alpha=0.2, lw=0)
        ax.axvline(factor * family.shared.value, color=AFTER, lw=0.8)
    for k, each in enumerate(estimates):
        ends = [[factor * (each.value - each.low90)], [factor * (each.high90 - each.value)]]
        colour = AFTER if each.determined else UNKNOWN
        ax.errorbar([factor * each.value], [k], xerr=ends, fmt="o", ms=4, capsize=3, color=colour)
    ax.set(yticks=range(len(keys)), yticklabels=list(family.at), ylim=(len(keys) - 0.5, -0.5))
    ax.set_xlabel(f"{family.parameter} [{unit or '-'}]")
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
    few = len(names) <= NAMED
    left = margin_for(names, 6.0) if few else 0.4
    size = BAR * (WIDTH - left)
    figure, axes = sheet(1, 1, size, left=left, legend=False)
    ax = axes[0, 0]
    box = ax.get_position()
    ax.set_position((box.x0, box.y0, BAR * box.width, box.height))
    scale_of = figure.add_axes((box.x0 + (BAR + 0.03) * box.width, box.y0, 0.02, box.height))
    values = found.correlations[np.ix_(known, known)]
    image = ax.imshow(values, cmap="RdBu_r", vmin=-1, vmax=1, aspect="auto", interpolation="nearest")
    ax.grid(visible=False)
    if few:
        ax.set_yticks(range(len(names)), names, fontsize=6)
        ax.set_xticks(range(len(names)), [str(k + 1) for k in range(len(names))], fontsize=6)
    ax.set_xlabel("parameter, in the order of the table")
    figure.colorbar(image, ax=ax, cax=scale_of, label="correlation [-]")
    return figure
