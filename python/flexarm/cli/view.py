"""`flexarm view`: a model, part, result or diagnosis as one page in three dimensions."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexarm.cli.options import AllowOutside, JointValues, blame, joint_values, load_arm, warn
from flexarm.errors import InvalidFile, Problem
from flexarm.opening import MESHES, kind_of_netcdf

if TYPE_CHECKING:
    from flexarm.diagnosis.result import Diagnosis
    from flexarm.record import Record
    from flexarm.viewer import View


OTHERS = {
    "comparison.json": "is of `flexarm compare`, whose gap-NAME.png show the gap; "
    "`flexarm view MODEL --record RECORD` shows measured points beside those of the model",
    "calibration.json": "is of `flexarm calibrate`, whose report.html shows it; updated.toml can be viewed",
    "study.json": "is of `flexarm campaign`, whose summary.html shows it",
}
"""Files of results that are no page in three dimensions, and where they are seen."""


def view(
    path: Annotated[
        Path, typer.Argument(metavar="PATH", help="A model, super-element, result, record or diagnosis.")
    ],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The page; without it the browser opens.")
    ] = None,
    record: Annotated[
        Path | None, typer.Option("--record", metavar="RECORD", help="Measured points beside predicted ones.")
    ] = None,
    model: Annotated[
        Path | None, typer.Option("--model", metavar="MODEL", help="The model of a record.")
    ] = None,
    mesh: Annotated[
        Path | None, typer.Option("--mesh", metavar="MESH", help="The mesh of a super-element.")
    ] = None,
    joint: JointValues = None,
    scale: Annotated[
        float | None, typer.Option("--scale", metavar="S", help="Displacements are shown times S.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a page of that name.")] = False,
    allow_outside: AllowOutside = False,
) -> None:
    """Show a model or result in three dimensions.

    Makes one page that needs no network. Beams follow their deformed centre lines, with their sections;
    joints have their axes; displacements are enlarged where they would not show, and the page says by how
    much. Runs play at true speed, with a slider; a record's points are tied to those that its model predicts.

        flexarm view arm.toml --joint hinge=0.5
        flexarm view robot.urdf --out robot.html
        flexarm view hub.nc --mesh hub.inp
        flexarm view run                        what simulate wrote
        flexarm view measured --model arm.toml
        flexarm view diagnosis --record other_day
    """
    if out is not None:
        from flexarm.output import PAGES, refuse_existing, refuse_suffix

        refuse_suffix(out, PAGES)
        refuse_existing(out, force, [path])
    from flexarm.viewer.scene import STYLE

    if scale is not None and not 0 < scale <= STYLE.largest_scale:
        what = f"must be positive and at most {STYLE.largest_scale:g}, got {scale:g}"
        raise InvalidFile("command line", "--scale", what)
    shown = _view(path, record, model, mesh, joint, scale)
    with blame(path):
        if out is None:
            print(f"written to {shown.open()}, which the browser shows")
        else:
            shown.save(out, force, [path])
            print(f"written to {out}")


def _view(
    path: Path,
    record: Path | None,
    model: Path | None,
    mesh: Path | None,
    joint: list[str] | None,
    scale: float | None,
) -> View:
    from flexarm.viewer import View
    from flexarm.viewer.view import of_record

    times: dict[str, Any] = {} if scale is None else {"scale": scale}
    inside = ("record.toml", "report.json", "gaps.nc", "simulation.nc", *OTHERS)
    if path.is_dir() or path.name in inside or path.match("gap-*.csv"):
        folder = path if path.is_dir() else path.parent
        diagnosed = (path.is_dir() or path.name == "gaps.nc") and (folder / "report.json").is_file()
        if diagnosed or path.name == "report.json":
            return _of_diagnosis(folder, record, times)
        if path.name != "record.toml" and (folder / "simulation.nc").is_file():
            return _of_result(folder / "simulation.nc", record, times)
        if path.name != "record.toml" and not (folder / "record.toml").is_file():
            nothing = "holds no report.json, simulation.nc or record.toml, which are shown"
            other = next((what for name, what in OTHERS.items() if (folder / name).is_file()), nothing)
            raise InvalidFile(path, "path", other)
        beside = model or _model_of(folder)
        arm = load_arm(beside)
        measured = _record(path)
        with blame(beside, path):
            return View(of_record(arm, measured, urdf=_urdf(beside), **times))
    if path.suffix in MESHES:
        what = "is a mesh; `flexarm reduce` makes it a super-element, which is shown"
        raise InvalidFile(path, "path", what)
    if path.suffix == ".nc":
        return _of_part(path, mesh) if kind_of_netcdf(path) == "part" else _of_result(path, record, times)
    arm = load_arm(path)
    with blame(path, record):
        if record is not None:
            return View(of_record(arm, _record(record), urdf=_urdf(path), **times))
        found: View = arm.view(joint_values(arm, path, joint), urdf=_urdf(path))
    return found


def _record(path: Path) -> Record:
    from flexarm.record import Record

    return Record.load(path)


def _of_part(path: Path, mesh: Path | None) -> View:
    from flexarm.superelement import SuperElement
    from flexarm.viewer import View
    from flexarm.viewer.stages import of_superelement
    from flexarm.viewer.urdf_meshes import part_surface

    part = SuperElement.load(path)
    with blame(path):
        return View(of_superelement(part, part_surface(part, mesh, path.parent)))


def _of_result(path: Path, record: Path | None, times: dict[str, Any]) -> View:
    from flexarm.modal import Modes
    from flexarm.simulation import Simulation
    from flexarm.statics import Statics

    kind = kind_of_netcdf(path)
    with blame(path, record):
        if kind == "statics":
            return Statics.load(path).view(**times)
        if kind == "modes":
            return Modes.load(path).view()
        run: View = Simulation.load(path).view(None if record is None else _record(record), **times)
    return run


def _of_diagnosis(folder: Path, record: Path | None, times: dict[str, Any]) -> View:
    from flexarm.diagnosis.result import Diagnosis

    found = Diagnosis.load(folder)
    beside = record or _record_of(found, folder)
    if beside is None:
        what = "none of its records lies beside it; --record names one, whose points are then shown"
        warn(folder, [Problem("records", what)])
    with blame(folder, beside):
        shown: View = found.view(None if beside is None else _record(beside), **times)
    return shown


def _record_of(found: Diagnosis, folder: Path) -> Path | None:
    """Return a record of a diagnosis that lies beside it or here, unchanged; a held-out one first."""
    from flexarm.input_files import sha256

    hashes = found.provenance.get("inputs_sha256", {})
    for name in (*found.held_out, *found.training):
        for place in (folder.absolute().parent / name, Path(name)):
            file = place / "record.toml"
            if file.is_file() and sha256(file) == hashes.get(f"{name}/record.toml"):
                print(f"record: {place}", file=sys.stderr)
                return place
    return None


def _model_of(folder: Path) -> Path:
    """Return the only model that lies in a record's directory or beside it.

    Raise InvalidFile if there is none, or more than one.
    """
    beside = [*folder.glob("*.toml"), *folder.absolute().parent.glob("*.toml")]
    models = sorted(
        file for file in beside if "flexarm-arm/1" in file.read_text(encoding="utf-8", errors="replace")
    )
    if len(models) != 1:
        what = f"is not clear: beside the record stand {', '.join(map(str, models))}"
        what = what if models else "is not stated, and no model stands beside the record"
        raise InvalidFile(folder, "model", f"{what}; --model names it")
    print(f"model: {models[0]}", file=sys.stderr)
    return models[0]


def _urdf(model: Path) -> Path | None:
    """Return the URDF file of a model, or None."""
    if model.suffix == ".urdf":
        return model
    named = tomllib.loads(model.read_text(encoding="utf-8")).get("urdf")
    return None if named is None else model.parent / str(named)
