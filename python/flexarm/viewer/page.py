"""A scene as one HTML page that needs no network: Meshcat's viewer, the scene's numbers, and a player."""

from __future__ import annotations

import json
from base64 import b64encode
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexarm.errors import InvalidParameter
from flexarm.viewer.scene import Clip, Scene, nice
from flexarm.viewer.skeleton import quaternions
from flexarm.viewer.solids import Skin


def page(scene: Scene) -> str:
    """Return the page.

    Raise InvalidParameter if Meshcat is not installed.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=PackageLoader("flexarm.viewer", "."), autoescape=True, undefined=StrictUndefined
    )
    here = Path(__file__).parent
    found = find_spec("meshcat")
    if found is None or not found.submodule_search_locations:
        raise InvalidParameter(
            "pictures in three dimensions need Meshcat: pip install 'flexarm[view]', or pip install meshcat",
            where="view",
        )
    folder = Path(next(iter(found.submodule_search_locations)))
    return environment.get_template("page.html.j2").render(
        title=scene.title,
        notes=scene.notes,
        meshcat=Markup(_script((folder / "viewer" / "dist" / "main.min.js").read_text(encoding="utf-8"))),
        scene=Markup(_script(json.dumps(_plain(scene)))),
        player=Markup(_script((here / "player.js").read_text(encoding="utf-8"))),
    )


def _script(text: str) -> str:
    """Return text that no HTML parser takes for the end of its script."""
    return text.replace("</script", "<\\/script").replace("<!--", "<\\!--")


def _plain(scene: Scene) -> dict[str, Any]:
    cells = 24  # least number of cells of the ground's grid along the scene
    box = scene.box
    # A scene that is flat still needs room around it.
    size = float(np.linalg.norm(box[1] - box[0]))
    cell = nice(max(size, 1e-9) / 8)
    divisions = 2 * int(np.ceil(max(cells / 2, 0.75 * size / cell)))
    centre = cell * np.round(box.mean(axis=0) / cell)
    ground = min(0.0, float(box[0, 2]))
    return {
        "layers": [vars(layer) for layer in scene.layers],
        "skins": [_skin(skin) for skin in scene.skins],
        "labels": [vars(label) for label in scene.labels],
        "clips": [_clip(clip) for clip in scene.clips],
        "bones": scene.clips[0].poses.x.shape[1],
        "box": box.tolist(),
        "grid": {
            "size": divisions * cell,
            "divisions": divisions,
            "centre": [float(centre[0]), float(centre[1]), ground],
            "text": f"{cell:g} m",
        },
    }


def _skin(skin: Skin) -> dict[str, Any]:
    return {
        "layer": skin.layer,
        "name": skin.name.replace("/", "|"),  # a slash parts the names of Meshcat's tree
        "colour": skin.colour,
        "opacity": skin.opacity,
        "flat": skin.flat,
        "lines": skin.faces.shape[1] == 2,
        "corners": len(skin.bone),
        "bone": _packed(skin.bone, "<i2"),
        "place": _packed(skin.place, "<f4"),
        "weight": None if skin.weight is None else _packed(skin.weight, "<f4"),
        "faces": _packed(skin.faces, "<u4"),
    }


def _clip(clip: Clip) -> dict[str, Any]:
    return {
        "name": clip.name,
        "text": clip.text,
        "loops": clip.loops,
        "time": _packed(clip.time, "<f8"),
        "x": _packed(clip.poses.x, "<f4"),
        "q": _packed(quaternions(clip.poses), "<f4"),
    }


def _packed(values: ArrayLike, kind: str) -> str:
    return b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()
