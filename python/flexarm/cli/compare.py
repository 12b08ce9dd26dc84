"""`flexarm compare`: the gap between a model and a record."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexarm.cli.options import AllowOutside, Json, Model, Step, blame, load_arm, refuse_step, show
from flexarm.cli.records import load_record


def compare(
    model: Model,
    record: Annotated[Path, typer.Argument(metavar="RECORD", help="A directory with record.toml.")],
    json: Json = False,
    raw: Annotated[
        bool, typer.Option("--raw", help="Take clocks, frames and outliers as they are, align nothing.")
    ] = False,
    step: Step = 2e-3,
    allow_outside: AllowOutside = False,
) -> None:
    """Show the gap between a model and a record.

    The model is driven by the record's drive and seen at each signal's own instants. The gap [m, rad ...] is
    shown per signal, direction (tangential, radial, normal; x, y, z with several joints) and frequency band,
    beside the noise. Clocks and frames are aligned within their stated sigmas. Gross outliers of places and
    angles count in nothing, and are told. So are signals that half the time step moves by more than half
    their noise.

        flexarm compare arm.toml measured
        flexarm compare arm.toml measured --raw --json
    """
    refuse_step(step)
    arm = load_arm(model)
    measured = load_record(record, arm)
    if measured.kind == "frequency_response":
        from flexarm.comparison import compare_responses

        with blame(model, record):
            beside = compare_responses(arm, measured)
        show(beside, json)
        return
    from flexarm.comparison import compare as gap

    with blame(model, record):
        result = gap(arm, measured, align=not raw, step=step, check_step=True)
    show(result, json)
