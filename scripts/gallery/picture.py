"""The pictures of the gallery: an effect's gap in four panels, and who explains whom."""

from __future__ import annotations

import io
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

from flexarm.report.files import style
from flexarm.reproduction.figures import MEASURED, MODEL, RIGID, SINE
from gallery.confusion import ALIKE, Confusion
from gallery.experiments import FAST, Floats
from gallery.gaps import at_tip, bench, by_direction, slow_part, states
from gallery.signatures import Signature
from gallery.text import length_unit

AXES = {
    "angle": "joint angle [rad]",
    "rate": "joint rate [rad/s]",
    "torque": "joint torque [N m]",
    "time": "time [s]",
}
COLOURS = {"tangential": MODEL, "radial": MEASURED, "normal": SINE, "motor torque": RIGID}
SMALL = 0.01
"""Part of the largest gap below which the normal direction is not drawn."""


def draw_gap(signature: Signature, path: Path) -> None:
    """The gap against angle, rate, torque and time of the joint; bold: without the first mode."""
    run = bench(FAST, signature.model)
    parts, label, factor = _drawn(signature)
    state = states(run)
    with style(), mpl.rc_context({"font.size": 8, "axes.labelsize": 8}):
        figure, axes = plt.subplots(2, 2, figsize=(6.9, 4.1), sharey=True)
        for panel, (key, name) in zip(axes.flat, AXES.items(), strict=True):
            for part, values in parts.items():
                panel.plot(state[key], values / factor, color=COLOURS[part], linewidth=0.5, alpha=0.35)
                slow = slow_part(run, state[key]), slow_part(run, values) / factor
                panel.plot(*slow, color=COLOURS[part], label=part, linewidth=1.2)
            panel.set_xlabel(name)
        for panel in axes[:, 0]:
            panel.set_ylabel(label)
        handles = axes[0, 0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper center", ncols=3, frameon=False)
        _save(figure, path, 48)


def _drawn(signature: Signature) -> tuple[dict[str, Floats], str, float]:
    """What is drawn, its label and unit: the tip's gap, or the motor torque's where the tip shows none."""
    gap = signature.shown.gaps[FAST]
    if not at_tip(gap):
        return {"motor torque": gap["torque"][:, 0]}, "motor torque's gap [N m]", 1.0
    parts = by_direction(bench(FAST, signature.model), gap)
    largest = max(float(np.abs(part).max()) for part in parts.values())
    factor, unit = length_unit(largest)
    if np.abs(parts["normal"]).max() < SMALL * largest:
        del parts["normal"]
    return parts, f"tip's gap [{unit}]", factor


def draw_confusion(found: Confusion, title: str, path: Path) -> None:
    """R^2 of each effect (row) by each other one (column); grey where the row is not seen."""
    names = list(found.share)
    values = np.array([[found.share[a].get(b, np.nan) for b in names] for a in names])
    with style(), mpl.rc_context({"axes.grid": False, "font.size": 6.5}):
        figure, panel = plt.subplots(figsize=(7.6, 7.2))
        colours = mpl.colormaps["viridis"].copy()
        colours.set_bad("#dddddd")
        image = panel.imshow(np.ma.masked_invalid(values), vmin=0, vmax=1, cmap=colours)
        rows, columns = np.nonzero(np.nan_to_num(values) >= ALIKE)
        panel.plot(columns, rows, "k.", markersize=3)
        panel.set_xticks(range(len(names)), names, rotation=90)
        panel.set_yticks(range(len(names)), names)
        panel.tick_params(length=0)
        panel.set(xlabel="rival that is fitted", ylabel="effect whose gap it is")
        panel.set_title(title, fontsize=9)
        figure.colorbar(image, label=f"R² [-], dots: {ALIKE} and more", shrink=0.7)
        _save(figure, path, 160)


def _save(figure: plt.Figure, path: Path, colours: int) -> None:
    """With few colours: lines need no more, and a gallery is small."""
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=100)
    plt.close(figure)
    few = Image.open(drawn).convert("RGB").quantize(colours, dither=Image.Dither.NONE)
    few.save(path, optimize=True)
