"""CPU seconds of the flexarm that this Python has: `python benchmarks/installed.py [10k|35k|98k]`.

A swing of examples/three_joints.toml and the reduction of the ring of ring.py. Run it
in an environment with the BSD wheel and in one with the full wheel to compare them.
"""

import sys
import time
from pathlib import Path

import numpy as np
import reduce_flexarm
import ring

import flexarm
from flexarm import _core

REPEATS = 3
EXAMPLE = Path(__file__).parents[1] / "examples" / "three_joints.toml"


def fastest(work):
    """CPU seconds of the fastest of some runs."""
    seconds = []
    for _ in range(REPEATS):
        start = time.process_time()
        work()
        seconds.append(time.process_time() - start)
    return min(seconds)


def swing():
    """20 s of a spatial arm of three joints, from rest to rest, in steps of 1 ms."""
    arm = flexarm.Arm.from_toml(EXAMPLE)
    instants = np.linspace(0, 20, 5001)
    angle = 0.6 * np.sin(np.pi / 2 * (instants / 20) ** 2) ** 2
    drive = flexarm.Drive.from_samples(instants, {joint.name: angle for joint in arm.moving_joints})
    return lambda: flexarm.simulate(arm, drive, step=1e-3)


def main(size="10k"):
    """Print the seconds of both."""
    part = ring.mesh(size)
    K, M = reduce_flexarm.assemble(part, threads=1)
    info = _core.build_info()
    print(f"{info.solver}; CHOLMOD {info.cholmod}; BLAS {info.blas}")
    print(f"simulate, 20 s of three joints: {fastest(swing()):.2f} s")
    print(f"reduction of the ring {size}: {fastest(lambda: reduce_flexarm.reduce(part, K, M)):.2f} s")


if __name__ == "__main__":
    main(*sys.argv[1:])
