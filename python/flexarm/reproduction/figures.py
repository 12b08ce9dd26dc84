"""The paper's figures from their tables."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.output import write_file
from flexarm.reproduction.deformed_figure import MEASURED, MODEL, RIGID, SINE, deformed
from flexarm.reproduction.scene import Surface
from flexarm.reproduction.tables import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


WIDTH = 6.9
"""Two columns of a journal [in]."""
_MEASURED: dict[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 3.2,
    "markeredgewidth": 0,
    "color": MEASURED,
}
THIN: dict[str, Any] = {"linewidth": 0.6, "zorder": 3}
"""A model's line over the dots of a whole run; dots left out would alias the oscillations."""


def draw(number: str, table: Table, surfaces: Sequence[Surface] = ()) -> Figure:
    """Draw the figure of that number; Figure 6 shows the surfaces of the mock-up."""
    if number == "06":
        return deformed(table, surfaces)
    figure = _DRAWERS[number](table)
    if len(figure.axes) > 1:
        for letter, ax in zip("abcdefgh", figure.axes, strict=False):
            ax.set_title(f"({letter})", loc="left", fontweight="bold")
    return figure


def save(figure: Figure, stem: Path) -> None:
    """Write .png and .pdf, the same bytes every time."""
    metadata = {"png": {"Software": None}, "pdf": {"CreationDate": None, "Producer": None, "Creator": None}}
    for kind, told in metadata.items():
        image = BytesIO()
        figure.savefig(image, format=kind, metadata=told)
        write_file(stem.with_suffix(f".{kind}"), image.getbuffer())


def _figure(rows: int, height: float, **options: Any) -> tuple[Figure, Any]:
    """Return axes below one another, without pyplot's global state."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height))
    FigureCanvasAgg(figure)
    return figure, figure.subplots(rows, 1, squeeze=False, **options)[:, 0]


def input_shaft(table: Table) -> Figure:
    """Draw Figure 4."""
    figure, (ax,) = _figure(1, 2.6)
    ax.plot(table["time_s"].values, table["input_shaft_rad"].values, color=MODEL)
    ax.set(xlabel="time [s]", ylabel="input shaft angle [rad]", yticks=np.arange(-144, 145, 48))
    ax.set_xlim(0, table["time_s"].values[-1])
    return figure


def positions(table: Table) -> Figure:
    """Draw Figure 7: vertical and horizontal tip position."""
    figure, axes = _figure(2, 4.6, sharex=True)
    for ax, axis, text in zip(
        axes, "zx", ("vertical position z [m]", "horizontal position x [m]"), strict=True
    ):
        _draw_tip(ax, table, axis)
        ax.set_ylabel(text)
    axes[-1].set(xlabel="time [s]", xlim=(0, table["time_s"].values[-1]))
    _legend(axes[0])
    return figure


def zoom(table: Table) -> Figure:
    """Draw Figure 8: the vertical position enlarged, and the oscillations that the rigid arm lacks."""
    from scipy.interpolate import CubicSpline

    figure, (above, below) = _figure(2, 4.8, sharex=True, height_ratios=(1.3, 1))
    time = table["time_s"].values
    rigid, model = table["rigid_z_m"].values, table["model_z_m"].values
    fine = np.linspace(time[0], time[-1], 10 * len(time))  # lines without corners between the rows
    arm, tip = (CubicSpline(time, z)(fine) for z in (rigid, model))
    above.plot(fine, arm, "--", color=RIGID, label="rigid arm at the encoder's angle")
    above.plot(fine, tip, color=MODEL, label="finite-element model")
    _dots(above, time, table["measured_z_m"].values)
    above.set_ylabel("vertical position z [m]")
    _legend(above)
    below.plot(fine, 1e3 * (tip - arm), color=MODEL)
    _dots(below, time, 1e3 * (table["measured_z_m"].values - rigid))
    below.set(xlabel="time [s]", ylabel="z minus rigid z [mm]", xlim=(time[0], time[-1]))
    return figure


def error(table: Table) -> Figure:
    """Draw Figure 9: vertical and horizontal error of the rigid position, and what the model leaves of it."""
    figure, axes = _figure(3, 6.6, sharex=True)
    time = table["time_s"].values
    for ax, axis, text in zip(axes[:2], "zx", ("vertical error [mm]", "horizontal error [mm]"), strict=True):
        ax.plot(
            time, 1e3 * table[f"model_{axis}_m"].values, color=MODEL, label="finite-element model", **THIN
        )
        _dots(ax, time, 1e3 * table[f"measured_{axis}_m"].values, size=2.2)
        ax.set_ylabel(text)
    for axis, text, colour in (("z", "vertical", MODEL), ("x", "horizontal", SINE)):
        _remainder(axes[-1], table, f"measured_{axis}_m", f"model_{axis}_m", text, colour)
    axes[-1].set(xlabel="time [s]", xlim=(0, time[-1]))
    _legend(axes[0])
    _legend(axes[-1])
    return figure


def tangential(table: Table) -> Figure:
    """Draw Figure 10: tangential error of the run, its start, a later turn, and what models leave of it."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, 7.6))
    FigureCanvasAgg(figure)
    axes = figure.subplot_mosaic(
        [["run", "run"], ["start", "later"], ["left", "left"]], height_ratios=(1.2, 1, 0.9)
    )
    time = table["time_s"].values
    for name in ("run", "start", "later"):
        ax = axes[name]
        line: dict[str, Any] = THIN if name == "run" else {"zorder": 3}
        ax.plot(time, 1e3 * table["sine_m"].values, color=SINE, lw=0.6, label="model, pure sine")
        ax.plot(time, 1e3 * table["encoder_m"].values, color=MODEL, label="model, encoder signal", **line)
        _dots(ax, time, 1e3 * table["measured_m"].values, size=2.2 if name == "run" else 3.2)
        ax.set_xlabel("time [s]")
    axes["run"].set(xlim=(0, time[-1]), ylabel="tangential error [mm]")
    _legend(axes["run"])
    _enlarge(axes["start"], table, (0.0, 8.0), "the start")
    turn = float(time[np.argmin(table["sine_m"].values)])  # the arm bends most to the other side
    _enlarge(axes["later"], table, (turn - 4.0, turn + 5.0), "a later turn")
    axes["start"].set_ylabel("tangential error [mm]")
    for name, text, colour in (("sine", "pure sine", SINE), ("encoder", "encoder signal", MODEL)):
        _remainder(axes["left"], table, "measured_m", f"{name}_m", text, colour)
    axes["left"].set(xlabel="time [s]", xlim=(0, time[-1]))
    _legend(axes["left"])
    return figure


