"""`flexarm modes`: natural frequencies about the loaded equilibrium."""

from __future__ import annotations

from typing import Annotated

import typer

from flexarm.cli.options import JointValues, Json, Model, blame, joint_values, load_arm, print_json


def modes(
    model: Model,
    joint: JointValues = None,
    count: Annotated[int, typer.Option("--count", min=1, metavar="N", help="How many modes.")] = 6,
    no_gravity: Annotated[
        bool, typer.Option("--no-gravity", help="Without gravity and its stiffness.")
    ] = False,
    json: Json = False,
) -> None:
    """Compute natural frequencies about the equilibrium.

    Frequencies [Hz] and damping ratios about the equilibrium under gravity, the joints' drives held; and the
    joint or link that gives most of each motion, with its share and direction.

        flexarm modes arm.toml
        flexarm modes arm.toml --joint hinge=1.57 --count 10
    """
    arm = load_arm(model)
    values = joint_values(arm, model, joint)
    from flexarm.modal import modes as solve  # NumPy and the core, not needed for --help

    with blame(model):
        result = solve(arm, joints=values, count=count, gravity=not no_gravity)
    if json:
        print_json(result.to_json_dict())
    else:
        from flexarm.viewer.stages import moving_parts

        lines = result.summary().splitlines()
        told = ["moves most", *moving_parts(result)] if len(result.frequency_hz) else []
        lines[1:] = [f"{line}   {part}" for line, part in zip(lines[1:], told, strict=True)]
        print("\n".join(lines))
