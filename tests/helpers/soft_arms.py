"""A rigid arm of seven joints with a load in its hand, and virtual records of it with effects."""

from collections.abc import Sequence

import numpy as np

from flexarm import Arm, Record, Signal
from flexarm.arm.effect import Effect
from flexarm.comparison.poses import solve_poses
from flexarm.record import Frame

JOINTS = ("j1", "j2", "j3", "j4", "j5", "j6", "j7")
AXES = ([0, 0, 1], [0, 1, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0])
LENGTHS = (0.3, 0.7, 0.3, 0.3, 0.2, 0.2, 0.2)
NOISE = 1e-4
"""Of a tracker [m]."""


def soft_arm(count: int = 7) -> Arm:
    """Return the rigid arm of the first joints; 20 kg hang off the axis of the last link."""
    joints, links, parent, reach = [], [], "base", 0.0
    for name, axis, length in zip(JOINTS[:count], AXES, LENGTHS, strict=False):
        joints.append({"name": name, "type": "revolute", "parent": parent, "child": f"l{name}",
                       "origin": {"xyz": [reach, 0, 0]}, "axis": axis})  # fmt: skip
        links.append({"name": f"l{name}", "type": "rigid", "mass": 30 * length, "com": [length / 2, 0, 0.05],
                      "inertia": [length, length, length]})  # fmt: skip
        parent, reach = f"l{name}", length
    hand = {"name": "hand", "link": parent, "position": [0.1, 0.1, 0.15], "mass": 20.0}
    tip = {"name": "tip", "link": parent, "position": [0.1, 0.05, 0.1]}
    return Arm.from_dict({"format": "flexarm-arm/1", "name": "arm", "joints": joints, "links": links,
                          "payloads": [hand], "points": [tip]})  # fmt: skip


def poses_of(effects: Sequence[Effect], seed: int, poses: int = 40, count: int = 7) -> Record:
    """Return poses of the arm with effects, drawn from a seed, seen by a tracker that stands anywhere."""
    rng, arm = np.random.default_rng(seed), soft_arm(count)
    names = np.array([str(k) for k in range(poses)])
    drives = [
        Signal(name=joint, quantity="joint_angle", joint=joint, side="motor", pose=names, file="joints.csv",
               values=rng.uniform(-1.5, 1.5, (poses, 1)))
        for joint in JOINTS[:count]
    ]  # fmt: skip
    tip = Signal(name="tip", quantity="position", point="tip", values=np.zeros((poses, 3)), pose=names,
                 frame="tracker", noise_std=NOISE, file="tip.csv")  # fmt: skip
    bare = Record(kind="static", signals=[*drives, tip], drive=JOINTS[:count],
                  frames={"tracker": Frame(unknown=True)})  # fmt: skip
    for effect in effects:
        arm = arm.with_effect(effect)
    places = solve_poses(arm, bare).position[:, 0]
    seen = places - [1.0, 2.0, 0.5] + NOISE * rng.standard_normal((poses, 3))
    return bare.replace(signals=[*drives, tip.replace(values=seen)])
