"""What derivatives cost: the run of identification.py with 20 parameters, beside the same run without.

    ratio = CPU seconds of the run with its derivatives over those of the plain run                  (1)

Both make the same steps. Candidate models are run by `simulate_all` with one thread and with two,

    gain = wall time with one over that with two                                                     (2)

which means something only where a second core is free. One process: JSON in, JSON out.
"""

import json
import sys
import time
from statistics import median

import identification

EFFECTS = [
    {"name": "viscous_friction", "at": "hinge", "coefficient": 5.0},
    {"name": "base_tilt", "at": "base", "angle": [0.0, 1e-3]},
    {"name": "payload_offset", "at": "load", "offset": [5e-3, 0.0, 0.0]},
    {"name": "link_stiffness", "at": "rod", "scale": 1.01},
    {"name": "link_mass", "at": "rod", "scale": 1.01},
    {"name": "payload_inertia", "at": "load", "inertia": 0.05},
]
PARAMETERS = (
    "links.rod.material.youngs_modulus",
    "links.rod.material.density",
    "links.rod.section.area",
    "links.rod.damping_ratio",
    "links.rod.end.x",
    "links.rod.end.z",
    "payloads.load.mass",
    "payloads.load.position.x",
    "payloads.load.position.z",
    "points.tip.position.x",
    "points.tip.position.z",
    "effects.joint_compliance.hinge.stiffness",
    "effects.joint_compliance.hinge.damping",
    "effects.viscous_friction.hinge.coefficient",
    "effects.base_tilt.base.angle.y",
    "effects.payload_offset.load.offset.x",
    "effects.link_stiffness.rod.scale",
    "effects.link_mass.rod.scale",
    "effects.payload_inertia.load.inertia",
    "links.rod.material.poisson_ratio",
)


def model():
    """The arm of the identification with an effect or two at each place."""
    import flexarm

    arm = identification.damped_arm(identification.SEGMENTS, identification.HUB_DAMPING)
    return flexarm.Arm.from_dict({**arm.to_dict(), "effects": [*arm.to_dict()["effects"], *EFFECTS]})


def measure_ratio(steps, repetitions):
    """CPU seconds with and without derivatives, in turns."""
    from solve_flexarm import timed

    arm, drive, end = model(), identification.smoothed_drive(), identification.END
    seen = {"plain": [], "sensitivities": []}
    for _ in range(repetitions):
        seen["plain"].append(timed(arm, drive, end / steps, end)[1])
        run, seconds = timed(arm, drive, end / steps, end, sensitivities=PARAMETERS)
        seen["sensitivities"].append(seconds)
    return {**seen, "parameters": len(run.sensitivities.keys)}


def measure_threads(steps, candidates=16, rounds=4):
    """Least wall seconds of the candidates one after another, and by two threads, in turns.

    The first round is left out: a process's first runs take longer, whoever makes them.
    """
    import flexarm

    arm, drive, end = model(), identification.smoothed_drive(), identification.END
    runs = [(arm.replace(gravity=(0.0, 0.0, -9.81 + 1e-3 * k)), drive) for k in range(candidates)]
    seconds = {1: [], 2: []}
    for _ in range(rounds):
        for jobs, taken in seconds.items():
            began = time.perf_counter()
            flexarm.simulate_all(runs, n_jobs=jobs, step=end / steps, end=end)
            taken.append(time.perf_counter() - began)
    return {"one": min(seconds[1][1:]), "two": min(seconds[2][1:])}


def lines(result):
    """The result in words."""
    plain, derived, threads = median(result["plain"]), median(result["sensitivities"]), result["threads"]
    yield (
        f"{result['parameters']} parameters: {derived:.3g} s, {derived / plain:.3g} times the plain run of "
        f"{1e3 * plain:.3g} ms; two threads {threads['one'] / threads['two']:.3g} times faster than one"
    )


if __name__ == "__main__":
    order = json.loads(sys.argv[1])
    print(json.dumps({**measure_ratio(**order), "threads": measure_threads(order["steps"])}))
