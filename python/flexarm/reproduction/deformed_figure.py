"""Figure 6: the deformed mock-up in colours of displacement, and its three tips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.reproduction.rendered import Part, rendered
from flexarm.reproduction.scene import Surface
from flexarm.reproduction.tables import Table
from flexarm.reproduction.variants import HINGE

if TYPE_CHECKING:
    from matplotlib.figure import Figure


RIGID, MODEL, MEASURED, SINE = "#000000", "#0072B2", "#D55E00", "#009E73"
"""Okabe and Ito's colours, told apart by everyone; line styles and markers differ too."""
ARM_SCALE, HINGE_SCALE = 10.0, 50.0
"""Displacements are drawn so many times as large, the whole arm and its hinge."""
COLOURS = "viridis"
LIGHT = np.array([0.3, -0.8, 0.6]) / np.linalg.norm([0.3, -0.8, 0.6])
"""Where the light comes from."""


def deformed(table: Table, surfaces: Sequence[Surface]) -> Figure:
    """Draw Figure 6: the whole arm, its hinge, and the tips at true scale."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    # Elevation and azimuth [deg]; the hinge is cut open on the side that is seen.
    arm_view, hinge_view = (14.0, -62.0), (22.0, -148.0)
    figure = Figure(figsize=(6.9, 5.6))
    figure.set_layout_engine("none")  # places are given below
    FigureCanvasAgg(figure)
    figure.text(0.02, 0.965, f"deformed mock-up, displacements × {ARM_SCALE:g}; grey: rigid arm", size=9)
    _solids(figure, Frame((0.0, 0.46, 1.0, 0.50), arm_view, 2.4), surfaces, ARM_SCALE, (0.12, 0.86))
    figure.text(0.02, 0.47, f"the hinge cut open, displacements × {HINGE_SCALE:g}", size=9)
    opened = [surface.opened() for surface in surfaces if surface.name in HINGE]
    _solids(figure, Frame((0.0, 0.06, 0.52, 0.40), hinge_view, 1.3), opened, HINGE_SCALE, (0.12, 0.075))
    _tips(figure.add_axes((0.63, 0.19, 0.34, 0.25)), table)
    return figure


@dataclass(frozen=True)
class Frame:
    """A place in the figure and how it looks at the scene: elevation and azimuth [deg], matplotlib's zoom."""

    place: tuple[float, float, float, float]
    view: tuple[float, float]
    zoom: float


def _solids(
    figure: Figure, frame: Frame, surfaces: Sequence[Surface], scale: float, bar: tuple[float, float]
) -> None:
    """Draw deformed surfaces, coloured; the rigid arm in grey behind; a bar of colours in mm."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    largest = 1e3 * max(float(surface.displacement.max()) for surface in surfaces)
    colours = ScalarMappable(Normalize(0.0, largest), COLOURS)
    rigid: list[Part] = [(s.rigid, s.faces, None) for s in surfaces if s.name not in HINGE]
    moved: list[Part] = [(s.drawn(scale), s.faces, 1e3 * s.displacement) for s in surfaces]
    image = rendered([*rigid, *moved], largest, COLOURS, frame.view)
    if image is None:
        _by_matplotlib(figure, frame, rigid, moved, colours)
    else:
        x, y, width, height = frame.place
        ax = figure.add_axes((x + 0.04 * width, y + 0.08 * height, 0.92 * width, 0.84 * height))
        ax.imshow(image)
        ax.set_axis_off()
    shown = figure.colorbar(colours, cax=figure.add_axes((*bar, 0.24, 0.018)), orientation="horizontal")
    shown.ax.tick_params(labelsize=7)
    shown.ax.grid(False)
    shown.set_label("displacement from the rigid arm [mm]", size=7)


def _by_matplotlib(
    figure: Figure, frame: Frame, rigid: Sequence[Part], moved: Sequence[Part], colours: Any
) -> None:
    """Draw without a renderer: faces sorted by their distance."""
    ax: Any = figure.add_axes(frame.place, projection="3d", computed_zorder=False)
    ax.view_init(*frame.view)
    _faces(ax, rigid, None, alpha=0.10)
    _faces(ax, moved, colours, alpha=1.0)
    seen = np.concatenate([points for points, _, _ in (*rigid, *moved)])
    low, high = seen.min(axis=0), seen.max(axis=0)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    ax.set_box_aspect(high - low, zoom=frame.zoom)
    ax.set_axis_off()


def _faces(ax: Any, parts: Sequence[Part], colours: Any, alpha: float) -> None:
    """Draw all faces as one collection, shaded by their normals, so that those behind are drawn first."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

    corners = [points[list(face)] for points, faces, _ in parts for face in faces]
    if not corners:
        return
    normals = np.array([np.cross(face[2] - face[0], face[-1] - face[1]) for face in corners])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    shade = 0.65 + 0.35 * np.abs(normals @ LIGHT)
    base = np.full((len(corners), 4), 0.5)
    if colours is not None:
        values = [
            value[list(face)].mean() for _, faces, value in parts if value is not None for face in faces
        ]
        base = colours.to_rgba(np.array(values))
    base[:, :3] *= shade[:, None]
    base[:, 3] = alpha
    edges = base if colours is not None else "none"
    found = Poly3DCollection(corners, facecolors=base, edgecolors=edges, linewidths=0.2, rasterized=True)
    found.set_clip_on(False)
    ax.add_collection3d(found)


def _tips(ax: Any, table: Table) -> None:
    """Draw the three tips and the ends of the arm, true scale."""
    tips = {name: _xz(table, name)[:, -1] for name in ("rigid", "model", "measured")}
    for name, style, colour, marker, text in (
        ("rigid", "--", RIGID, "s", "rigid arm at the encoder's angle"),
        ("model", "-", MODEL, "o", "finite-element model"),
    ):
        ax.plot(*_xz(table, name), style, color=colour)
        ax.plot(*tips[name][:, None], marker, color=colour, mfc="none", ms=7, label=text)
    ax.plot(*tips["measured"][:, None], "+", color=MEASURED, ms=9, mew=1.6, label="virtual measurement")
    middle = (tips["rigid"] + tips["measured"]) / 2
    ax.set_aspect("equal")
    ax.set(xlabel="x [m]", ylabel="z [m]", xlim=middle[0] + 0.045 * np.array([-1, 1]))
    ax.set(ylim=middle[1] + 0.034 * np.array([-1, 1]))
    ax.locator_params("x", nbins=4)
    gaps = [1e3 * np.linalg.norm(tips["measured"] - tips[name]) for name in ("rigid", "model")]
    ax.set_title(
        f"three tips, true scale; measured:\n{gaps[0]:.1f} mm from rigid, {gaps[1]:.2f} mm from model", size=8
    )
    ax.legend(loc="upper center", bbox_to_anchor=(0.45, -0.24), fontsize=7, frameon=False)


def _xz(table: Table, name: str) -> Floats:
    return np.array([table[f"{name}_x_m"].values, table[f"{name}_z_m"].values])
