"""`flexarm reproduce`: one directory with figures, data, numbers and a page."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from flexarm.mockup import solid_arm
from flexarm.output import output_directory, write_file
from flexarm.report.files import style
from flexarm.reproduction.study import Report
from flexarm.simulation.progress import bar

SEED = 2008
"""Of the virtual measurement, unless another one is asked for."""
RECORD, HINGE = "virtual-measurement", "hinge"
"""Directories of the record and of the super-elements beside the figures."""


def reproduce(
    out: str | Path, force: bool = False, progress: bool | Report = False, seed: int = SEED
) -> None:
    """Reproduce the paper's figures and claims.

    Writes figure-04, 06, 07, 08, 09 and 10 as .png, .pdf and .csv, summary.json, index.html, and beside them
    the record of the virtual measurement, the hinge's super-elements and the model, for commands such as
    `flexarm compare`.

    Parameters
    ----------
    out : str or Path
        A new or empty directory.
    force : bool
        Write into a directory that holds files.
    progress : bool or callable
        Show a bar on standard error, or call with the part that is done, 0 to 1, and what is being done.
    seed : int
        Of the virtual measurement's noise.

    Raises
    ------
    InvalidFile
        If the directory holds files, or cannot be written.
    """
    with (
        output_directory(out, force) as directory,
        TemporaryDirectory(dir=directory.parent) as scratch,  # gone with the hidden directory
        _reported(progress) as report,
    ):
        _write(directory, Path(scratch), report, seed)


def _write(directory: Path, scratch: Path, report: Report, seed: int) -> None:
    from flexarm.record.save import write
    from flexarm.reproduction import figures
    from flexarm.reproduction.claims import claims
    from flexarm.reproduction.page import page
    from flexarm.reproduction.scene import scene
    from flexarm.reproduction.study import study
    from flexarm.reproduction.summary import summary
    from flexarm.reproduction.tables import deformed_instant, tables, write_csv

    began = perf_counter()
    found = study(scratch, seed=seed, report=lambda done, what: report(0.7 * done, what))
    report(0.7, "claims")
    content = tables(found)
    numbers = summary(found, content, claims(found), seed)
    surfaces = scene(found.models, float(found.angle(np.array([deformed_instant(found)]))[0]))
    with style():
        for i, (number, table) in enumerate(content.items()):
            report(0.75 + 0.04 * i, f"figure {int(number)}")
            write_csv(table, directory / f"figure-{number}.csv")
            figures.save(figures.draw(number, table, surfaces), directory / f"figure-{number}")
    report(0.97, "page")
    (directory / RECORD).mkdir()
    write(found.record, directory / RECORD)
    (directory / HINGE).mkdir()
    for file in found.models.hinge.folder.iterdir():
        write_file(directory / HINGE / file.name, file.read_bytes())
    solid_arm(replace(found.models.hinge, folder=directory / HINGE)).to_toml(directory / "model.toml")
    write_file(directory / "summary.json", json.dumps(numbers, indent=2) + "\n")
    seconds = {**found.seconds, "all": perf_counter() - began}
    write_file(directory / "index.html", page(found, numbers, seconds))
    report(1.0, "done")


@contextmanager
def _reported(progress: bool | Report) -> Iterator[Report]:
    """Return the caller's function, a bar, or nothing."""
    if callable(progress):
        yield progress
    elif progress:
        with bar(keep=True) as tell:
            yield tell
    else:
        yield lambda done, what: None
