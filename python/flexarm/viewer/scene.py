"""What a page shows: skins on bones, labels, and clips that move the bones."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from flexarm.arrays import Floats
from flexarm.viewer.skeleton import Poses
from flexarm.viewer.solids import Skin


@dataclass(frozen=True)
class Style:
    """How large and in which colours things are drawn. Sizes are shares of the scene's."""

    joint: float = 0.012
    stick: float = 0.008
    frame: float = 0.06
    point: float = 0.008
    arrow: float = 0.14
    shown_deformation: float = 0.06
    largest_scale: float = 1e12
    """Greatest factor of displacements: a picometre shows, and places stay numbers that a page can hold."""
    shown_mode: float = 0.12
    most_turned: float = 0.4
    """Greatest rotation of a drawn mode [rad]: beyond, straight displacements tear turning parts off."""
    shown_gap: float = 0.1
    payload_density: float = 7850.0
    frames_per_second: float = 30.0
    most_frames: int = 900
    mode_frames: int = 32
    meshed: float = 0.65
    beam: str = "#3d7ab8"
    body: str = "#9aa3ad"
    part: str = "#5a9e8f"
    base: str = "#4a4f57"
    joints: str = "#33373d"
    axis: str = "#c03030"
    payload: str = "#e08a1e"
    points: str = "#12436d"
    measured: str = "#d4351c"
    ghost: str = "#8a8f96"
    gravity: str = "#6f42a5"
    axes: tuple[str, str, str] = ("#d03030", "#2e8b3d", "#2f55c8")


STYLE = Style()


@dataclass(frozen=True)
class Layer:
    """What can be shown and hidden together."""

    name: str
    colour: str
    """As the legend has them."""
    text: str
    """What it is, with units and scale."""
    shown: bool = True
    """At first."""


@dataclass(frozen=True)
class Label:
    """A text at a place: at `place` [m] in the frame of a bone, -1 for the base."""

    layer: str
    text: str
    bone: int
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Clip:
    """A motion of the bones."""

    name: str
    time: Floats
    """Instants of the frames [s], as they are played, shape (m,)."""
    poses: Poses
    text: str = ""
    loops: bool = False
    """The last frame is followed by the first."""


@dataclass(frozen=True)
class Scene:
    """One page."""

    title: str
    """Name of the arm or part, and what is shown of it."""
    notes: tuple[str, ...] = ()
    """Sentences below it, such as the scale of deformations."""
    layers: tuple[Layer, ...] = ()
    skins: tuple[Skin, ...] = ()
    labels: tuple[Label, ...] = ()
    clips: tuple[Clip, ...] = field(default_factory=tuple)

    @property
    def box(self) -> Floats:
        """Least and greatest corner of all skins in some frames of the first motion [m], shape (2, 3)."""
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for clip in self.clips[:1]:
            n = len(clip.time)
            for i in dict.fromkeys((0, n // 4, n // 2, 3 * n // 4, n - 1)):
                for skin in self.skins:
                    corners = placed(skin, clip.poses, i)
                    low = np.fmin(low, np.nanmin(corners, axis=0, initial=np.inf))
                    high = np.fmax(high, np.nanmax(corners, axis=0, initial=-np.inf))
        return np.array([low, high])


def placed(skin: Skin, poses: Poses, frame: int) -> Floats:
    """Return the corners of a skin in a frame, shape (corner, 3), base axes [m]."""
    R = np.concatenate([poses.R[frame], np.eye(3)[None]])  # bone -1: the base
    x = np.concatenate([poses.x[frame], np.zeros((1, 3))])
    hung = x[skin.bone] + np.einsum("vkij,vkj->vki", R[skin.bone], skin.place)
    weight = np.ones(skin.bone.shape) if skin.weight is None else skin.weight
    return np.asarray(np.einsum("vk,vki->vi", weight, hung))


def nice(value: float) -> float:
    """Return the greatest of 1, 2, 5 times a power of ten that is not above a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(step * power for step in (1, 2, 5) if step * power <= value * (1 + 1e-9)))
