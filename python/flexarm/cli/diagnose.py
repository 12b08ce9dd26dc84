"""`flexarm diagnose`: where model and measurement disagree, and the effect that is missing."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

import flexarm
from flexarm.cli.options import AllowOutside, Force, Jobs, MaxSeconds, Model, Out, Step, refuse_step
from flexarm.cli.records import fitted

Records = Annotated[
    list[Path], typer.Argument(metavar="RECORD", help="Directories with record.toml: what to explain.")
]
HoldOut = Annotated[
    Path | None,
    typer.Option("--hold-out", metavar="RECORD", help="A record never fitted to: the final check."),
]
Seed = Annotated[int, typer.Option("--seed", min=0, metavar="N", help="Same seed, same answer.")]


def diagnose(
    model: Model,
    records: Records,
    out: Out,
    hold_out: HoldOut = None,
    jobs: Jobs = None,
    seed: Seed = 0,
    step: Step = 2e-3,
    force: Force = False,
    allow_outside: AllowOutside = False,
    max_seconds: MaxSeconds = None,
) -> None:
    """Name the physical effect that a model lacks.

    Simulates the records with the model, shows where the two disagree, tries every effect at every place
    where it can sit, and names those that the data ask for: with probability, parameters, 90 % intervals,
    and all others that the data cannot tell from them. Says so where the model is adequate, where nothing
    known explains the gap, and where the data are at fault. Give records with different payloads and
    speeds; one kept out with --hold-out checks the repair.

        flexarm diagnose arm.toml slow fast --hold-out other_day --out diagnosis

    Writes report.html for you, report.json for programs, updated.toml, the repaired model, the gaps in
    gaps.nc, and the figures; flexarm.Diagnosis.load reads them again in Python. Whatever the verdict, the
    exit code is 0: "verdict" in report.json tells programs.

    That takes from seconds to minutes; with --max-seconds the search ends then, and concludes from what it
    has fitted. Ctrl-C stops it with exit code 130, and nothing is written. Then see what is left:

        flexarm compare diagnosis/updated.toml other_day
    """
    refuse_step(step)
    fit = partial(flexarm.diagnose, n_jobs=jobs, seed=seed, step=step, max_seconds=max_seconds)
    found = fitted(model, records, hold_out, out, force, fit)
    print(found.summary())
    print(f"\nwritten to {out}: open {out / 'report.html'}")
