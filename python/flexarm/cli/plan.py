"""`flexarm plan`: which effects an experiment could tell apart, before it is run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import flexarm
from flexarm.cli.options import (
    AllowOutside,
    Force,
    Jobs,
    Json,
    Model,
    Step,
    blame,
    load_arm,
    refuse_step,
    show,
    warn,
)
from flexarm.cli.progress import progress
from flexarm.cli.records import load_record
from flexarm.errors import InvalidFile

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.diagnosis.design.plan_result import Plan
    from flexarm.drive import Drive as Motion
    from flexarm.record import Record

Drives = Annotated[
    list[Path],
    typer.Option("--drive", metavar="DRIVE", help="A record, or a CSV file of joint angles; repeat it."),
]
More = Annotated[
    list[Path] | None, typer.Argument(metavar="DRIVE", help="More of them, after --drive DRIVE.")
]
OutOrNone = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Directory for plan.json, plan.html, figures.")
]


def plan(
    model: Model,
    drive: Drives,
    more: More = None,
    out: OutOrNone = None,
    json: Json = False,
    jobs: Jobs = None,
    step: Step = 4e-3,
    force: Force = False,
    allow_outside: AllowOutside = False,
) -> None:
    """Predict which effects an experiment could tell apart.

    Simulates the motions with the model's sensors, tries every effect at every place at a plausible size, and
    says how small an effect would still be seen, which effects would be taken for one another, and the
    cheapest addition that parts them: a reflector, the motor's torque, another payload, speed or pose. Run it
    the day before a campaign.

        flexarm plan arm.toml --drive swing.csv
        flexarm plan arm.toml --drive slow.csv measured --out plan

    A record as DRIVE is made again, with its signals, noise, clocks, frames and payloads. A CSV file has
    time_s and one column per driven joint, and is seen by the model's [[sensors]]; without any a tracker of
    the model's last point is assumed (0.05 mm at 10 Hz), and said.
    """
    refuse_step(step)
    arm = load_arm(model)
    motions = {name: _motion(path, arm) for name, path in _names([*drive, *(more or ())]).items()}
    if out is None:
        found = _planned(model, arm, motions, jobs, step, json)
    else:
        from flexarm.input_files import input_files
        from flexarm.output import output_directory
        from flexarm.record import Record

        records = {name: each for name, each in motions.items() if isinstance(each, Record)}
        read = input_files(model, arm, records)
        with output_directory(out, force, [*drive, *(more or ()), *read.values()]) as directory:
            found = _planned(model, arm, motions, jobs, step, json)
            found.write(directory)
    show(found, json)
    if out is not None and not json:
        print(f"\nwritten to {out}: open {out / 'plan.html'}")


def _planned(
    model: Path, arm: Arm, motions: dict[str, Motion | Record], jobs: int | None, step: float, json: bool
) -> Plan:
    """Return the plan, which tells how far it is."""
    with progress(json) as tell, blame(model):
        found: Plan = flexarm.plan(arm, motions, n_jobs=jobs, step=step, progress=tell)
    return found


def _names(paths: list[Path]) -> dict[str, Path]:
    """Return motions by the names of their files or directories.

    Raise InvalidFile if two have the same name.
    """
    found: dict[str, Path] = {}
    for path in paths:
        name = (path.parent if path.name == "record.toml" else path).resolve().stem
        if name in found:
            what = f"is called {name!r} as another one is; motions need different names"
            raise InvalidFile(path, "--drive", what)
        found[name] = path
    return found


def _motion(path: Path, arm: Arm) -> Motion | Record:
    """Return the motion of the joints."""
    if path.is_dir() or path.name == "record.toml":
        record = load_record(path, arm)
        if record.kind != "motion":
            what = f'is "{record.kind}"; planned are motions, so give a record of kind "motion" or a CSV file'
            raise InvalidFile(path, "kind", what)
        return record
    from flexarm.drive import Drive
    from flexarm.drive.doubts import doubts

    with blame(path):
        found = Drive.from_csv(path, arm)
    warn(path, doubts(found, arm))
    return found
