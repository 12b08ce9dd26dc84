"""`flexarm export`: joints and parts in the files of other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexarm.cli.options import Json, ReplaceFile, blame, load_arm, print_json, warn
from flexarm.errors import InvalidFile, Problem
from flexarm.output import refuse_existing

Out = Annotated[Path, typer.Option("--out", metavar="FILE", help="The file to write.")]


def export(
    path: Annotated[Path, typer.Argument(metavar="PATH", help="A model (TOML) or a super-element (NetCDF).")],
    out: Out,
    urdf: Annotated[
        Path | None,
        typer.Option("--urdf", metavar="FILE", help="The URDF file that gets the model's joints."),
    ] = None,
    mjcf: Annotated[
        Path | None, typer.Option("--mjcf", metavar="FILE", help="The MuJoCo model that gets them.")
    ] = None,
    unit: Annotated[
        str | None, typer.Option("--unit", metavar="UNIT", help="Of Nastran and Abaqus: m (default) or mm.")
    ] = None,
    json: Json = False,
    force: ReplaceFile = False,
) -> None:
    """Write joints or a part for other programs.

    A model's stiffness, damping, friction and rotors go into the robot file that has its joints; the rest of
    the file stays as it is. Effects for which the format has no word are told.

        flexarm export diagnosis/updated.toml --urdf robot.urdf --out found.urdf
        flexarm export diagnosis/updated.toml --mjcf robot.xml --out found.xml

    A super-element goes into Simscape (.mat, Reduced Order Flexible Solid), Nastran (.bdf, DMIG) or Abaqus
    (.inp, matrix input).

        flexarm export bracket.nc --out bracket.mat
        flexarm export bracket.nc --unit mm --out bracket.bdf
    """
    refuse_existing(out, force, [file for file in (path, urdf, mjcf) if file is not None])
    if path.suffix == ".nc":
        if urdf is not None or mjcf is not None:
            raise InvalidFile("command line", "--urdf, --mjcf", "are for models; a part needs --out alone")
        files, notes = _part(path, out, unit or "m", force), []
    else:
        if unit is not None:
            raise InvalidFile("command line", "--unit", "is for super-elements; models are in SI units")
        files, notes = [out], _joints(path, urdf, mjcf, out, force)
    warn(out, [Problem("export", note) for note in notes])
    if json:
        print_json({"files": [str(file) for file in files], "notes": notes})
    else:
        print("\n".join(f"written to {file}" for file in files))


def _part(path: Path, out: Path, unit: str, force: bool) -> list[Path]:
    from flexarm.export import export_part
    from flexarm.superelement import SuperElement

    with blame(path):
        return export_part(SuperElement.load(path), out, unit, force)


def _joints(path: Path, urdf: Path | None, mjcf: Path | None, out: Path, force: bool) -> list[str]:
    if (urdf is None) == (mjcf is None):
        what = "exactly one must name the robot file that gets the joints of a model"
        raise InvalidFile("command line", "--urdf, --mjcf", what)
    from flexarm.export import export_mjcf, export_urdf

    arm = load_arm(path)
    with blame(path):
        if urdf is not None:
            return export_urdf(arm, urdf, out, force)
        return export_mjcf(arm, mjcf or out, out, force)
