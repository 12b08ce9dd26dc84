"""`flexarm campaign`: many runs of a model whose parameters vary."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from flexarm.cli.options import AllowOutside, Force, Out
from flexarm.cli.progress import progress
from flexarm.errors import InvalidFile, InvalidParameter, printable

Study = Annotated[Path, typer.Argument(metavar="STUDY", help="What varies and what is kept, a TOML file.")]
Resume = Annotated[bool, typer.Option("--resume", help="Go on with a campaign that was stopped.")]
Scheduler = Annotated[
    str | None,
    typer.Option("--scheduler", metavar="ADDRESS", help="A Dask scheduler, such as tcp://10.0.0.1:8786."),
]
Jobs = Annotated[
    int | None,
    typer.Option("--jobs", min=1, metavar="N", help="Worker processes on this machine; default one a core."),
]


def campaign(
    study: Study,
    out: Out,
    resume: Resume = False,
    scheduler: Scheduler = None,
    jobs: Jobs = None,
    force: Force = False,
    allow_outside: AllowOutside = False,
) -> None:
    """Run a study: many variants of a model.

    Writes results.nc (one row a sample: every parameter, status and what is kept), study.json and
    summary.html. Runs use all cores, or the workers of a Dask scheduler. Each batch is kept as it comes:
    after Ctrl-C or a crash --resume goes on.

        flexarm campaign tolerances.toml --out tolerances
        flexarm campaign tolerances.toml --out tolerances --resume
        flexarm campaign fleet.toml --out fleet --scheduler tcp://10.0.0.1:8786
    """
    if scheduler is not None and jobs is not None:
        what = "is of the cluster on this machine; a scheduler has its own workers"
        raise InvalidFile("command line", "--jobs", what)
    from flexarm.campaigns.run_study import campaign as run  # NumPy and the core, not needed for --help

    with progress() as tell:
        try:
            done = run(
                study,
                out,
                resume=resume,
                force=force,
                scheduler=scheduler,
                n_jobs=jobs,
                progress=tell,
                notice=lambda text: print(printable(text), file=sys.stderr),
            )
        except InvalidFile:
            raise
        except InvalidParameter as error:
            problem = error.problems[0]
            where = f"--{problem.where}" if problem.where in ("scheduler", "resume") else problem.where
            raise InvalidFile("command line", where, problem.what) from None
    print(done.summary())
    print(f"written to {out}: {', '.join(done.files)}")
