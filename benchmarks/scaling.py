"""How the cost of a step grows with segments and joints, and what memory a process holds.

    seconds a step ~ size^p                                                                          (1)

p is fitted to the larger half of the sizes. How far the largest is from linear growth:

    (cost/size) of the largest over the least (cost/size) of all                                     (2)

Cost of a step: difference of two runs of different length over the difference of their steps, so that
assembly and equilibrium do not count.
"""

import json
import sys

import numpy as np

STEP = 2e-3  # s

SEGMENTS = (1, 2, 4, 8, 16, 32, 64, 125, 250, 500, 1000)
JOINTS = (1, 2, 4, 8, 16, 32, 64, 100)
ELEMENTS_OF_A_LINK = 2
CHAIN_SWING = 0.1
"""Part of the swing that the chain's first motor makes; its free end would whip under all of it."""


def steps_for(size):
    """Steps of the longer run, up to 20 s: about equal work for every size, 400 at least."""
    return min(10_000, 400 * max(1, round(100 / size)))


def cost(arm, joint, size, scale, repetitions):
    """CPU seconds a step, from the quickest of several runs of either length, and iterations a step."""
    from solve_flexarm import drive, timed

    steps = steps_for(size)
    motion = drive(joint, 20.0, scale)
    quickest = {}
    for count in (steps // 4, steps) * repetitions:
        run, seconds = timed(arm, motion, STEP, count * STEP)
        quickest[count] = min(seconds, quickest.get(count, seconds))
    per_step = (quickest[steps] - quickest[steps // 4]) / (steps - steps // 4)
    return per_step, run.solver["iterations"] / run.solver["steps"]


def measure_sizes(repetitions, segments=SEGMENTS, joints=JOINTS):
    """Cost of a step for every size, and the exponents (1)."""
    from solve_flexarm import chain, swinging_arm

    families = {
        "segments": [(n, swinging_arm(n), "hinge", 1.0) for n in segments],
        "joints": [(n, chain(n, ELEMENTS_OF_A_LINK), "hinge_0", CHAIN_SWING) for n in joints],
    }
    table = {}
    for family, members in families.items():
        rows = []
        for size, arm, joint, scale in members:
            seconds, iterations = cost(arm, joint, size, scale, repetitions)
            rows.append({"size": size, "step": seconds, "iterations": iterations})
        table[family] = {"rows": rows, "exponent": exponent(rows), "over linear": over_linear(rows)}
    return table


def exponent(rows):
    """p of equation (1), by least squares in logarithms over the larger half of the sizes."""
    larger = rows[len(rows) // 2 :]
    logs = np.log([[row["size"], row["step"]] for row in larger])
    return float(np.polyfit(logs[:, 0], logs[:, 1], 1)[0])


def over_linear(rows):
    """The ratio (2)."""
    each = [row["step"] / row["size"] for row in rows]
    return each[-1] / min(each)


def lines(table):
    """The table as Markdown."""
    for family, result in table.items():
        yield (
            f"Cost of a step ~ {family}^{result['exponent']:.2f}; of the largest, for each of its {family}, "
            f"{result['over linear']:.2f} times the least"
        )
        yield ""
        yield f"| {family} | microseconds a step | iterations a step |"
        yield "|---|---|---|"
        for row in result["rows"]:
            yield f"| {row['size']} | {1e6 * row['step']:.3g} | {row['iterations']:.2f} |"
        yield ""


def main():
    """In a process of its own, as worker.py: prints JSON."""
    order = json.loads(sys.argv[1])
    print(json.dumps(measure_sizes(**order)))


if __name__ == "__main__":
    main()
