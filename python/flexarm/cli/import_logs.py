"""`flexarm import`: a record from logs, by a map."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexarm.cli.options import Force, warn


def import_logs(
    path: Annotated[Path, typer.Argument(metavar="MAP", help="An import map (TOML).")],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Directory for the record; default: the map's name."),
    ] = None,
    force: Force = False,
) -> None:
    """Make a record from logs of other programs.

    MAP says for each signal its file, columns, stamps and unit: see docs/importing.md. Formats are CSV and
    what laser trackers write as text, Parquet, Feather, Excel, MATLAB, HDF5, NetCDF, ROS bags and MCAP, TDMS,
    MDF4, C3D and OptiTrack files. Signals keep their own instants. All that is wrong in the map and its
    files is told at once, and then nothing is written.

        flexarm import run7.map.toml --out measured
        flexarm check arm.toml measured
    """
    from flexarm.cli.check import record_lines
    from flexarm.importing.workflow import import_record, sources_of
    from flexarm.output import output_directory
    from flexarm.record.save import write

    place = out or Path(path.name.removesuffix(".toml").removesuffix(".map"))
    record = import_record(path)
    with output_directory(place, force, sources_of(path), ["record.toml"]) as directory:
        write(record, directory)
    print("\n".join([*record_lines(record), f"written to {place}: a record"]))
    warn(path, record.check())
