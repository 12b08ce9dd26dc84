r"""The mock-up as surfaces, undeformed and deformed, for Figure 6.

Points of a solid part at p in the arm's axes at q = 0 stand, undeformed, at

    X = T(q) p,    T: turn about the hinge axis for the hub, none for housing and reducer              (1)

and, in the equilibrium at the same drive angle, at

    x = x_P + R_P (p + u),    u = Φ v                                                                 (2)

R_P, x_P: the part's frame, Φ: recovery matrix of the super-element, v: its freedoms. The tube is a ring of
points around its axis, each ring moved with its cross-section. u_tot = x - X is what colours show.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.mockup.design import TUBE_RADIUS
from flexarm.reproduction.variants import Models, tube_of
from flexarm.solids import SolidMesh
from flexarm.solids.shape import surface
from flexarm.statics import Statics, static

RINGS, AROUND = 25, 24
"""Cross-sections of the tube and points on each."""


@dataclass(frozen=True)
class Surface:
    """Faces of one part."""

    name: str
    rigid: Floats
    moved: Floats
    """Points of the undeformed and of the deformed arm at the same drive angle, base axes [m], shape (n,
    3)."""
    faces: tuple[tuple[int, ...], ...]
    """Points of each face."""
    opened_faces: tuple[tuple[int, ...], ...] = ()
    """The same with the half x < 0 of the part cut away."""

    @property
    def displacement(self) -> Floats:
        """Length of x - X at each point [m]."""
        found: Floats = np.linalg.norm(self.moved - self.rigid, axis=1)
        return found

    def opened(self) -> Surface:
        """Cut the part open."""
        return replace(self, faces=self.opened_faces)

    def drawn(self, scale: float) -> Floats:
        """Return the points with displacements multiplied."""
        return np.asarray(self.rigid + scale * (self.moved - self.rigid))


def scene(models: Models, angle: float) -> list[Surface]:
    """Return all surfaces in the equilibrium at a drive angle [rad], the base's side first."""
    arm, places = _with_rings(models)
    found = static(arm, joints={"hinge": angle})
    about = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    parts = [_part(models, found, name, about if name == "hub" else np.eye(3)) for name in models.hinge.parts]
    return [*parts, _tube(found, places, about), _load(found, float(places[-1]), about)]


def _part(models: Models, found: Statics, name: str, turn: Floats) -> Surface:
    mesh, part = models.hinge.meshes[name], models.hinge.parts[name]
    shape = found.parts[name]
    moved = shape.position + (mesh.points + part.recover(shape.freedoms)) @ shape.rotation.T  # eq. (2)
    rigid = mesh.points @ turn.T  # eq. (1)
    behind = {kind: nodes[rigid[nodes, 0].mean(axis=1) > 0] for kind, nodes in mesh.cells.items()}
    half = SolidMesh(points=mesh.points, cells=behind)
    return Surface(name, rigid, moved, tuple(surface(mesh)), tuple(surface(half)))


def _with_rings(models: Models) -> tuple[Arm, Floats]:
    """Return the model with a point at each ring, and their distances from the hinge axis [m]."""
    start = models.hinge.design.hub.flange_radius
    tip = models.fe.point("tip")
    places = np.linspace(start, start + tip.position[2], RINGS)
    points = tuple(
        tip.replace(name=f"ring-{i}", position=(0.0, 0.0, float(place - start)))
        for i, place in enumerate(places)
    )
    finer = tube_of(models.fe).replace(elements=RINGS - 1)
    links = tuple(finer if link.name == "tube" else link for link in models.fe.links)
    return models.fe.replace(points=points, links=links), places


def _tube(found: Statics, places: Floats, turn: Floats) -> Surface:
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    ring = TUBE_RADIUS * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    axis = np.column_stack([0 * places, 0 * places, places])
    rigid = (axis[:, None] + ring) @ turn.T
    moved = found.position[:, None] + ring @ np.swapaxes(found.rotation, 1, 2)
    faces = [
        (i * AROUND + k, i * AROUND + n, (i + 1) * AROUND + n, (i + 1) * AROUND + k)
        for i in range(len(places) - 1)
        for k, n in ((k, (k + 1) % AROUND) for k in range(AROUND))
    ]
    return Surface("tube", rigid.reshape(-1, 3), moved.reshape(-1, 3), tuple(faces))


def _load(found: Statics, length: float, turn: Floats) -> Surface:
    """Return a cube that moves with the tube's end."""
    load_edge = 0.12  # edge of the cube that stands for the load, 14.1 kg of steel [m]
    corners = (
        load_edge
        / 2
        * np.array([[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    )
    sides = tuple((k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4) for k in range(4))
    rigid = (np.array([0, 0, length]) + corners) @ turn.T
    moved = found.position[-1] + corners @ found.rotation[-1].T
    return Surface("load", rigid, moved, ((3, 2, 1, 0), (4, 5, 6, 7), *sides))
