"""`flexarm reproduce`: one directory with figures, data, numbers and a page."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np
from markupsafe import Markup

from flexarm.configuration import config
from flexarm.mockup import solid_arm
from flexarm.output import output_directory, write_file
from flexarm.report.files import filled, style
from flexarm.reproduction.deformed_figure import ARM_SCALE, HINGE_SCALE
from flexarm.reproduction.oscillation import start_time
from flexarm.reproduction.scene import scene
from flexarm.reproduction.study import Report, Study, study
from flexarm.reproduction.tables import deformed_instant, tables, write_csv, zoom_window
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
    from flexarm.reproduction.summary import summary

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


CAPTIONS = {
    "04": "Angle of the reducer's input shaft: the sine of ±1.2 rad times the ratio 120.",
    "06": "Deformed mock-up at t = {instant:.1f} s, the instant of the greatest measured offset: the solid "
    "parts and the tube in colours of displacement, drawn {arm:g} times as large (hinge: {hinge:g} times); "
    "equilibrium at the encoder's angle. Right: the three tip positions, true scale, as they move.",
    "07": "Vertical and horizontal tip position: rigid arm at the encoder's angle, finite-element model "
    "driven by the encoder, virtual measurement.",
    "08": "The vertical position enlarged, {first:.1f} to {last:.1f} s. Model and measurement vibrate "
    "together; the rigid curve is some centimetres away. Below: the distance from the rigid curve. After the "
    "turn of the motion at {turn:.1f} s the bearing of the virtual mock-up sticks, which the model does not "
    "know.",
    "09": "Vertical and horizontal error of the rigid position: virtual measurement and finite-element "
    "model.",
    "10": "Tangential error: virtual measurement, model driven by the encoder signal, model driven by the "
    "pure sine. The pure sine starts and stops with a jump of speed: it rings there and nowhere else.",
}
"""Captions of the figures."""


def page(study: Study, summary: dict[str, Any], seconds: dict[str, float]) -> str:
    """Return the page as HTML; images stand next to it."""
    first, last = zoom_window(study)
    facts = {
        "instant": deformed_instant(study),
        "first": first,
        "last": last,
        "turn": study.experiment.period / 4,
        "arm": ARM_SCALE,
        "hinge": HINGE_SCALE,
    }
    versions = config()
    return filled(
        "page.html.j2",
        {"mm": _mm, "number": _number, "power": _power},
        summary=summary,
        claims=summary["claims"],
        parameters=summary["parameters"],
        models=summary["models"],
        misprint=summary["misprint"],
        split=summary["claims"][4]["numbers"],
        captions={number: text.format(**facts) for number, text in CAPTIONS.items()},
        start_ends=start_time(study),
        seconds=seconds,
        versions={name: versions[name] for name in ("flexarm", "git", "step factorisation", "platform")},
    )


def _mm(metres: float, digits: int = 2) -> str:
    return f"{1e3 * metres:.{digits}f} mm"


def _number(value: float) -> str:
    """Write three digits, or as many as tell a share from 1."""
    return f"{value:.5f}" if 0.999 < value < 1 else f"{value:.3g}"


def _power(value: float) -> Markup:
    """Return the mantissa times a power of ten."""
    mantissa, exponent = f"{value:.2e}".split("e")
    return Markup("{} · 10<sup>{}</sup>").format(mantissa, str(int(exponent)).replace("-", "−"))
