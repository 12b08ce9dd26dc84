"""The skins of an arm: links, joints with their axes, payloads, points, frames, base and gravity."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from flexarm.arm import Arm, Beam, Closure
from flexarm.arm.joint import Joint
from flexarm.arm.link import Link, SuperElementLink
from flexarm.arm.names import link_of
from flexarm.arm.rotation import from_rpy
from flexarm.arrays import Floats
from flexarm.assembly import machine_of
from flexarm.superelement import SuperElement
from flexarm.viewer.scene import STYLE, Label, Layer
from flexarm.viewer.skeleton import Skeleton
from flexarm.viewer.solids import Skin, Surface, arrow, ball, beam_skin, box, half_widths, hung, joined, rod
from flexarm.wording import number

LAYERS = {
    "beams": Layer("beams", STYLE.beam, "beams, with their sections"),
    "rigid links": Layer("rigid links", STYLE.body, "rigid links"),
    "super-elements": Layer(
        "super-elements", STYLE.part, "super-elements; meshes go evenly from interface to interface"
    ),
    "joints": Layer("joints", STYLE.axis, "joints and their axes"),
    "payloads": Layer("payloads", STYLE.payload, "payloads, as steel balls of their mass"),
    "points": Layer("points", STYLE.points, "points that sensors see"),
    "gravity": Layer("gravity", STYLE.gravity, "gravity"),
    "frames": Layer("frames", STYLE.axes[0], "frames: x red, y green, z blue", shown=False),
    "base": Layer("base", STYLE.base, "base"),
}
"""In the order of the legend."""
Meshes = dict[str, Surface]
"""Surfaces in the frame of their link or part, by the link's name; "base" stands on the ground."""


