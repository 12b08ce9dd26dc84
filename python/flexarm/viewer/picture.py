"""Plain pictures of the same scenes: the arm in the plane in which it reaches and moves most."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arguments import takes
from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter
from flexarm.modal import Modes
from flexarm.statics import Statics
from flexarm.viewer.bodies import OF_LINKS
from flexarm.viewer.scene import STYLE, Scene, placed
from flexarm.viewer.solids import Skin
from flexarm.viewer.stages import of_arm, of_modes, of_statics

if TYPE_CHECKING:
    from matplotlib.axes import Axes

GHOSTS = ("rigid arm", "equilibrium")
NAMED = ("joints", "payloads", "points")
COLUMNS = 3
"""Of a figure of several modes."""


@takes()
def draw(of: Any, ax: Axes | None = None, **options: Any) -> Axes:
    """Draw an arm, an equilibrium or modes with Matplotlib, with the options of its method `plot`.

    Raise InvalidParameter if it is nothing of these.
    """
    if isinstance(of, Statics):
        return _one(of_statics(of, **options), 0, ax)
    if isinstance(of, Modes):
        return _modes(of, ax, **options)
    if isinstance(of, Arm):
        return _one(of_arm(of, **options), 0, ax)
    raise InvalidParameter(f"must be an Arm, Statics or Modes, got {type(of).__name__}", where="draw")


@takes()
def _modes(found: Modes, ax: Axes | None = None, mode: int | None = None) -> Axes:
    import matplotlib.pyplot as plt

    scene, count = of_modes(found), len(found.frequency_hz)
    if mode is not None and not 1 <= mode <= count:
        raise InvalidParameter(f"must lie between 1 and {count}, got {mode}", where="mode")
    if ax is not None or mode is not None or count == 1:
        return _one(scene, (mode or 1) - 1, ax)
    rows, columns = -(-count // COLUMNS), min(count, COLUMNS)
    _, panels = plt.subplots(
        rows, columns, figsize=(4.2 * columns, 3.6 * rows), squeeze=False, layout="constrained"
    )
    for i, panel in enumerate(panels.flat):
        if i < count:
            _one(scene, i, panel, names=False)
        else:
            panel.set_axis_off()
    first: Axes = panels[0, 0]
    return first


def _one(scene: Scene, clip: int, ax: Axes | None, names: bool = True) -> Axes:
    """Draw one motion where it is farthest from its start."""
    import matplotlib.pyplot as plt

    axes = plt.subplots(figsize=(6.4, 5.2), layout="constrained")[1] if ax is None else ax
    shown = scene.clips[clip]
    moved = np.linalg.norm(shown.poses.x - shown.poses.x[:1], axis=-1).max(axis=1)
    turned = np.abs(shown.poses.R - shown.poses.R[:1]).max(axis=(1, 2, 3))
    frame = int(np.argmax(moved / max(moved.max(), 1e-300) + turned))
    at_rest = len(shown.time) == 1 and len(scene.clips) > 1
    x = np.concatenate([clip.poses.x for clip in scene.clips]) if at_rest else shown.poses.x
    first, second = _plane(x, at_rest)
    for skin in scene.skins:
        corners = placed(skin, shown.poses, frame)[:, [first, second]]
        if skin.layer in GHOSTS:
            _fill(axes, skin, corners, 0.35, zorder=1)
        elif skin.layer in (*OF_LINKS, "joints", "points", "base", "gravity") and skin.faces.shape[1] == 3:
            _fill(axes, skin, corners, 1.0, zorder=3 if skin.layer in ("joints", "points") else 2)
    ghost = next((layer for layer in scene.layers if layer.name in GHOSTS), None)
    if ghost is not None:
        axes.plot([], [], color=STYLE.ghost, alpha=0.5, lw=4, label=ghost.text)
        axes.legend(loc="upper left", fontsize="small", frameon=False)  # "best" asks every corner
    several = len(scene.clips) > 1
    said = f"{shown.name.partition(':')[0]}: {shown.text.partition(';')[0]}" if several else scene.title
    axes.set_title(_wrapped("\n".join([said, *(() if several else scene.notes[:1])])), fontsize=9)
    axes.set(xlabel=f"{'xyz'[first]} [m]", ylabel=f"{'xyz'[second]} [m]")
    axes.margins(0.15)  # room for names
    axes.set_aspect("equal", adjustable="datalim")
    axes.autoscale_view()
    if names:
        _names(axes, scene, shown.poses.R[frame], shown.poses.x[frame], (first, second))
    return axes


def _plane(x: Floats, at_rest: bool) -> tuple[int, int]:
    """Return the axes that are drawn: poses (m, bone, 3) are looked at along the least extent and motion.

    A motion shows along its greatest axis. Of an arm at rest the poses are motions of its joints, one by one.
    """
    moved = np.abs(x - x[0]).max(axis=(0, 1))
    extent = np.ptp(x[0], axis=0) + moved
    extent += 1e-9 * extent.max() * np.array([1, 0, 2])  # among equals x and z are shown
    if not at_rest and moved.any():
        extent[np.argmax(moved)] = np.inf
    least = int(np.argmin(extent))
    first, second = (k for k in range(3) if k != least)
    return first, second


def _fill(axes: Axes, skin: Skin, corners: Floats, opacity: float, zorder: float) -> None:
    from matplotlib.collections import PolyCollection

    surface = PolyCollection(
        list(corners[skin.faces]), facecolor=skin.colour, edgecolor=skin.colour, linewidth=0.6, zorder=zorder
    )
    if opacity < 1:  # overlapping faces must not add up
        surface.set(facecolor="#d3d6da", edgecolor="#d3d6da")
    axes.add_collection(surface)


def _names(axes: Axes, scene: Scene, R: Floats, x: Floats, plane: tuple[int, int]) -> None:
    """Write names next to their places, where they cover no other name, inside the axes if they can."""
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox

    figure = axes.get_figure(root=True)
    assert figure is not None
    figure.draw_without_rendering()  # limits of the axes and sizes of texts are known from here on
    inside, pixels = axes.get_window_extent().padded(-2), figure.dpi / 72  # [px], [px/pt]
    taken: list[Bbox] = []
    for label in (each for each in scene.labels if each.layer in NAMED):
        place = np.array(label.place)
        at = place if label.bone < 0 else x[label.bone] + R[label.bone] @ place
        colour = {"joints": STYLE.axis, "payloads": "#9a5a0a"}.get(label.layer, STYLE.points)
        name = axes.annotate(
            label.text,
            tuple(at[list(plane)]),
            xytext=(0, 0),
            textcoords="offset points",
            fontsize=8,
            color=colour,
            bbox={"facecolor": "white", "alpha": 0.7, "edgecolor": "none", "pad": 0.5},
            arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.5},
            zorder=5,
        )
        name.get_window_extent()  # of name and line together: it puts the text at its place
        own = Text.get_window_extent(name).padded(1)
        rows = sorted(range(-len(taken), len(taken) + 1), key=abs)
        offsets = [(right, 4 - 11 * row) for row in rows for right in (8, -8 - own.width / pixels)]
        free = []
        for offset in offsets:
            box = Bbox.from_bounds(
                own.x0 + pixels * offset[0], own.y0 + pixels * offset[1], own.width, own.height
            )
            if not any(box.overlaps(other) for other in taken):
                outside = Bbox.union([box, inside]).width * Bbox.union([box, inside]).height
                free.append((outside > 1.0001 * inside.width * inside.height, offset, box))
        _, offset, box = min(free, key=lambda each: each[0])
        name.set_position(offset)
        name.set_in_layout(False)  # or the axes would shrink, and places under names move
        if name.arrow_patch is not None:
            name.arrow_patch.set_visible(abs(offset[1] - 4) > 11)
        taken.append(box)


def _wrapped(text: str) -> str:
    widest = 48  # line of a title, in letters
    whole = text.replace(" %", "\u00a0%").replace(" Hz", "\u00a0Hz")  # no unit begins a line
    return "\n".join(fill(line, widest) for line in whole.splitlines())
