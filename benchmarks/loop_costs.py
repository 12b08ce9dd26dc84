"""What closed loops cost a step: beside the same arm as a tree, and of 1 to 20 loops in a row.

    python benchmarks/loop_costs.py [--rounds 5]

The crane of `examples/crane.toml` is lifted within 4 s in steps of 2 ms. The tree is the same arm without its
closure, all three joints driven as they move in the loop. A row of n parallelograms, each with a beam of two
elements and a guide of a rigid bar, stands on the hand of the one before; as a tree, guides and wrists are
driven, too. Each figure is the least CPU time of the rounds, model and results included.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Mapping
from pathlib import Path

import measure
import numpy as np

import flexarm

CRANE = Path(__file__).resolve().parents[1] / "examples" / "crane.toml"
LOOPS = (1, 2, 5, 10, 20)
STEP, END = 2e-3, 4.0
TIME = np.linspace(0, END, 401)
RISE = np.sin(np.pi * TIME / (2 * END)) ** 2
MATERIAL = {"youngs_modulus": 70e9, "poisson_ratio": 0.33, "density": 2700}


def hinge(name: str, parent: str, child: str, x: float, z: float) -> dict[str, object]:
    """A revolute joint in the x-z plane."""
    origin = {"xyz": [x, 0, z]}
    return {
        "name": name,
        "type": "revolute",
        "parent": parent,
        "child": child,
        "origin": origin,
        "axis": [0, -1, 0],
    }


def row(count: int) -> flexarm.Arm:
    """A row of parallelograms."""
    links, joints, closures = [], [], []
    for k in range(count):
        before = f"hand{k - 1}" if k else "base"
        section = {"shape": "rectangle", "width": 0.04, "height": 0.06}
        lower = {
            "name": f"lower{k}",
            "type": "beam",
            "end": [0.5, 0, 0],
            "up": [0, 0, 1],
            "section": section,
            "material": MATERIAL,
        }
        guide = {
            "name": f"guide{k}",
            "type": "rigid",
            "mass": 1,
            "com": [0.25, 0, 0],
            "inertia": [1e-3, 0.02, 0.02],
        }
        hand = {"name": f"hand{k}", "type": "rigid", "mass": 0.5, "com": [0, 0, 0.1], "inertia": [1e-3] * 3}
        links += [{**lower, "elements": 2}, guide, hand]
        joints += [
            hinge(f"a{k}", before, f"lower{k}", 0.0, 0.0),
            hinge(f"b{k}", before, f"guide{k}", 0.0, 0.2),
            {**hinge(f"c{k}", f"lower{k}", f"hand{k}", 0.0, 0.0), "at": "end"},
        ]
        ends = {
            "a": f"guide{k}",
            "a_origin": {"xyz": [0.5, 0, 0]},
            "b": f"hand{k}",
            "b_origin": {"xyz": [0, 0, 0.2]},
        }
        closures.append({"name": f"eye{k}", "type": "revolute", "axis": [0, -1, 0], **ends})
    return flexarm.Arm.from_dict(
        {
            "name": f"{count} loops",
            "gravity": [0, 0, 0],
            "links": links,
            "joints": joints,
            "closures": closures,
        }
    )


def seconds(arm: flexarm.Arm, motion: Mapping[str, np.ndarray], rounds: int, **options: object) -> float:
    """Least CPU time of a step [s]."""
    drive, found = flexarm.Drive.from_samples(TIME, motion), []
    for _ in range(rounds):
        began = time.process_time()
        run = flexarm.simulate(arm, drive, step=STEP, **options)
        found.append(time.process_time() - began)
    return min(found) / (len(run.time) - 1)


def beside_tree(name: str, arm: flexarm.Arm, driven: Mapping[str, np.ndarray], rounds: int) -> float:
    """Print the cost of a step in loops and as a tree; return the first, without consistent forces."""
    run = flexarm.simulate(arm, flexarm.Drive.from_samples(TIME, driven), step=TIME[1])
    every = dict(zip((joint.name for joint in arm.moving_joints), run.joint_angle.T, strict=True))
    tree = arm.replace(closures=(), assembly={})
    cells, costs = [], []
    for consistent in (False, True):
        loop = seconds(arm, driven, rounds, consistent_forces=consistent)
        cells.append(f"{1e6 * loop:.3g}")
        for dimension in ("space", "auto"):
            beside = seconds(tree, every, rounds, consistent_forces=consistent, dimension=dimension)
            cells.append(f"{1e6 * beside:.3g} ({loop / beside:.2f})")
        costs.append(loop)
    print(f"| {name} | " + " | ".join(cells) + " |", flush=True)
    return costs[0]


def main() -> None:
    """Print a line a case."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    print(measure.machine())
    kinds = "in loops | as a tree in space (ratio) | as a tree in the plane (ratio)"
    print(f"| microseconds a step | {kinds} | consistent forces: {kinds} |")
    print("|---" * 7 + "|")
    beside_tree("crane", flexarm.Arm.from_toml(CRANE), {"piston": 0.6 * RISE}, rounds)
    costs = []
    for n in LOOPS:
        shoulders = {f"a{k}": 0.1 * RISE for k in range(n)}
        costs.append(beside_tree(f"{n} loops", row(n), shoulders, rounds))
    slope = np.polyfit(np.log(LOOPS[2:]), np.log(costs[2:]), 1)[0]
    print(f"exponent of the cost over the number of loops, 5 to 20: {slope:.2f}")


if __name__ == "__main__":
    main()
