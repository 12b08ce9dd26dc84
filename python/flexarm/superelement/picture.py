"""A picture of a part and its interfaces, from two sides."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arrays import Floats, Ints
from flexarm.errors import InvalidFile
from flexarm.output import refuse_existing, write_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexarm.solids import SolidMesh

COLOURS = ("#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442")
"""Okabe and Ito's, told apart by everyone."""
BODY = "#c8ccd0"
AXES = ("#c00000", "#007000", "#0000c0")


def picture(
    mesh: SolidMesh, sets: Mapping[str, Ints], frames: Mapping[str, tuple[Floats, Floats]], title: str = ""
) -> Figure:
    """Draw part and interfaces in 3-D.

    Faces between the points of an interface are coloured, other points drawn as dots. Of its frame (rotation
    and position) x is drawn red, y green, z blue.
    """
    from matplotlib.figure import Figure as Canvas
    from matplotlib.lines import Line2D

    from flexarm.solids.shape import surface

    # Elevation and azimuth [deg]: from above, and from below on the other side.
    views = ((25.0, -60.0), (-25.0, 120.0))
    faces = surface(mesh)
    figure = Canvas(figsize=(10.5, 5.2), layout="constrained")
    of_face, loose = _colours(faces, sets, mesh.n_points)
    for k, (elevation, azimuth) in enumerate(views, 1):
        axes: Any = figure.add_subplot(1, 2, k, projection="3d", computed_zorder=False)
        _faces(axes, mesh, faces, of_face)
        for name, colour in zip(sets, _cycle(len(sets)), strict=True):
            points = mesh.points[loose[name]]
            if len(points):
                axes.scatter(*points.T, color=colour, s=10, depthshade=False, zorder=2)
        _triads(axes, frames, _cycle(len(sets)), float(np.linalg.norm(mesh.box[1] - mesh.box[0])))
        _box(axes, mesh.box)
        axes.view_init(elevation, azimuth)
    handles = [
        Line2D([], [], color=colour, marker="s", linestyle="none", label=f"{name} ({len(sets[name])} points)")
        for name, colour in zip(sets, _cycle(len(sets)), strict=True)
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False)
    figure.suptitle(title or f"{mesh.n_cells} cells, {mesh.n_points} points")
    return figure


def save_picture(figure: Figure, path: str | Path, force: bool = False, inputs: Iterable[Path] = ()) -> None:
    """Write the picture; its kind follows the name's ending, and no input is replaced.

    Raise InvalidFile if the file exists and `force` is not set, or cannot be written.
    """
    refuse_existing(Path(path), force, inputs)
    image = BytesIO()
    try:
        figure.savefig(image, dpi=150, format=Path(path).suffix[1:] or None)
    except ValueError as error:  # an ending that matplotlib does not know
        raise InvalidFile(path, "output", f"cannot be written: {error}") from None
    write_file(path, image.getbuffer())


def _cycle(n: int) -> list[str]:
    return [COLOURS[i % len(COLOURS)] for i in range(n)]


def _colours(
    faces: Sequence[tuple[int, ...]], sets: Mapping[str, Ints], n_points: int
) -> tuple[list[str], dict[str, Ints]]:
    """Return the colour of each face, and the points of each set that no coloured face shows."""
    colours = [BODY] * len(faces)
    loose: dict[str, Ints] = {}
    for (name, points), colour in zip(sets.items(), _cycle(len(sets)), strict=True):
        inside = np.zeros(n_points, dtype=bool)
        inside[points] = True
        hidden = inside.copy()
        for i, face in enumerate(faces):
            if all(inside[p] for p in face):
                colours[i] = colour
                hidden[list(face)] = False
        full = np.flatnonzero(hidden)
        loose[name] = full if len(full) == len(points) else full[:0]  # middle nodes lie on coloured faces
    return colours, loose


def _faces(axes: Any, mesh: SolidMesh, faces: Sequence[tuple[int, ...]], colours: list[str]) -> None:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

    polygons = [mesh.points[list(face)] for face in faces]
    edges = "#00000040" if len(faces) < 20_000 else "none"
    axes.add_collection3d(
        Poly3DCollection(polygons, facecolors=colours, edgecolors=edges, linewidths=0.2, shade=True, zorder=1)
    )


def _triads(axes: Any, frames: Mapping[str, tuple[Floats, Floats]], colours: list[str], size: float) -> None:
    """Draw the frames over the part."""
    for (rotation, position), dot in zip(frames.values(), colours, strict=True):
        for k, colour in enumerate(AXES):
            end = position + 0.1 * size * rotation[:, k]
            axes.plot(*np.array([position, end]).T, color=colour, linewidth=1.6, zorder=3)
        axes.scatter(
            *position, color=dot, edgecolors="black", linewidths=0.6, s=28, depthshade=False, zorder=4
        )


def _box(axes: Any, box: Floats) -> None:
    lengths = np.maximum(box[1] - box[0], 1e-3 * (box[1] - box[0]).max())
    for set_limits, low, length in zip(
        (axes.set_xlim, axes.set_ylim, axes.set_zlim), box[0], lengths, strict=True
    ):
        set_limits(low, low + length)
    axes.set_box_aspect(lengths)
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    for axis, length in zip("xyz", lengths, strict=True):
        axes.locator_params(axis=axis, nbins=max(1, round(5 * length / lengths.max())))
    axes.tick_params(labelsize=7)
