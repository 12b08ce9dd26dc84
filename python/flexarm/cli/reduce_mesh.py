"""`flexarm reduce MESH`: the part as a solid mesh, its reduction and its picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.cli.interfaces import read_interfaces
from flexarm.cli.options import blame, warn
from flexarm.errors import InvalidFile

if TYPE_CHECKING:
    from flexarm.solids import SolidMesh
    from flexarm.superelement import SuperElement

_FORM = "NAME=SET[:rigid|average]"


def refuse_for_meshes(*given: object) -> None:
    """Refuse options that are for matrices only."""
    names = ("--order", "--mass-matrix", "--damping-matrix", "--tolerance")
    for option in (name for name, value in zip(names, given, strict=True) if value is not None):
        raise InvalidFile("command line", option, "is for matrices of other programs, which need --grids")


def solid_part(
    file: Path, unit: str, material: list[str] | None, merge: float, mass: float | None
) -> SolidMesh:
    """Return the mesh with its materials, checked; a stated mass vouches for its size."""
    from flexarm.cli.materials import read_materials
    from flexarm.solids import read_mesh
    from flexarm.solids.plausibility import refuse_implausible

    materials, notes = read_materials(material or (), unit)
    warn(Path("command line"), notes)
    groups = {group: value for group, value in materials.items() if group}
    solid = read_mesh(file, unit, groups, merge=merge)
    if "" in materials:
        solid = solid.with_materials(materials[""])
    solid.check()
    if mass is None:
        refuse_implausible(solid)
    warn(file, solid.warnings)
    return solid


def reduced(
    file: Path,
    solid: SolidMesh,
    interface: list[str] | None,
    modes: int | None,
    max_frequency: float | None,
    damping_ratio: float,
    lumped: bool,
    mass: float | None,
    recovery: bool,
) -> SuperElement:
    """Return the part reduced to its interfaces."""
    from flexarm.cli.progress import progress
    from flexarm.reduction import reduce_mesh

    pairs = read_interfaces(interface, _FORM)
    if not pairs:
        known = ", ".join(solid.point_sets) or "none"
        raise InvalidFile(
            "command line", "--interface", f"is needed, NAME=SET; the mesh has the sets {known}"
        )
    with blame(file), progress() as tell:
        return reduce_mesh(
            solid,
            pairs,
            modes=modes,
            max_frequency=max_frequency,
            damping_ratio=damping_ratio,
            lumped=lumped,
            mass=mass,
            recovery=recovery,
            name=file.stem,
            progress=lambda phase, done: tell(done, phase),
        )


def draw(solid: SolidMesh, element: SuperElement, interface: list[str] | None, path: Path) -> None:
    """Draw part and interfaces."""
    from flexarm.reduction import InterfaceSet
    from flexarm.superelement.picture import picture, save_picture

    texts = read_interfaces(interface, _FORM)
    sets: dict[str, Any] = {
        name: solid.point_set(str(InterfaceSet.from_text(text).points)) for name, text in texts.items()
    }
    frames = {name: element.interface(name) for name in element.interfaces}
    title = f"{element.name}: {element.mass_total:.5g} kg, {solid.n_dof} degrees of freedom"
    save_picture(picture(solid, sets, frames, title), path)
