"""Robots of rigid links have masses of links that may be wrong."""

import numpy as np
from arms import arm, hinge, rigid

import flexarm
from flexarm.record import Record, Signal

LINKS = [
    rigid("upper", 40.0, [0, 0, 0.4], [2.0, 2.0, 0.2]),
    rigid("fore", 15.0, [0, 0, 0.3], [0.5, 0.5, 0.1]),
    rigid("flange", 0.0),
]


def robot() -> flexarm.Arm:
    return arm(
        joints=[
            hinge("shoulder", "upper"),
            hinge("elbow", "fore", parent="upper", origin={"xyz": [0, 0, 0.9]}),
            {"name": "wrist", "type": "fixed", "parent": "fore", "child": "flange"},
        ],
        links=LINKS,
    )


def poses(model: flexarm.Arm, seed: int) -> Record:
    """Holding torques of both joints in 20 poses, 0.5 N m of noise."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.5, 1.5, (20, 2))
    held = [flexarm.static(model, {"shoulder": a, "elbow": b}).joint_torque[:2] for a, b in q]
    torque = np.array(held) + 0.5 * rng.standard_normal((20, 2))
    pose = np.arange(20)
    signals = []
    for k, joint in enumerate(("shoulder", "elbow")):
        place = {"joint": joint, "pose": pose}
        signals += [
            Signal(name=joint, quantity="joint_angle", side="motor", values=q[:, k], noise_std=1e-6, **place),
            Signal(
                name=f"{joint}_torque",
                quantity="motor_torque",
                side="output",
                values=torque[:, k],
                noise_std=0.5,
                **place,
            ),
        ]
    return Record(signals=signals, drive=["shoulder", "elbow"], kind="static")


def test_the_mass_of_a_rigid_link_is_named():
    heavy = robot().with_effect(flexarm.effects.LinkMass(at="fore", scale=1.2))
    found = flexarm.diagnose(robot(), {"run": poses(heavy, 1)}, hold_out=poses(heavy, 2), n_jobs=1)
    (effect,) = found.effects
    assert (effect.name, effect.at) == ("link_mass", "fore")
    (scale,) = effect.parameters
    assert scale.low90 < 1.2 < scale.high90
    assert not any("flange" in str(other.at) for other in effect.alternatives)  # weighs nothing
