"""The solid hinge: three groups, each meshed, reduced to a super-element and written to its file.

Each mesh is one profile that revolves about the hinge axis. Profiles are drawn in (r, s), s along the axis
from the arm's plane, and turned so that s is the arm's y and the mesh's second axis its z. All three keep the
arm's axes at q = 0, with the origin on the hinge axis.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import atan2
from pathlib import Path
from time import perf_counter

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Ints
from flexarm.errors import InvalidParameter
from flexarm.mockup.arms import hinge_tables
from flexarm.mockup.design import PARTS, TUBE_RADIUS, HingeDesign
from flexarm.reduction import InterfaceSet, reduce_mesh
from flexarm.solids import Block, Patch, SolidMesh, revolved
from flexarm.statics import static
from flexarm.superelement import SuperElement

Progress = Callable[[str], None]


@dataclass(frozen=True)
class SolidHinge:
    """The reduced hinge."""

    design: HingeDesign
    folder: Path
    """Where the files `housing.nc`, `reducer.nc` and `hub.nc` are."""
    parts: Mapping[str, SuperElement]
    """The three groups, each in the arm's axes at q = 0 with the origin on the hinge axis."""
    meshes: Mapping[str, SolidMesh]
    """What they were reduced from."""
    seconds: Mapping[str, float] = field(default_factory=dict)
    """What each part took, from mesh to file [s]."""

    def file(self, part: str) -> Path:
        """Return the path of a part's super-element."""
        return self.folder / f"{part}.nc"

    def with_compliance(self, factors: Mapping[str, float], folder: Path) -> SolidHinge:
        """Return the hinge with parts whose compliance is multiplied, its files in a folder.

        Damping goes with the stiffness; a factor of a thousandth makes a part as good as rigid.

        Raise InvalidParameter if there is no such part, or a factor is not positive.
        """
        for name, factor in factors.items():
            if name not in self.parts:
                what = f"must be one of {', '.join(self.parts)}, got {name!r}"
                raise InvalidParameter(what, where="factors")
            if not factor > 0:
                raise InvalidParameter(f"must be positive, got {factor:g}", where=f"factor of {name}")
        folder.mkdir(parents=True, exist_ok=True)
        parts = {name: _scaled(part, 1 / factors.get(name, 1.0)) for name, part in self.parts.items()}
        for name, part in parts.items():
            part.save(folder / f"{name}.nc", force=True)
        return replace(self, folder=folder, parts=parts)

    @cached_property
    def stiffness(self) -> float:
        """Equivalent torsional stiffness about the hinge axis [N m/rad], the motor's shaft held.

        A torque on the tube's seat over the turn of that seat relative to the base, in equilibrium.
        """
        return torsional_stiffness(self)


def build_hinge(
    folder: str | Path,
    design: HingeDesign | None = None,
    *,
    force: bool = False,
    progress: Progress | None = None,
) -> SolidHinge:
    """Mesh the hinge, reduce its three groups and write their super-elements into a folder.

    The default design ships with flexarm; `progress` hears the name of the part at work. Raise InvalidFile if
    a file exists and `force` is not given, or cannot be written.

    >>> hinge = build_hinge("hinge")  # doctest: +SKIP
    >>> hinge.stiffness, hinge.seconds  # doctest: +SKIP
    """
    chosen = design or HingeDesign.from_toml()
    into = Path(folder)
    into.mkdir(parents=True, exist_ok=True)
    parts: dict[str, SuperElement] = {}
    meshes: dict[str, SolidMesh] = {}
    seconds: dict[str, float] = {}
    for name in PARTS:
        if progress:
            progress(name)
        began = perf_counter()
        meshes[name], parts[name] = reduced_part(name, chosen)
        parts[name].save(into / f"{name}.nc", force)
        seconds[name] = perf_counter() - began
    return SolidHinge(chosen, into, parts, meshes, seconds)


def reduced_part(name: str, design: HingeDesign) -> tuple[SolidMesh, SuperElement]:
    """Return the mesh and super-element of one group."""
    meshed = MESHERS[name](design)
    element = reduce_mesh(
        meshed.mesh,
        {key: InterfaceSet(key, position=place) for key, place in meshed.interfaces.items()},
        modes=getattr(design.modes, name),
        recovery=True,
        name=name,
    )
    damping = getattr(design.damping_time, name) * element.stiffness
    return meshed.mesh, element.replace(damping=damping)


def _scaled(part: SuperElement, factor: float) -> SuperElement:
    """Scale the stiffness by a factor: the fixed-interface modes keep their shapes."""
    return part.replace(
        stiffness=factor * part.stiffness,
        damping=factor * part.damping,
        frequency_hz=factor**0.5 * part.frequency_hz,
    )


def torsional_stiffness(hinge: SolidHinge) -> float:
    """Return the equivalent torsional stiffness of the solid hinge [N m/rad].

        k = T/beta                                                                                       (1)

    T: torque about the hinge axis on the seat of the tube, as two opposite forces, without gravity. beta:
    turn of that seat relative to the base about the same axis, the motor's shaft held. It is the stiffness
    that a spring between a rigid housing and a rigid hub would need.
    """
    half_arm = 0.1  # the two forces act at this distance to both sides of the seat [m]
    torque = 100.0  # T of (1) [N m]; small enough for a linear answer
    tables = hinge_tables(hinge)
    seats = {"ahead": half_arm, "behind": -half_arm}
    arm = Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "name": "hinge",
            "gravity": [0.0, 0.0, 0.0],
            **tables,
            "points": [
                {"name": name, "link": "hub:output", "position": [x, 0.0, 0.0]} for name, x in seats.items()
            ],
        }
    )
    force = torque / (2 * half_arm)
    # About +y a torque turns z towards x: down ahead (x > 0), up behind.
    found = static(arm, forces={"ahead": [0, 0, -force], "behind": [0, 0, force]})
    axes = found.rotation[0]
    return torque / atan2(axes[0, 2], axes[2, 2])  # eq. (1)


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
