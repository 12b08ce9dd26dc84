"""`flexarm static`: the equilibrium under gravity."""

from __future__ import annotations

from flexarm.cli.options import JointValues, Json, Model, blame, joint_values, load_arm, show


def static(model: Model, joint: JointValues = None, json: Json = False) -> None:
    """Compute the equilibrium under gravity.

    The joints' drives are held. Prints where points are and how far they moved from the rigid arm [m], the
    joints' torques [N m], the section forces of beams and the reaction of the base [N, N m].

        flexarm static arm.toml --joint hinge=0.5
        flexarm static arm.toml --joint shoulder=0.3 --joint elbow=-1.2 --json
    """
    arm = load_arm(model)
    values = joint_values(arm, model, joint)
    from flexarm.statics import static as solve  # NumPy and the core, not needed for --help

    with blame(model):
        result = solve(arm, joints=values)
    show(result, json)
