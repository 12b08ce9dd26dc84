"""`flexarm linearise`: matrices for control design."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexarm.cli.options import (
    JointValues,
    Json,
    Model,
    ReplaceFile,
    blame,
    joint_values,
    load_arm,
    print_json,
)
from flexarm.errors import InvalidFile
from flexarm.output import output_file

Out = Annotated[Path, typer.Option("--out", metavar="FILE", help="Where to write: FILE.mat or FILE.nc.")]
Inputs = Annotated[
    list[str] | None,
    typer.Option(
        "--input",
        metavar="NAME=KIND",
        help="An input: at a joint angle, acceleration, torque, free or locked, at a point force; repeat it.",
    ),
]
Outputs = Annotated[
    list[str] | None,
    typer.Option("--output", metavar="NAME", help="An output: a sensor, a point or a joint; repeat it."),
]
ModeCount = Annotated[
    int | None, typer.Option("--modes", min=0, metavar="N", help="Keep only the lowest modes; default all.")
]


def linearise(
    model: Model,
    out: Out,
    joint: JointValues = None,
    inputs: Inputs = None,
    outputs: Outputs = None,
    modes: ModeCount = None,
    json: Json = False,
    force: ReplaceFile = False,
) -> None:
    """Write A, B, C, D of the linear model about the equilibrium.

    Small motions x' = A x + B u, y = C x + D u about the equilibrium under gravity, the joints' drives held.
    Inputs u: by default the angle of every motor, output side; its acceleration, with angle and rate as
    states, where an output such as a torque or an accelerometer follows it at once. With --input, only what
    you name: the others are locked.

        NAME=angle, NAME=acceleration    the motor is held and moved
        NAME=torque, NAME=free           the motor is let go
        POINT=force                      three forces in the base's axes

    Outputs y: the model's sensors, without noise, delay and errors; without sensors, all joints and points.

        flexarm linearise arm.toml --joint hinge=0.5 --out arm.mat
        flexarm linearise arm.toml --input hinge=torque --input tip=force --output tip --out arm.nc
        flexarm linearise arm.toml --modes 3 --out small.mat

    In MATLAB: m = load('arm.mat'); sys = ss(m.A, m.B, m.C, m.D, 'InputName', m.input). In Python:
    flexarm.LinearModel.load("arm.mat"), or control.ss(m.A, m.B, m.C, m.D) of it.
    """
    if out.suffix not in (".mat", ".nc"):
        raise InvalidFile("command line", "--out", f"must end in .mat or .nc, got {out}")
    arm = load_arm(model)
    values = joint_values(arm, model, joint)
    asked = _pairs(inputs)
    from flexarm.linear import linearise as solve  # NumPy and the core, not needed for --help

    with output_file(out, [model, *arm.part_files], force) as file:
        with blame(model):
            found = solve(arm, joints=values, inputs=asked, outputs=outputs or None, modes=modes)
        found.save(file)
    if json:
        print_json({"file": str(out), **found.to_json_dict()})
    else:
        print(f"{found.summary()}\nwritten to {out}")


def _pairs(given: list[str] | None) -> list[tuple[str, str]] | None:
    """Return the values of --input."""
    if not given:
        return None
    pairs = []
    for text in given:
        name, equals, kind = text.partition("=")
        if not (name.strip() and equals and kind.strip()):
            what = f"must be NAME=KIND such as hinge=torque, got {text!r}"
            raise InvalidFile("command line", "--input", what)
        pairs.append((name.strip(), kind.strip()))
    return pairs