class Bodies:
    """Bones of an arm with meshes of links; joints and points are drawn by the size of the whole [m]."""

    def __init__(self, skeleton: Skeleton, size: float, meshes: Meshes | None = None) -> None:
        self.arm: Arm = skeleton.arm
        self.skeleton, self.size, self.meshes = skeleton, size, meshes or {}

    def skins(self) -> list[Skin]:
        """Return all of them."""
        found: list[Skin] = []
        for link in self.arm.links:
            found += self._link(link)
        for joint in self.arm.joints:
            found += self._joint(joint)
        for closure in self.arm.closures:
            found += self._closure(closure)
        return [*found, *self._payloads(), *self._points(), *self._base()]

    def links(self) -> list[Skin]:
        """Return those of links and payloads alone, for a second arm beside the first."""
        return [skin for skin in self.skins() if skin.layer in OF_LINKS]

    def labels(self) -> list[Label]:
        """Return the names of joints, payloads and points."""
        found = []
        for joint in self.arm.joints:
            bone, _, position = self.place(joint)
            if joint.moves:
                x, y, z = map(float, position)
                found.append(Label("joints", joint.name, bone, (x, y, z)))
        for name, what in machine_of(self.arm).payloads.items():
            found.append(Label("payloads", f"{name} {number(what.mass)} kg", self.skeleton.loads[name]))
        found += [Label("points", name, bone) for name, bone in self.skeleton.points.items()]
        return found

    def place(self, joint: Joint) -> tuple[int, Floats, Floats]:
        """Return the bone before a joint, and the joint's frame in it: rotation and position [m]."""
        bone = self.skeleton.bone_of(joint.parent, joint.at == "end")
        return bone, np.array(from_rpy(joint.origin.rpy)), np.array(joint.origin.xyz, dtype=float)

    def _link(self, link: Link) -> Iterator[Skin]:
        bones = self.skeleton.along[link.name]
        if isinstance(link, Beam):
            yield beam_skin(link, bones, STYLE.beam)
            yield from self._triad(bones[0], link.name)
        elif isinstance(link, SuperElementLink):
            yield from part_skins(link.name, link.part, bones, self.size, self.meshes.get(link.name))
            for bone in bones:
                yield from self._triad(bone, f"{link.name} {bone}")
        else:
            body = self.meshes.get(link.name) or self._sticks(link)
            skin = body.on(bones[0], "rigid links", link.name, STYLE.body)
            yield replace(skin, flat=link.name in self.meshes)
            yield from self._triad(bones[0], link.name)

    def outriggers(self, beams: Iterable[str]) -> Iterator[Skin]:
        """Return a bar on every bone of beams, for a tube that twists looks as it did.

        It lies between the axes across, so that its length changes in a picture from either side.
        """
        for link in (link for link in self.arm.links if isinstance(link, Beam) and link.name in set(beams)):
            axis, half = np.array(link.end) / link.length, STYLE.frame * self.size
            normal = _across(axis)[0]
            end = half * (normal + np.cross(axis, normal))
            bar = rod(-end, end, 0.4 * STYLE.stick * self.size)
            for bone in self.skeleton.along[link.name]:
                yield bar.on(bone, "beams", f"{link.name} outrigger {bone}", STYLE.beam)

    def _sticks(self, link: Link) -> Surface:
        """Return a rigid link as sticks from its frame to what it carries, and a ball where all is there."""
        carried = [self.place(j)[2] for j in self.arm.joints if link_of(j.parent) == link.name]
        for closure in self.arm.closures:
            ends = ((closure.a, closure.a_origin), (closure.b, closure.b_origin))
            carried += [np.array(origin.xyz) for place, origin in ends if place == link.name]
        for bone in (*self.skeleton.loads.values(), *self.skeleton.points.values()):
            at = self.skeleton.bones[bone]
            if link_of(at.link) == link.name:
                carried.append(np.array(at.position))
        if not carried:
            carried = [np.array(link.com)]  # type: ignore[union-attr]
        radius = STYLE.stick * self.size
        far = [end for end in carried if np.linalg.norm(end) > radius]
        return joined(ball(1.3 * radius), *(rod(np.zeros(3), end, radius) for end in far))

    def _joint(self, joint: Joint) -> Iterator[Skin]:
        bone, R, x = self.place(joint)
        names = {link_of(joint.parent), link_of(joint.child)}
        widths = [
            half_widths(li.section) for li in self.arm.links if isinstance(li, Beam) and li.name in names
        ]
        radius = max(STYLE.joint * self.size, 1.25 * max((max(pair) for pair in widths), default=0.0))
        if not joint.moves:
            yield (
                box(np.full(3, 1.2 * STYLE.joint * self.size))
                .moved(R, x)
                .on(bone, "joints", joint.name, STYLE.joints)
            )
            return
        axis = np.asarray(joint.axis, dtype=float)
        axis = R @ (axis / np.linalg.norm(axis))
        half = 1.3 * radius * axis
        turning = rod(x - half, x + half, radius)
        if joint.type == "prismatic":
            turning = joined(
                *(rod(x - 2 * half + o, x + 2 * half + o, 0.5 * radius) for o in radius * _across(axis))
            )
            yield self._stroke(joint)
        yield turning.on(bone, "joints", joint.name, STYLE.joints)
        tip = arrow(x - 3 * half, x + 4 * half, 0.12 * radius)
        yield tip.on(bone, "joints", f"{joint.name} axis", STYLE.axis)

    def _stroke(self, joint: Joint) -> Skin:
        """Return a rod from a sliding joint's frame to its child, as long as the stroke."""
        bone, R, x = self.place(joint)
        child = self.skeleton.bone_of(joint.child)
        axis = np.asarray(joint.axis, dtype=float)
        axis /= np.linalg.norm(axis)
        straight = rod(np.zeros(3), axis, STYLE.stick * self.size)
        far = straight.corners @ axis > 0.5
        ends = np.where(far[:, None], straight.corners - axis, straight.corners @ R.T + x)
        bones = np.where(far, child, bone)
        return Skin(
            "joints", f"{joint.name} stroke", bones[:, None], ends[:, None], straight.faces, STYLE.joints
        )

    def _closure(self, closure: Closure) -> Iterator[Skin]:
        place, at, origin = closure.a, closure.a_at, closure.a_origin
        if closure.type == "point_on_beam":
            place, at, origin = closure.b, closure.b_at, closure.b_origin
        bone = self.skeleton.bone_of(place, at == "end")
        R, x = np.array(from_rpy(origin.rpy)), np.array(origin.xyz, dtype=float)
        radius = STYLE.joint * self.size
        if not np.any(closure.axis):
            shape = ball(radius).moved(R, x)
        else:
            half = 1.3 * radius * (R @ (np.asarray(closure.axis) / np.linalg.norm(closure.axis)))
            shape = rod(x - half, x + half, radius)
        yield shape.on(bone, "joints", closure.name, STYLE.joints)

    def _payloads(self) -> Iterator[Skin]:
        for name, load in machine_of(self.arm).payloads.items():
            bone = self.skeleton.loads[name]
            radius = (3 * load.mass / (4 * np.pi * STYLE.payload_density)) ** (1 / 3)
            radius = max(radius, 0.5 * STYLE.point * self.size)
            yield ball(radius).on(bone, "payloads", name, STYLE.payload)

    def _points(self) -> Iterator[Skin]:
        for name, bone in self.skeleton.points.items():
            yield ball(STYLE.point * self.size).on(bone, "points", name, STYLE.points)

    def _base(self) -> Iterator[Skin]:
        foot = self.meshes.get("base")
        if foot is None:
            edge = 5 * STYLE.joint * self.size
            foot = rod(np.array([0, 0, -0.25 * edge]), np.array([0, 0, -0.02 * edge]), edge)
        yield foot.on(-1, "base", "base", STYLE.base)
        yield from triad(-1, STYLE.frame * self.size, "base", "base axes")
        g = np.asarray(self.arm.gravity)
        if np.any(g):
            start = gravity_at(self.size)
            end = start + STYLE.arrow * self.size * g / np.linalg.norm(g)
            down = arrow(start, end, 0.03 * STYLE.arrow * self.size)
            yield down.on(-1, "gravity", "gravity", STYLE.gravity)

    def _triad(self, bone: int, name: str) -> Iterator[Skin]:
        return triad(bone, 0.6 * STYLE.frame * self.size, "frames", name)


