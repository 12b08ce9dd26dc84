r"""What moves in a mode: the joint or link that gives most of the motion where the arm moves most.

Along the chain from the base to the place P that moves most, every joint and link adds to its motion

    u_P = sum_i [u_b + θ_b × (P - x_b)] - [u_a + θ_a × (P - x_a)]                                      (1)

from the bone a before it to the bone b behind it. Its share is the size of its part along u_P, of the sum of
all sizes. A beam that twists moves its skin by its half width times the twist; if that is more than any bone
moves, the mode is its twist.
"""

from __future__ import annotations

import numpy as np

from flexarm.arm.link import Beam
from flexarm.arm.names import link_of
from flexarm.arrays import Floats
from flexarm.viewer.bodies import Bodies
from flexarm.viewer.skeleton import Poses
from flexarm.viewer.solids import half_widths


def told(bodies: Bodies, rest: Poses, shapes: Floats) -> list[str]:
    """Return a phrase on each mode: what gives most of the motion, and in which direction the arm moves.

    Shapes, (mode, bone, 6), are translations and rotations of the bones about `rest`, base axes.
    """
    return [_told(bodies, rest, shape) for shape in shapes]


def twisted(bodies: Bodies, rest: Poses, shape: Floats) -> str:
    """Return the beam whose skin moves more by its twist than any bone of the arm moves; empty if none."""
    skins = {"": float(np.linalg.norm(shape[:, :3], axis=1).max(initial=0.0))}
    for link in (link for link in bodies.arm.links if isinstance(link, Beam)):
        bones = bodies.skeleton.along[link.name]
        first, last = bones[0], bones[-1]
        twist = (shape[last, 3:] - shape[first, 3:]) @ rest.R[0, first] @ link.end / link.length
        skins[link.name] = abs(float(twist)) * max(half_widths(link.section))
    return max(skins, key=lambda name: skins[name])


def _told(bodies: Bodies, rest: Poses, shape: Floats) -> str:
    if link := twisted(bodies, rest, shape):
        return f"twist of {link}"
    moved = np.linalg.norm(shape[:, :3], axis=1)
    if not moved.any():
        return "no bone moves"
    most = int(np.argmax(moved))
    place, motion = rest.x[0, most], shape[most, :3]
    direction = motion / moved[most]
    parts = _parts(bodies, rest, shape, most, place)
    shares = {name: abs(float(part @ direction)) for name, part in parts.items()}
    name, share = max(shares.items(), key=lambda entry: entry[1])
    axis = int(np.argmax(np.abs(direction)))
    along = (
        f"mainly {'xyz'[axis]}"
        if abs(direction[axis]) > np.sqrt(0.75)  # within 30 degrees
        else "in " + "xyz"[_plane(direction)[0]] + "-" + "xyz"[_plane(direction)[1]]
    )
    return f"{name} {round(100 * share / sum(shares.values()))} %, motion {along}"


def _plane(direction: Floats) -> tuple[int, int]:
    first, second = sorted(np.argsort(np.abs(direction))[1:])
    return int(first), int(second)


def _parts(bodies: Bodies, rest: Poses, shape: Floats, most: int, place: Floats) -> dict[str, Floats]:
    """Return what each joint and link adds to the motion of a place, eq. (1)."""
    skeleton, arm = bodies.skeleton, bodies.arm

    def carried(bone: int | None) -> Floats:
        if bone is None or bone < 0:
            return np.zeros(3)
        away = place - rest.x[0, bone]
        return np.asarray(shape[bone, :3] + np.cross(shape[bone, 3:], away))

    found: dict[str, Floats] = {}
    link, after = link_of(skeleton.bones[most].link), most
    while link != "base":
        joint = next(j for j in arm.joints if link_of(j.child) == link)
        into = skeleton.bone_of(joint.child)
        before, _, _ = bodies.place(joint)
        found[f"bending of {link}"] = carried(after) - carried(into)
        found[f"joint {joint.name}"] = carried(into) - carried(before)
        link, after = link_of(joint.parent), before
    return found
