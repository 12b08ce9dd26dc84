"""Meshes of the hinge's three groups, each one profile that revolves about the hinge axis.

Profiles are drawn in (r, s), s along the axis from the arm's plane, and turned so that s is the arm's y and
the mesh's second axis its z. All three keep the arm's axes at q = 0, with the origin on the hinge axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Ints
from flexarm.mockup.design import TUBE_RADIUS, HingeDesign
from flexarm.solids import Block, Patch, SolidMesh, revolved

TURN = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
"""Columns: where the mesher's x, y, z point in the arm's axes."""


@dataclass(frozen=True)
class MeshedPart:
    """A mesh, and the place of each interface on it: set of points and position in the arm's axes [m]."""

    mesh: SolidMesh
    interfaces: dict[str, tuple[float, float, float]]


def housing(design: HingeDesign) -> MeshedPart:
    """Return the fixed housing with base flange: interfaces `base`, `motor`, `seat`."""
    size, foot, front = design.housing, design.base_place, design.seat_place
    inner, ring = design.inner_radius, front - size.seat_width
    middle = foot + size.web_offset
    top, bottom = middle + size.web_thickness / 2, middle - size.web_thickness / 2
    blocks = [
        Block("flange", inner, size.flange_radius, foot, foot + size.flange_thickness),
        Block("shell", inner, size.radius, foot + size.flange_thickness, ring),
        Block("web", size.bearing_radius, inner, bottom, top),
        Block("ring", min(design.reducer.body_radius, inner), size.radius, ring, front),
    ]
    patches = [
        Patch("base", size.radius, size.flange_radius, foot, foot),
        Patch("motor", size.bearing_radius, size.bearing_radius, bottom, top),
        Patch("seat", design.reducer.body_radius, design.reducer.body_radius, ring, front),
    ]
    places = {"base": foot, "motor": middle, "seat": front - size.seat_width / 2}
    return MeshedPart(_turned(design, blocks, patches), {name: (0, y, 0) for name, y in places.items()})


def reducer(design: HingeDesign) -> MeshedPart:
    """Return body, output shaft and flange: interfaces `input` in the housing's seat, `output` at the hub."""
    size, root, end = design.reducer, design.seat_place, design.output_place
    back, middle = root - size.body_thickness, root - design.housing.seat_width / 2
    blocks = [
        Block("body", 0.0, size.body_radius, back, root),
        Block("shaft", 0.0, size.shaft_diameter / 2, root, end - size.flange_thickness),
        Block("flange", 0.0, size.flange_radius, end - size.flange_thickness, end),
    ]
    patches = [
        Patch("input", size.body_radius, size.body_radius, back, root),
        Patch("output", design.hub.bore, size.flange_radius, end, end),
    ]
    return MeshedPart(
        _turned(design, blocks, patches), {"input": (0, middle, 0), "output": (0, design.output_place, 0)}
    )


def hub(design: HingeDesign) -> MeshedPart:
    """Return bell and arm flange: interfaces `input` on the axis, `output` where the tube is welded on."""
    size, foot = design.hub, design.output_place
    half = size.flange_width / 2
    blocks = [
        Block("disc", size.bore, size.radius, foot, foot + size.disc_thickness),
        Block("bell", design.bell_radius, size.radius, foot - size.length, foot),
        Block("flange", size.radius, size.flange_radius, -half, half),
    ]
    patches = [
        Patch("input", size.bore, design.reducer.flange_radius, foot, foot),
        Patch("band", size.flange_radius, size.flange_radius, -TUBE_RADIUS, TUBE_RADIUS),  # sides of the pad
    ]
    mesh = _turned(design, blocks, patches)
    return MeshedPart(
        mesh.with_point_set("output", _pad(mesh, size.flange_radius)),
        {"input": (0, foot, 0), "output": (0, 0, size.flange_radius)},
    )


MESHERS = {"housing": housing, "reducer": reducer, "hub": hub}
"""Function of each part of `flexarm.mockup.design.PARTS`."""


def _turned(design: HingeDesign, blocks: list[Block], patches: list[Patch]) -> SolidMesh:
    mesh = revolved(
        blocks, size=design.mesh.size, around=design.mesh.around, patches=patches, material=design.steel
    )
    return mesh.moved(TURN)


def _pad(mesh: SolidMesh, radius: float) -> Ints:
    """Return the points of the arm flange under the tube's end, on the arm's +z side.

    The pad is as wide as the tube along the axis and an eighth of the circle around it, the same on any mesh.
    """
    x, y, z = mesh.points.T
    room = 1e-6 * radius
    outside = np.abs(np.hypot(x, z) - radius) < room
    under = (np.abs(y) < TUBE_RADIUS + room) & (np.abs(np.arctan2(x, z)) < np.pi / 8 + 1e-6)
    return np.flatnonzero(outside & under)
