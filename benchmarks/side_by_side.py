"""Arms side by side in vector registers: CPU time of a variant in `simulate_all`, beside its run alone.

The arm of identification.py with 4 and 20 segments, in variants of modulus, payload and hub, along one drive:

    ratio = CPU seconds of all variants one by one over those of `simulate_all` with one thread       (1)

One process: JSON in, JSON out.
"""

import json
import sys
import time
from statistics import median

import identification
import numpy as np

VARIANTS, SEED, STEP = 16, 1, 4e-3  # -, -, s


def variants(segments):
    """Arms whose numbers differ by some per cent."""
    arm = identification.damped_arm(segments, identification.HUB_DAMPING)
    rng = np.random.default_rng(SEED)
    found = []
    for _ in range(VARIANTS):
        link, load, hub = arm.links[0], arm.payloads[0], arm.effects[0]
        stiffer = link.material.replace(youngs_modulus=link.material.youngs_modulus * rng.uniform(0.95, 1.05))
        found.append(
            arm.replace(
                links=(link.replace(material=stiffer), *arm.links[1:]),
                payloads=(load.replace(mass=load.mass * rng.uniform(0.95, 1.05)), *arm.payloads[1:]),
                effects=(hub.replace(stiffness=hub.stiffness * rng.uniform(0.9, 1.1)), *arm.effects[1:]),
            )
        )
    return found


def measure(segments, repetitions):
    """CPU seconds of all variants, one by one and together, in turns."""
    import flexarm

    arms, drive = variants(segments), identification.smoothed_drive()
    options = {"step": STEP, "end": identification.END}
    seen = {"alone": [], "together": []}
    for _ in range(repetitions):
        began = time.process_time()
        alone = [flexarm.simulate(arm, drive, **options) for arm in arms]
        middle = time.process_time()
        together = flexarm.simulate_all([(arm, drive) for arm in arms], jobs=1, **options)
        seen["together"].append(time.process_time() - middle)
        seen["alone"].append(middle - began)
    apart = max(np.abs(a.position - b.position).max() for a, b in zip(alone, together, strict=True))
    return {**seen, "variants": len(arms), "apart": float(apart), "segments": segments}


def lines(result):
    """The result in words."""
    for each in result:
        alone, together = (median(each[name]) / each["variants"] for name in ("alone", "together"))
        ratio = median(a / b for a, b in zip(each["alone"], each["together"], strict=True))
        yield (
            f"{each['segments']} segments: {1e3 * alone:.3g} ms alone, {1e3 * together:.3g} ms side by side, "
            f"{ratio:.3g} times faster; {each['apart']:.1e} m apart"
        )


if __name__ == "__main__":
    order = json.loads(sys.argv[1])
    print(json.dumps([measure(segments, order["repetitions"]) for segments in (4, 20)]))
