"""`flexarm example`: files to try the commands on."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexarm.cli.options import Force


def example(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="A new or empty directory.")],
    force: Force = False,
) -> None:
    """Write a model and virtual records, to try the commands on.

    arm.toml is the model; slow, fast and other_day are records of a simulated machine that has something the
    model lacks: virtual, nothing was measured. Beside them swing.csv, a motion; bracket.inp, a mesh;
    machine.toml, the answer; README.md, what to type. The files are the same each time.

        flexarm example tryout
        cd tryout
        flexarm diagnose arm.toml slow fast --hold-out other_day --out diagnosis
    """
    from flexarm.example.files import write
    from flexarm.output import output_directory

    with output_directory(directory, force) as made:
        write(made)
    print(f"written to {directory}: {directory / 'README.md'} says what to type; the records are virtual")