def _remainder(ax: Axes, table: Table, measured: str, model: str, text: str, colour: str) -> None:
    """Draw what a model leaves of a measurement."""
    left = 1e3 * (table[measured].values - table[model].values)
    seen = np.isfinite(left)
    ax.plot(table["time_s"].values[seen], left[seen], color=colour, lw=0.6, label=text)
    ax.set_ylabel("measured minus\nmodel [mm]")


def _enlarge(ax: Axes, table: Table, window: tuple[float, float], title: str) -> None:
    """Enlarge a stretch of time, all curves in view."""
    time = table["time_s"].values
    inside = (time >= window[0]) & (time <= window[1])
    shown = 1e3 * np.concatenate(
        [table[name].values[inside] for name in ("encoder_m", "sine_m", "measured_m")]
    )
    low, high = np.nanmin(shown), np.nanmax(shown)
    ax.set(xlim=window, ylim=(low - 0.06 * (high - low), high + 0.06 * (high - low)), title=title)


def _draw_tip(ax: Axes, table: Table, axis: str) -> None:
    """Draw a coordinate of the tip: rigid arm, model and virtual measurement."""
    time = table["time_s"].values
    ax.plot(
        time, table[f"rigid_{axis}_m"].values, "--", color=RIGID, label="rigid arm at the encoder's angle"
    )
    ax.plot(time, table[f"model_{axis}_m"].values, color=MODEL, label="finite-element model")
    _dots(ax, time, table[f"measured_{axis}_m"].values, every=10)


def _dots(ax: Axes, time: Floats, values: Floats, every: int = 1, size: float = 3.2) -> None:
    """Draw samples of the tracker, each `every`-th."""
    seen = np.flatnonzero(np.isfinite(values))[::every]
    text = "virtual measurement" + (f", every {every}th" if every > 1 else "")
    ax.plot(time[seen], values[seen], label=text, **{**_MEASURED, "markersize": size})


def _legend(ax: Axes) -> None:
    """Draw the legend above the axes, where it hides nothing."""
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False)


_DRAWERS = {"04": input_shaft, "07": positions, "08": zoom, "09": error, "10": tangential}
