"""`flexarm import`: a record from logs, by a map."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexarm.cli.options import Force, warn
from flexarm.cli.progress import progress
from flexarm.errors import InvalidFile


def import_logs(
    paths: Annotated[
        list[Path], typer.Argument(metavar="MAP", help="An import map (TOML); with --guess logs of one run.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Directory for the record, default: the map's name; with --guess the map.",
        ),
    ] = None,
    guess: Annotated[bool, typer.Option("--guess", help="Propose a map for logs, with reasons.")] = False,
    model: Annotated[
        Path | None, typer.Option("--model", metavar="MODEL", help="With --guess: model of the arm.")
    ] = None,
    force: Force = False,
) -> None:
    """Make a record from logs of other programs.

    MAP says for each signal its file, columns, stamps and unit: see docs/importing.md. Formats are CSV and
    what laser trackers write as text, Parquet, Feather, Excel, MATLAB, HDF5, NetCDF, ROS bags and MCAP, TDMS,
    MDF4, C3D, GSI and OptiTrack files. Signals keep their own instants. All that is wrong in the map and its
    files is told at once, and then nothing is written.

    With --guess a map is proposed from names, rates, ranges and the model's motion. It says why for each
    line, and what it does not know.

        flexarm import --guess run7.mcap tracker.csv --model arm.toml --out run7.map.toml
        flexarm import run7.map.toml --out measured
        flexarm check arm.toml measured
    """
    if guess:
        _guess(paths, model, out, force)
        return
    if model is not None:
        raise InvalidFile("command line", "--model", "belongs to --guess; a map names its model itself")
    if len(paths) > 1:
        what = f"must be one map, got {len(paths)} files; --guess takes many"
        raise InvalidFile("command line", "MAP", what)
    _import(paths[0], out, force)


def _guess(files: list[Path], model: Path | None, out: Path | None, force: bool) -> None:
    """Write a proposed map."""
    from flexarm.importing.guess import guess_map
    from flexarm.output import refuse_existing, write_file

    for option, value in (("--model", model), ("--out", out)):
        if value is None:
            raise InvalidFile("command line", option, "is needed with --guess")
    assert model is not None and out is not None
    refuse_existing(out, force, [*files, model])
    with progress() as tell:
        tell(0.0, "comparing the logs with the model")
        text = guess_map(files, model, out)
    write_file(out, text, [*files, model])
    unknown = text.count("# unknown:")
    things = "1 thing marked `# unknown:` is" if unknown == 1 else f"{unknown} things marked `# unknown:` are"
    print(f"written to {out}: a proposal; {things} for you to say")


def _import(path: Path, out: Path | None, force: bool) -> None:
    """Write the record of a map."""
    from flexarm.cli.check import record_lines
    from flexarm.importing.workflow import import_record, sources_of
    from flexarm.output import output_directory
    from flexarm.record.save import write

    place = out or Path(path.name.removesuffix(".toml").removesuffix(".map"))
    with progress() as tell:
        tell(0.0, "reading the logs")
        record = import_record(path)
    with output_directory(place, force, sources_of(path), ["record.toml"]) as directory:
        write(record, directory)
    print("\n".join([*record_lines(record), f"written to {place}: a record"]))
    warn(path, record.check())