OF_LINKS = ("beams", "rigid links", "super-elements", "payloads")


def gravity_at(size: float) -> Floats:
    """Return where gravity's arrow starts."""
    return size * np.array([-0.15, 0.15, 0.25])


def triad(bone: int, length: float, layer: str, name: str) -> Iterator[Skin]:
    """Return a frame's axes on a bone, -1 for the base: x red, y green, z blue."""
    for k, colour in enumerate(STYLE.axes):
        end = length * np.eye(3)[k]
        yield arrow(np.zeros(3), end, 0.03 * length).on(bone, layer, f"{name} {'xyz'[k]}", colour)


def part_skins(
    name: str, part: SuperElement, bones: list[int], size: float, mesh: Surface | None
) -> Iterator[Skin]:
    """Return a super-element on its interfaces: its mesh, or sticks that meet in the middle."""
    surface = mesh
    if surface is None:
        middle = part.positions.mean(axis=0)
        radius = STYLE.stick * size
        surface = joined(
            ball(1.6 * radius).moved(np.eye(3), middle),
            *(rod(middle, p, radius) for p in part.positions if np.linalg.norm(p - middle) > radius),
        )
    skin = hung(surface, bones, part.positions, part.rotations, "super-elements", name, STYLE.part)
    yield skin if mesh is None else replace(skin, flat=True, opacity=STYLE.meshed)
    plate = 1.6 * STYLE.joint * size
    for bone, interface in zip(bones, part.interfaces, strict=True):
        where = box(np.full(3, plate))
        yield where.on(bone, "super-elements", f"{name}:{interface}", STYLE.part)


def _across(axis: Floats) -> Floats:
    """Return a direction across an axis, and its opposite."""
    least = np.eye(3)[int(np.argmin(np.abs(axis)))]
    normal = np.cross(axis, least)
    return np.asarray(np.array([normal, -normal]) / np.linalg.norm(normal))
