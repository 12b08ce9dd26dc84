"""`flexarm calibrate`: estimates of what is uncertain in a model, and of families of effects."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

import flexarm
from flexarm.cli.diagnose import HoldOut
from flexarm.cli.options import (
    AllowOutside,
    Force,
    Jobs,
    Json,
    MaxSeconds,
    Model,
    Out,
    Step,
    refuse_step,
    show,
)
from flexarm.cli.records import fitted


def calibrate(
    model: Model,
    records: Annotated[
        list[Path], typer.Argument(metavar="RECORD", help="Directories with record.toml: what is fitted.")
    ],
    out: Out,
    family: Annotated[
        list[str] | None,
        typer.Option(
            metavar="EFFECT",
            help="An effect at all its places, such as joint_compliance or encoder_offset; repeat it.",
        ),
    ] = None,
    hold_out: HoldOut = None,
    jobs: Jobs = None,
    step: Step = 2e-3,
    max_seconds: MaxSeconds = None,
    json: Json = False,
    force: Force = False,
    allow_outside: AllowOutside = False,
) -> None:
    """Estimate all that is uncertain in a model, and families of effects.

    Fits every value with an [uncertainty] in the model, clocks and frames of the records, and each family:
    one effect at all places where it can act, first with one shared size, then one each. Members that the
    data hardly know stay near the shared size. Unlike diagnose it chooses nothing, and it also fits where a
    gap stays: intervals then widen by what is left. With --max-seconds it ends with what it has.

        flexarm calibrate arm.toml poses --family joint_compliance --out calibrated
        flexarm calibrate arm.toml poses --family encoder_offset --hold-out other_poses --out calibrated

    Writes report.html for you, calibration.json for programs (values, 90 % intervals, priors, correlations,
    gaps), updated.toml, the calibrated model, gaps.nc and figures; flexarm.Calibration.load reads them again
    in Python. Then see what is left:

        flexarm compare calibrated/updated.toml other_poses
        flexarm diagnose calibrated/updated.toml poses --out why
    """
    from flexarm.calibration.families import family_kinds

    refuse_step(step)
    families = family or []
    family_kinds(families)
    fit = partial(flexarm.calibrate, families=families, n_jobs=jobs, step=step, max_seconds=max_seconds)
    found = fitted(model, records, hold_out, out, force, fit, json)
    show(found, json)
    if not json:
        print(f"\nwritten to {out}: open {out / 'report.html'}")
