"""The solid hinge: three groups, each meshed, reduced to a super-element and written to its file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import atan2
from pathlib import Path
from time import perf_counter

from flexarm.arm import Arm
from flexarm.errors import InvalidParameter
from flexarm.mockup.arms import hinge_tables
from flexarm.mockup.design import PARTS, HingeDesign
from flexarm.mockup.meshes import MESHERS
from flexarm.reduction import InterfaceSet, reduce_mesh
from flexarm.solids import SolidMesh
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
