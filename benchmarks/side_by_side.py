"""Arms side by side in vector registers: CPU time of a variant in `simulate_all`, beside its run alone.

The arm of identification.py with 4 and 20 segments, and examples/three_joints.toml without friction, in
variants of modulus, payload and hub, along one drive:

    ratio = CPU seconds of all variants one by one over those of `simulate_all` with one thread       (1)

One process: JSON in, JSON out.
"""

import json
import sys
import time
from pathlib import Path
from statistics import median

import identification
import numpy as np

VARIANTS, SEED, STEP = 16, 1, 4e-3  # -, -, s


def variants(arm):
    """Arms whose numbers differ by some per cent."""
    rng = np.random.default_rng(SEED)
    found = []
    for _ in range(VARIANTS):
        *links, link = arm.links
        *payloads, load = arm.payloads
        hub, *effects = arm.effects
        stiffer = link.material.replace(youngs_modulus=link.material.youngs_modulus * rng.uniform(0.95, 1.05))
        found.append(
            arm.replace(
                links=(*links, link.replace(material=stiffer)),
                payloads=(*payloads, load.replace(mass=load.mass * rng.uniform(0.95, 1.05))),
                effects=(hub.replace(stiffness=hub.stiffness * rng.uniform(0.9, 1.1)), *effects),
            )
        )
    return found


def robot():
    """The arm in space, and a motion of its three joints over 20 s."""
    import flexarm

    arm = flexarm.Arm.load(Path(__file__).parent.parent / "examples" / "three_joints.toml")
    time = np.linspace(0, 20, 401)
    swings = {"waist": (0.9, 0.4), "shoulder": (0.7, 0.5), "elbow": (-1.0, 0.6)}
    motion = {name: far * np.sin(rate * time) ** 2 for name, (far, rate) in swings.items()}
    smooth = tuple(effect for effect in arm.effects if effect.name != "coulomb_friction")
    return arm.replace(effects=smooth), flexarm.Drive.from_samples(time, motion)


def measure(name, arm, drive, repetitions, **options):
    """CPU seconds of all variants, one by one and together, in turns."""
    import flexarm

    arms = variants(arm)
    seen = {"alone": [], "together": []}
    for _ in range(repetitions):
        began = time.process_time()
        alone = [flexarm.simulate(arm, drive, **options) for arm in arms]
        middle = time.process_time()
        together = flexarm.simulate_all([(arm, drive) for arm in arms], n_jobs=1, **options)
        seen["together"].append(time.process_time() - middle)
        seen["alone"].append(middle - began)
    apart = max(np.abs(a.position - b.position).max() for a, b in zip(alone, together, strict=True))
    return {**seen, "variants": len(arms), "apart": float(apart), "name": name}


def measure_all(repetitions):
    """Both arms in the plane, and the one in space."""
    drive = identification.smoothed_drive()
    planar = {"step": STEP, "end": identification.END}
    for segments in (4, 20):
        arm = identification.damped_arm(segments, identification.HUB_DAMPING)
        yield measure(f"{segments} segments", arm, drive, repetitions, **planar)
    yield measure("three joints in space", *robot(), repetitions, step=2e-3)


def lines(result):
    """The result in words."""
    for each in result:
        alone, together = (median(each[name]) / each["variants"] for name in ("alone", "together"))
        ratio = median(a / b for a, b in zip(each["alone"], each["together"], strict=True))
        yield (
            f"{each['name']}: {1e3 * alone:.3g} ms alone, {1e3 * together:.3g} ms side by side, "
            f"{ratio:.3g} times faster; {each['apart']:.1e} m apart"
        )


if __name__ == "__main__":
    order = json.loads(sys.argv[1])
    print(json.dumps(list(measure_all(order["repetitions"]))))
