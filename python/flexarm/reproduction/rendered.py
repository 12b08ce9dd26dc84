"""Solids as a renderer draws them: smooth faces, hidden by depth. Needs the extra `view` (pyvista).

Renderers end the whole process where they find neither a display nor a software driver, so the drawing is
done by a process of its own; where pyvista is missing or that process fails, there is no image and matplotlib
draws the solids instead.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.termination import scratch_directory, undone_on_exit

Part = tuple[Floats, tuple[tuple[int, ...], ...], Floats | None]
"""Points (n, 3), faces, and a value at each point to colour by; None: grey and seen through."""


def rendered(
    parts: Sequence[Part], largest: float, colours: str, view: tuple[float, float]
) -> NDArray[Any] | None:
    """Return an image of the parts, (height, width, 4), cut to what it shows; None if nothing can render.

    The last colour of the map stands for `largest`, the first for 0; the view is elevation and azimuth [deg].
    """
    if find_spec("pyvista") is None:
        return None
    from matplotlib.image import imread

    with scratch_directory() as folder:
        scene, image = folder / "scene.npz", folder / "image.png"
        arrays: dict[str, Any] = {"count": len(parts)}
        for i, (points, faces, values) in enumerate(parts):
            arrays[f"points_{i}"] = points
            arrays[f"faces_{i}"] = np.concatenate([[len(face), *face] for face in faces] or [[]]).astype(int)
            arrays[f"values_{i}"] = np.array([]) if values is None else values
        np.savez(scene, **arrays, largest=largest, colours=colours, view=view)
        command = [sys.executable, "-m", "flexarm.reproduction.rendered", str(scene), str(image)]
        if _done(command) and image.is_file():
            return _cut(imread(image))
    return None


def _done(command: list[str]) -> bool:
    """Run a command to its end; return False if it fails or takes too long."""
    patience = 120.0  # after so many seconds the renderer is given up [s]
    try:
        renderer = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    except OSError:
        return False
    with renderer, undone_on_exit(renderer.kill):
        try:
            return renderer.wait(patience) == 0
        except subprocess.TimeoutExpired:
            return False
        finally:
            renderer.kill()


def _cut(image: NDArray[Any]) -> NDArray[Any]:
    """Cut the empty margins."""
    rows, columns = (np.flatnonzero(image[..., 3].any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return image
    return image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def _draw(scene: Path, image: Path) -> None:
    """Draw in a process of its own."""
    window = (2400, 1500)
    pyvista: Any = import_module("pyvista")
    data = np.load(scene)
    plotter = pyvista.Plotter(off_screen=True, window_size=list(window))
    for i in range(int(data["count"])):
        mesh, values = pyvista.PolyData(data[f"points_{i}"], data[f"faces_{i}"]), data[f"values_{i}"]
        if values.size:
            mesh["value"] = values
            plotter.add_mesh(
                mesh,
                scalars="value",
                cmap=str(data["colours"]),
                clim=[0.0, float(data["largest"])],
                show_scalar_bar=False,
                smooth_shading=True,
                split_sharp_edges=True,
                ambient=0.3,
            )
        else:
            plotter.add_mesh(mesh, color="grey", opacity=0.2)
    elevation, azimuth = np.radians(data["view"])
    plotter.enable_parallel_projection()
    plotter.view_vector(
        (np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)),
        viewup=(0.0, 0.0, 1.0),
    )
    plotter.enable_anti_aliasing("ssaa")
    plotter.screenshot(str(image), transparent_background=True, return_img=False)


if __name__ == "__main__":
    _draw(Path(sys.argv[1]), Path(sys.argv[2]))
