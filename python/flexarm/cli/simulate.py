"""`flexarm simulate`: a transient, and what the sensors would have seen of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexarm.cli.options import (
    AllowOutside,
    Force,
    JointValues,
    Model,
    Out,
    Step,
    blame,
    joint_values,
    load_arm,
    numbers_by_joint,
    refuse_step,
    warn,
)
from flexarm.cli.progress import progress
from flexarm.cli.records import load_record
from flexarm.errors import InvalidFile

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.drive import Drive as Motion
    from flexarm.record import Record
    from flexarm.simulation import Simulation

Drive = Annotated[
    Path, typer.Option("--drive", metavar="DRIVE", help="A record, or a CSV file of joint angles.")
]
Alpha = Annotated[
    float, typer.Option("--alpha", metavar="A", help="HHT's alpha, -1/3 to 0; 0 damps nothing.")
]
Forces = Annotated[
    bool, typer.Option("--forces", help="Add section forces and base reactions to simulation.nc.")
]
Rates = Annotated[
    list[str] | None,
    typer.Option(
        "--rate",
        metavar="NAME=RATE",
        help="Let go of a joint that nothing drives, at this rate [rad/s, m/s if prismatic]; repeat it.",
    ),
]
Moving = Annotated[
    bool, typer.Option("--moving", help="Begin at the first rates of the drive; --rate does so, too.")
]
Seed = Annotated[int, typer.Option("--seed", min=0, metavar="N", help="Seed of the sensors' noise.")]


def simulate(
    model: Model,
    drive: Drive,
    out: Out,
    step: Step = 2e-3,
    alpha: Alpha = -0.05,
    forces: Forces = False,
    joint: JointValues = None,
    rate: Rates = None,
    moving: Moving = False,
    seed: Seed = 0,
    force: Force = False,
    allow_outside: AllowOutside = False,
) -> None:
    """Simulate a transient under a drive.

    Writes simulation.nc and a record of what the sensors saw. DRIVE is a record, whose signals are then
    simulated at their instants without noise, or a CSV file with time_s and one column per driven joint,
    named after it: output side [rad, m if prismatic], joined by a cubic spline, held before and after. The
    run starts at rest in equilibrium under the first value, or in motion (--moving, --rate); other joints
    stand where --joint says. Without sensors in the model the record holds every point's position, one row a
    step.

        flexarm simulate arm.toml --drive swing.csv --out run
        flexarm simulate crane.toml --drive lift.csv --joint swing=0.1 --rate swing=0 --out run
        flexarm simulate arm.toml --drive measured --out virtual --step 0.001 --forces
    """
    arm = load_arm(model)
    refuse_step(step)
    if not -1 / 3 - 1e-12 <= alpha <= 0:
        raise InvalidFile("command line", "--alpha", f"must lie between -1/3 and 0, got {alpha:g}")
    from flexarm.cli.virtual_record import sensed, simulated  # NumPy and the core, not needed for --help
    from flexarm.input_files import input_files
    from flexarm.output import output_directory
    from flexarm.record.compatibility import unplaced_effects
    from flexarm.record.save import write

    rests = joint_values(arm, model, joint)
    rates = numbers_by_joint(arm, model, rate, "--rate", "NAME=RATE")
    record = load_record(drive, arm) if drive.is_dir() or drive.name == "record.toml" else None
    if record is not None and (rests or rates or moving):
        what = (
            "says itself where joints stand and how it begins; a CSV file takes --joint, --rate and --moving"
        )
        raise InvalidFile("command line", "--drive", f"is a record, which {what}")
    read = input_files(model, arm, {} if record is None else {"": record})
    with output_directory(out, force, [drive, *read.values()], ["record.toml", "simulation.nc"]) as directory:
        motion = _motion(drive, arm, record, bool(rates))
        if rests or rates or moving:
            motion = _begun(motion, rests, rates, moving)
        _refuse_endless(motion, step)
        with blame(model):
            run = _run(arm, motion, record, step, alpha, forces)
            seen = sensed(run, arm, motion, seed) if record is None else simulated(record, run, arm)
        if run.joint_command is not None:
            from flexarm.control.limits import limited_motors

            warn(model, limited_motors(run))
        if record is None and not arm.sensors:  # with sensors or a record it has been said already
            warn(model, unplaced_effects(seen, arm))
        run.save(directory / "simulation.nc")
        write(seen, directory)
    print(f"written to {out}: simulation.nc and a record")


def _motion(drive: Path, arm: Arm, record: Record | None, idle: bool) -> Motion:
    """Return the motion of the joints; where others are let go a CSV file may drive none."""
    from flexarm.drive.doubts import doubts
    from flexarm.drive.drive import Drive as Motion
    from flexarm.drive.drive import samples_in

    with blame(drive):
        if record is not None:
            return Motion.from_record(record, arm)
        found = Motion.from_samples(*samples_in(drive, arm, idle))
    warn(drive, doubts(found, arm))
    return found


def _begun(motion: Motion, rests: dict[str, float], rates: dict[str, float], moving: bool) -> Motion:
    """Return a motion in which other joints stand somewhere, or are let go with rates."""
    for option, values in (("--joint", rests), ("--rate", rates)):
        for name in motion.joints.keys() & values.keys():
            what = f"the drive moves {name!r} from its first row on; allowed are joints without a column"
            raise InvalidFile("command line", option, what)
    ends = [motion.start, motion.end]
    free = motion.from_samples(ends, dict.fromkeys(rates, (0.0, 0.0)), side="torque")
    return replace(
        motion, joints={**motion.joints, **free.joints}, rest=rests, rates=rates if rates or moving else None
    )


def _refuse_endless(motion: Motion, step: float) -> None:
    from flexarm.record.step_limit import MOST_STEPS

    steps = (motion.end - motion.start) / step
    if steps > MOST_STEPS:
        allowed = (motion.end - motion.start) / MOST_STEPS
        what = f"{step:g} s would make {steps:.3g} steps; allowed are {MOST_STEPS:.3g}, or {allowed:.2g} s"
        raise InvalidFile("command line", "--step", what)


TURNS = {"orientation", "inclination", "angular_rate", "acceleration"}
"""Quantities that need rotations of the points."""


def _run(
    arm: Arm, motion: Motion, record: Record | None, step: float, alpha: float, forces: bool
) -> Simulation:
    """Return the transient, with what the sensors need."""
    from flexarm.simulation import simulate as solve

    seen = {entry.quantity for entry in (arm.sensors if record is None else record.signals.values())}
    with progress() as tell:
        return solve(
            arm if record is None else record.applied_to(arm),
            motion,
            step=step,
            alpha=alpha,
            forces=forces or "strain" in seen,
            rotations=bool(seen & TURNS),
            energies=True,
            progress=lambda done: tell(done, "simulation"),
        )
