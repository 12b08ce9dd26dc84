"""`flexarm reduce`: a solid part, or another program's matrices, as a super-element."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from flexarm.cli.options import Json, print_json, warn
from flexarm.cli.superelements import (
    MATRIX_SUFFIXES,
    accepted,
    draw,
    reduced,
    refuse_for_matrices,
    refuse_for_meshes,
    solid_part,
)
from flexarm.output import output_file, refuse_existing

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
    r"""Reduce a solid part to a super-element.

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
    inputs = _inputs(mesh, grids, order, mass_matrix, damping_matrix)
    if picture is not None:
        refuse_existing(picture, force, inputs)
    with output_file(out, inputs, force) as file:
        if grids is not None or mesh.suffix.lower() in MATRIX_SUFFIXES:
            refuse_for_matrices(mesh, grids, modes, max_frequency, material, picture, damping_ratio, recovery)
            solid = None
            element = accepted(
                mesh,
                interface,
                grids=grids,
                order=order,
                mass=mass,
                mass_matrix=mass_matrix,
                damping_matrix=damping_matrix,
                unit=unit,
                tolerance=tolerance,
            )
        else:
            refuse_for_meshes(order, mass_matrix, damping_matrix, tolerance)
            solid = solid_part(mesh, unit, material, merge, mass)
            element = reduced(
                mesh,
                solid,
                interface,
                json,
                modes=modes,
                max_frequency=max_frequency,
                damping_ratio=damping_ratio,
                lumped=lumped,
                mass=mass,
                recovery=recovery,
            )
        with nullcontext() if picture is None else output_file(picture, inputs) as drawn:
            if drawn is not None and solid is not None:
                draw(solid, element, interface, drawn)
            element.save(file)
    warn(out, element.check(tolerance=tolerance))
    if json:
        print_json({"file": str(out), **element.to_json_dict()})
    else:
        print(f"{element.summary()}\nwritten to {out}")


def _inputs(mesh: Path, grids: Path | None, *texts: str | None) -> list[Path]:
    """Return files that are read; a list of freedoms is none, and a matrix may follow its file's name."""
    named = [Path(name) for text in texts if text for name in (text, text.rpartition(":")[0]) if name]
    return [mesh, *([grids] if grids else []), *named]
