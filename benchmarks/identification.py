"""60 s of motion as an identification runs them over and over: 4 segments, a noisy encoder as drive.

The arm is that of the swing with the damping of the virtual mock-up (docs/mockup.md) in tube and hub, or in
the tube alone. Undamped, the oscillation that the start leaves behind would go on and drift in phase, by more
the longer the run. The encoder reads the angle of problem.py at 250 Hz with 5e-6 rad of noise; it is smoothed
once, and the smoothed drive is the same for every run. The step is the longest one that leaves the tip, at
the instants of a tracker,

    max |x_h(t_k) - x(t_k)| <= 1e-5 m,   t_k = 0, 0.1, 0.2, ... s                                    (1)

from the converged motion x of the same drive: twice the segments, and two short steps h and h/2 extrapolated,
x = x_{h/2} + (x_{h/2} - x_h)/3. The next shorter step must reach it, too. One process: JSON in, JSON out.
"""

import json
import sys
from functools import cache
from itertools import pairwise
from statistics import median

import numpy as np
import problem

SEGMENTS, END, LIMIT = 4, 60.0, 1e-5  # -, s, m
RATE, NOISE, SEED = 250.0, 5e-6, 1  # Hz, rad, -
TRACKER_RATE = 10.0  # Hz
TUBE_DAMPING, HUB_DAMPING = 0.005, 600.0  # -, N m s/rad
STEPS = tuple(1000 * k for k in (10, 12, 13, 14, 15, 17, 20, 24, 30, 40, 45, 50, 60))
"""Steps in 60 s that are tried, from 6 to 1 ms."""
FINE = 60_000
"""Steps of the coarser of the two converged runs: 1 ms."""


@cache
def smoothed_drive():
    """What identification makes of the encoder's record, once."""
    import flexarm
    from flexarm.measurement import smooth

    time = np.arange(0.0, END + 0.5 / RATE, 1 / RATE)
    noise = NOISE * np.random.default_rng(SEED).standard_normal(len(time))
    motion = flexarm.JointDrive(*smooth(time, problem.angle(time) + noise, NOISE))
    return flexarm.Drive({"hinge": motion}, end=END)


def damped_arm(segments, hub):
    """The swing's arm with damping in its tube, and so much in its hub [N m s/rad]."""
    from solve_flexarm import swinging_arm

    arm = swinging_arm(segments)
    tube = tuple(link.replace(damping_ratio=TUBE_DAMPING) for link in arm.links)
    return arm.replace(links=tube, effects=tuple(effect.replace(damping=hub) for effect in arm.effects))


def tip(arm, steps):
    """Positions at the tracker's instants [m], and the run's CPU seconds."""
    from solve_flexarm import timed

    run, seconds = timed(arm, smoothed_drive(), END / steps, END)
    instants = np.arange(0.0, END + 0.5 / TRACKER_RATE, 1 / TRACKER_RATE)
    return run.at(np.minimum(instants, run.time[-1]), "tip"), seconds


def converged(hub):
    """x of equation (1)."""
    arm = damped_arm(2 * SEGMENTS, hub)
    coarse, fine = tip(arm, FINE)[0], tip(arm, 2 * FINE)[0]
    return fine + (fine - coarse) / 3


def fewest_steps(error_of):
    """The longest step that reaches (1), and whose next shorter one does."""
    counts = sorted(error_of)
    for steps, more in pairwise(counts):
        if error_of[steps] <= LIMIT and error_of[more] <= LIMIT:
            return steps
    raise RuntimeError(f"no step of {counts} reaches {LIMIT:g} m: {error_of}")


def measure_run(hub, repetitions):
    """The chosen step, its error, and CPU seconds of repeated runs."""
    known, arm = converged(hub), damped_arm(SEGMENTS, hub)
    error_of = {steps: float(np.linalg.norm(tip(arm, steps)[0] - known, axis=1).max()) for steps in STEPS}
    steps = fewest_steps(error_of)
    seconds = [tip(arm, steps)[1] for _ in range(repetitions)]
    return {"steps": steps, "error": error_of[steps], "cpu": seconds}


def measure_both(repetitions):
    """With damping in the hub as well as in the tube, and in the tube alone."""
    return {
        "damped in tube and hub": measure_run(HUB_DAMPING, repetitions),
        "damped in the tube alone": measure_run(0.0, repetitions),
    }


def lines(result):
    """The result in words."""
    for name, seen in result.items():
        yield (
            f"{name}: {seen['steps']} steps of {1e3 * END / seen['steps']:.3g} ms, tip within "
            f"{1e6 * seen['error']:.2g} um: {1e3 * median(seen['cpu']):.3g} ms"
        )


if __name__ == "__main__":
    print(json.dumps(measure_both(**json.loads(sys.argv[1]))))
