"""`flexarm reduce`: a mesh reduced and drawn, or matrices that another program reduced accepted."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.cli.options import blame, warn
from flexarm.errors import InvalidFile
from flexarm.tables.table import check_name

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
    from flexarm.solids.checks import refuse_implausible

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
    file: Path, solid: SolidMesh, interface: list[str] | None, json: bool, **options: Any
) -> SuperElement:
    """Return the part reduced to its interfaces, with options of `reduce_mesh`."""
    from flexarm.cli.progress import progress
    from flexarm.reduction import reduce_mesh

    pairs = read_interfaces(interface, _FORM)
    if not pairs:
        known = ", ".join(solid.point_sets) or "none"
        what = f"is needed, NAME=SET; the mesh has the sets {known}"
        raise InvalidFile("command line", "--interface", what)
    with blame(file), progress(json) as tell:
        return reduce_mesh(
            solid, pairs, name=file.stem, progress=lambda phase, done: tell(done, phase), **options
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


def read_interfaces(interface: list[str] | None, form: str) -> dict[str, str]:
    """Return WHAT by NAME of every --interface NAME=WHAT.

    Raise InvalidFile if one is not of the form, has a bad name, or a name stands twice.
    """
    pairs: dict[str, str] = {}
    for text in interface or ():
        name, equals, what = (part.strip() for part in text.partition("="))
        if not equals or not name or not what:
            raise InvalidFile("command line", "--interface", f"must be {form}, got {text!r}")
        try:
            check_name(name)
        except ValueError as error:
            raise InvalidFile("command line", "--interface", f"{name!r}: {error}") from None
        if name in pairs:
            raise InvalidFile("command line", "--interface", f"{name!r} is given twice")
        pairs[name] = what
    return pairs


MATRIX_SUFFIXES = (".mtx", ".op4", ".pch", ".dmig", ".sti", ".mas")


def refuse_for_matrices(
    file: Path,
    grids: Path | None,
    modes: int | None,
    max_frequency: float | None,
    material: list[str] | None,
    picture: Path | None,
    damping_ratio: float,
    recovery: bool,
) -> None:
    """Refuse options that are for meshes only, and matrices whose points nobody states."""
    if grids is None:
        what = "is needed: a matrix holds no coordinates; name the bulk data or input deck with its points"
        raise InvalidFile(file, "--grids", what)
    given = {
        "--modes": modes is not None,
        "--max-frequency": max_frequency is not None,
        "--material": bool(material),
        "--picture": picture is not None,
        "--damping-ratio": damping_ratio != 0,
        "--recovery": recovery,
    }
    for option in (option for option, there in given.items() if there):
        raise InvalidFile(
            "command line", option, "is for meshes; with --grids the matrices are reduced already"
        )


def accepted(file: Path, interface: list[str] | None, **options: Any) -> SuperElement:
    """Return the matrices as a super-element, with options of `accept_matrices`."""
    from flexarm.superelement.foreign import accept_matrices

    form = "NAME=POINT or NAME=POINT,POINT,... with --grids"
    named: dict[str, list[int]] = {}
    for name, points in read_interfaces(interface, form).items():
        try:
            named[name] = [int(point) for point in points.removesuffix(":rigid").split(",")]
        except ValueError:
            raise InvalidFile("command line", "--interface", f"must be {form}, got {name}={points}") from None
    with blame(file):
        return accept_matrices(file, interfaces=named, **options)
