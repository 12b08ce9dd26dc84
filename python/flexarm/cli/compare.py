"""`flexarm compare`: the gap between a model and a record."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexarm.cli.options import AllowOutside, Force, Json, Model, Step, blame, load_arm, refuse_step, show
from flexarm.cli.progress import progress
from flexarm.cli.records import load_record

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.comparison.files import SavedGap
    from flexarm.record import Record


def compare(
    model: Model,
    record: Annotated[Path, typer.Argument(metavar="RECORD", help="A directory with record.toml.")],
    json: Json = False,
    raw: Annotated[
        bool, typer.Option("--raw", help="Take clocks, frames and outliers as they are, align nothing.")
    ] = False,
    step: Step = 2e-3,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Directory for numbers, tables and pictures.")
    ] = None,
    force: Force = False,
    allow_outside: AllowOutside = False,
) -> None:
    """Show the gap between a model and a record.

    The record's drive moves the model, which is read at each signal's own instants. The gap [m, rad ...] is
    measured minus model, per signal, direction (tangential, radial, normal; x, y, z with several joints) and
    frequency band, with the noise. Clocks and frames are aligned within their stated sigmas. Gross outliers
    of positions and angles are left out, and a note names them. A note also names each signal whose
    prediction changes by more than half its noise at half the time step.

        flexarm compare arm.toml measured
        flexarm compare arm.toml measured --raw --json
        flexarm compare arm.toml measured --out gap

    With --out DIR holds comparison.json, and of each signal gap-NAME.csv and gap-NAME.png: what was measured,
    what the model predicts, and the gap.
    """
    refuse_step(step)
    arm = load_arm(model)
    measured = load_record(record, arm)
    if out is None:
        show(_gap(model, record, arm, measured, raw, step, json), json)
        return
    from flexarm.input_files import input_files
    from flexarm.output import output_directory

    with output_directory(out, force, input_files(model, arm, {"record": measured}).values()) as directory:
        result = _gap(model, record, arm, measured, raw, step, json)
        result.write(directory)
    show(result, json)
    if not json:
        print(f"\nwritten to {out}")


def _gap(
    model: Path, record: Path, arm: Arm, measured: Record, raw: bool, step: float, json: bool
) -> SavedGap:
    """Return the gap of motions and poses, or of frequency responses."""
    from flexarm.comparison import compare as gap
    from flexarm.comparison import compare_responses

    with blame(model, record), progress(json) as tell:
        tell(0.0, "comparing")
        if measured.kind == "frequency_response":
            return compare_responses(arm, measured)
        return gap(arm, measured, align=not raw, step=step, check_step=True)
