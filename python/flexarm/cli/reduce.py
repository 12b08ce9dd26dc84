"""`flexarm reduce`: a solid part, or another program's matrices, as a super-element."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexarm.cli.options import Json, blame, print_json, show_progress, warn
from flexarm.errors import InvalidFile, Problem

if TYPE_CHECKING:
    from flexarm.solids import SolidMesh
    from flexarm.superelement import SuperElement

Mesh = Annotated[
    Path,
    typer.Argument(
        metavar="MESH", help="Mesh (.inp, .msh, .vtu, .bdf), or stiffness (.mtx, .op4, .pch, .sti)."
    ),
]
Interfaces = Annotated[
    list[str] | None,
    typer.Option(
        "--interface",
        metavar="NAME=SET[:rigid|average]",
        help="Where the part is joined; repeat it. With --grids NAME=POINT or NAME=POINT,POINT,...",
    ),
]
Out = Annotated[Path, typer.Option("--out", metavar="FILE.nc", help="The super-element file.")]
Modes = Annotated[
    int | None, typer.Option("--modes", metavar="N", help="Internal modes; default 20, 0: Guyan.")
]
MaxFrequency = Annotated[
    float | None, typer.Option("--max-frequency", metavar="HZ", help="Instead: all modes up to this one.")
]
Unit = Annotated[
    str, typer.Option("--unit", metavar="UNIT", help="Length in the file; mm: mm, t, s, N, MPa.")
]
Materials = Annotated[
    list[str] | None,
    typer.Option(
        "--material",
        metavar="[GROUP:]E=..,nu=..,rho=..",
        help="For cells without one, or for a group. In SI, with --unit mm in MPa and t/mm3; or E=210GPa.",
    ),
]
Mass = Annotated[
    float | None,
    typer.Option("--mass", metavar="KG", help="What the part weighs; it is refused if it does not."),
]
Damping = Annotated[
    float, typer.Option("--damping-ratio", metavar="R", help="Of the free part's first elastic mode.")
]
Recovery = Annotated[
    bool, typer.Option("--recovery", help="Keep what displacements and stress in the mesh need (large).")
]
Lumped = Annotated[bool, typer.Option("--lumped", help="Lumped instead of consistent masses.")]
Merge = Annotated[
    float, typer.Option("--merge", min=0, metavar="M", help="Make mesh points closer than this one [m].")
]
Picture = Annotated[
    Path | None, typer.Option("--picture", metavar="FILE.png", help="Draw part and interfaces.")
]
Grids = Annotated[
    Path | None,
    typer.Option("--grids", metavar="FILE", help="Points of foreign matrices: bulk data or input deck."),
]
Order = Annotated[
    str | None,
    typer.Option("--order", metavar="LIST|FILE", help="Freedoms of their rows: '11, 12, 101-104.0'."),
]
MassMatrix = Annotated[
    str | None,
    typer.Option("--mass-matrix", metavar="FILE[:NAME]", help="Where it is not with the stiffness."),
]
DampingMatrix = Annotated[
    str | None, typer.Option("--damping-matrix", metavar="FILE[:NAME]", help="The same for damping.")
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        "--tolerance", metavar="T", help="Relative error of their numbers; default 1e-5 (six digits)."
    ),
]
Force = Annotated[bool, typer.Option("--force", help="Replace files that exist.")]


def reduce(
    mesh: Mesh,
    out: Out,
    interface: Interfaces = None,
    modes: Modes = None,
    max_frequency: MaxFrequency = None,
    unit: Unit = "m",
    material: Materials = None,
    mass: Mass = None,
    damping_ratio: Damping = 0.0,
    recovery: Recovery = False,
    lumped: Lumped = False,
    merge: Merge = 0.0,
    picture: Picture = None,
    grids: Grids = None,
    order: Order = None,
    mass_matrix: MassMatrix = None,
    damping_matrix: DampingMatrix = None,
    tolerance: Tolerance = None,
    force: Force = False,
    json: Json = False,
) -> None:
    r"""A solid part as a super-element.

    The part is reduced to the interfaces where it is joined, six freedoms each, and its internal modes with
    these held (Craig-Bampton). A model takes it as a link: type = "superelement", file = "hub.nc".

    A mesh has named sets of points. An interface's set follows its frame (rigid: bolted to something stiffer)
    or the frame follows the set on average (bolted to something softer):

        flexarm reduce hub.inp --unit mm --interface input=BORE --interface output=FLANGE:average \
            --modes 20 --out hub.nc
        flexarm reduce ring.msh --material E=210e9,nu=0.3,rho=7850 --interface in=A --interface out=B \
            --max-frequency 2000 --mass 14.2 --picture ring.png --out ring.nc

    Reduced matrices of other programs hold no coordinates, order or unit; state them, and a wrong statement
    is refused, since rigid motion would then meet forces:

        flexarm reduce hub.pch --grids hub.bdf --unit mm --mass 8.3 --interface input=11 --out hub.nc
        flexarm reduce K.mtx --mass-matrix M.mtx --grids hub.bdf --order '11, 12, 101-120.0' --out hub.nc

    `flexarm check hub.nc` describes the file.
    """
    _refuse_existing(out, force)
    if picture is not None:
        _refuse_existing(picture, force)
    if grids is not None or mesh.suffix.lower() in MATRIX_SUFFIXES:
        _refuse_for_matrices(mesh, grids, modes, max_frequency, material, picture, damping_ratio, recovery)
        element = _foreign(mesh, grids, interface, order, mass_matrix, damping_matrix, unit, mass, tolerance)
    else:
        _refuse_for_meshes(order, mass_matrix, damping_matrix, tolerance)
        solid = _mesh(mesh, unit, material, merge)
        element = _reduced(
            mesh, solid, interface, modes, max_frequency, damping_ratio, lumped, mass, recovery
        )
        if picture is not None:
            _draw(solid, element, interface, picture, force)
    element.save(out, force)
    warn(out, element.check(tolerance=tolerance))
    if json:
        print_json({"file": str(out), **element.to_json_dict()})
    else:
        print(f"{element.summary()}\nwritten to {out}")


MATRIX_SUFFIXES = (".mtx", ".op4", ".pch", ".dmig", ".sti", ".mas")


def _refuse_existing(path: Path, force: bool) -> None:
    """Before the work is done rather than after it."""
    if path.is_dir() or not path.resolve().parent.is_dir():
        raise InvalidFile(path, "output", "must be a file in a directory that exists")
    if path.exists() and not force:
        raise InvalidFile(path, "output", "exists already; allowed is a new file, or --force")


def _refuse_for_matrices(
    file: Path,
    grids: Path | None,
    modes: int | None,
    max_frequency: float | None,
    material: list[str] | None,
    picture: Path | None,
    damping_ratio: float,
    recovery: bool,
) -> None:
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


def _refuse_for_meshes(*given: object) -> None:
    names = ("--order", "--mass-matrix", "--damping-matrix", "--tolerance")
    for option in (name for name, value in zip(names, given, strict=True) if value is not None):
        raise InvalidFile("command line", option, "is for matrices of other programs, which need --grids")


def _pairs(interface: list[str] | None, form: str) -> dict[str, str]:
    """NAME=WHAT of every --interface."""
    from flexarm.tables.table import check_name

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


def _foreign(
    file: Path,
    grids: Path | None,
    interface: list[str] | None,
    order: str | None,
    mass_matrix: str | None,
    damping_matrix: str | None,
    unit: str,
    mass: float | None,
    tolerance: float | None,
) -> SuperElement:
    from flexarm.superelement.foreign import accept_matrices

    assert grids is not None
    form = "NAME=POINT or NAME=POINT,POINT,... with --grids"
    named: dict[str, list[int]] = {}
    for name, points in _pairs(interface, form).items():
        try:
            named[name] = [int(point) for point in points.removesuffix(":rigid").split(",")]
        except ValueError:
            raise InvalidFile("command line", "--interface", f"must be {form}, got {name}={points}") from None
    with blame(file):
        return accept_matrices(
            file,
            mass_matrix,
            grids=grids,
            order=order,
            damping_matrix=damping_matrix,
            interfaces=named,
            unit=unit,
            mass=mass,
            tolerance=tolerance,
        )


def _mesh(file: Path, unit: str, material: list[str] | None, merge: float) -> SolidMesh:
    from flexarm.cli.materials import read_materials
    from flexarm.solids import read_mesh

    materials, notes = read_materials(material or (), unit)
    warn(Path("command line"), notes)
    groups = {group: value for group, value in materials.items() if group}
    solid = read_mesh(file, unit, groups, merge=merge)
    if "" in materials:
        solid = solid.with_materials(materials[""])
    solid.check()
    warn(file, solid.warnings)
    return solid


def _reduced(
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
    from flexarm.cli.phases import phases
    from flexarm.reduction import reduce_mesh

    pairs = _pairs(interface, "NAME=SET[:rigid|average]")
    if not pairs:
        known = ", ".join(solid.point_sets) or "none"
        raise InvalidFile(
            "command line", "--interface", f"is needed, NAME=SET; the mesh has the sets {known}"
        )
    with blame(file), phases(show_progress()) as progress:
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
            progress=progress,
        )


def _draw(
    solid: SolidMesh, element: SuperElement, interface: list[str] | None, path: Path, force: bool
) -> None:
    from flexarm.reduction import InterfaceSet
    from flexarm.superelement.picture import picture, save_picture

    texts = _pairs(interface, "NAME=SET[:rigid|average]")
    sets: dict[str, Any] = {
        name: solid.point_set(str(InterfaceSet.from_text(text).points)) for name, text in texts.items()
    }
    frames = {name: element.interface(name) for name in element.interfaces}
    title = f"{element.name}: {element.mass_total:.5g} kg, {solid.n_dof} degrees of freedom"
    save_picture(picture(solid, sets, frames, title), path, force)


def describe(path: Path) -> tuple[dict[str, Any], list[str], list[Problem]]:
    """A super-element file, for `flexarm check`."""
    from flexarm.superelement import SuperElement

    element = SuperElement.load(path)
    return {"kind": "superelement", **element.to_json_dict()}, [element.summary()], element.check()
