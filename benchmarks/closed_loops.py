"""Diagnoses of a crane: ten cases drawn from a seed, each with one hidden cause or none.

    python benchmarks/closed_loops.py [--seed 2026] [--examples]

flexarm itself makes the records, in steps an eighth of those of the diagnosis; `tests/verification` has crane
and records. Each line tells the cause, the verdict, and the names with probability and alternatives. With
`--examples` it diagnoses the examples with closed loops instead (`tests/helpers/loop_examples.py`).
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

import flexarm

ROOT = Path(__file__).resolve().parents[1]
CAUSES = ("nothing", "modulus", "cylinder stiffness", "load", "pin friction")


def hidden(cause: str, size: float, crane: Any) -> flexarm.Arm:
    """Return the crane with a cause of a size from 0 to 1."""
    if cause == "modulus":  # 2 to 10 % less
        return crane.softer(210e9 * (0.9 + 0.08 * size))
    if cause == "cylinder stiffness":  # 2e6 to 3.2e7 N/m
        return crane.crane(effects=[{**crane.COMPLIANCE, "stiffness": 10 ** (6.3 + 1.2 * size)}])
    if cause == "load":  # 2 to 10 % more
        return crane.loaded(500 * (1.02 + 0.08 * size))
    if cause == "pin friction":  # 300 to 1200 N m
        friction = {"name": "coulomb_friction", "at": "boom_pin", "torque": 300 + 900 * size}
        return crane.crane(effects=[friction])
    return crane.crane()


def main() -> None:
    """Print a line a case."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--examples", action="store_true")
    chosen = parser.parse_args()
    rng = np.random.default_rng(chosen.seed)
    sys.path += [str(ROOT / "tests" / folder) for folder in ("helpers", "verification")]
    if chosen.examples:
        from loop_examples import EXAMPLES_IN_MOTION

        for name, example in EXAMPLES_IN_MOTION.items():
            print(f"{name}: {example.hidden(example.arm)}\n{example.diagnosed()}\n", flush=True)
        return
    import test_closures_against_records as crane

    for k in range(10):
        cause, size = CAUSES[k % len(CAUSES)], float(rng.uniform())
        truth, seed = hidden(cause, size, crane), int(rng.integers(1000, 9999))
        slow, quick = crane.record(truth, 1.5, seed), crane.record(truth, 3.0, seed + 1)
        found = flexarm.diagnose(crane.crane(), {"slow": slow}, hold_out=quick, laws=False)
        names = [
            f"{each.name} at {each.at} ({each.probability:.2f}"
            + "".join(f", or {other.name} at {other.at}" for other in each.alternatives)
            + ")"
            for each in found.effects
        ]
        print(f"{cause}, {size:.2f}: {found.verdict}", *names, flush=True)


if __name__ == "__main__":
    main()
