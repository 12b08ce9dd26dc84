"""The swing benchmark: cheapest settings that reach an error, then their cost, code against code.

A setting (elements, step, Newton tolerance) reaches an error if it and the next finer step stay below it, so
that an error that passes through zero by chance does not count.
"""

import statistics
from dataclasses import asdict

import measure
import problem

STEPS = (2000, 2400, 3000, 4000, 5000, 6000, 8000, 10000, 12000, 16000, 20000, 30000, 40000)
"""Steps in 20 s: from 10 to 0.5 ms, such that every instant of comparison is an instant of the run."""

MEDIUM, FAIR, LOOSE = (1e-5, 1e-4), (1e-4, 1e-3), (1e-3, 1e-3)  # Newton's relative, absolute tolerance

GRIDS = {
    "flexarm": {"elements": (1, 2, 3, 4), "steps": STEPS},
    "exudyn-2d": {"elements": (1, 2, 3, 4), "steps": STEPS, "tolerance": (MEDIUM, LOOSE)},
    "exudyn-3d": {"elements": (8, 10, 12), "steps": (3000, 4000, 5000), "tolerance": (FAIR, LOOSE)},
    "exudyn-manual": {"elements": (4, 8, 12, 16), "steps": (2400, 3000, 4000), "nodes": (2,)},
}
FINE_GRIDS = {
    "exudyn-3d": {"elements": (28,), "steps": (10000, 12000), "increments": (1e-7,)},
    "exudyn-manual": {"elements": (32, 40), "steps": (8000, 10000), "nodes": (2,), "tolerance": (MEDIUM,)},
}
"""Settings tried; the fine ones only where 0.01 mm is wanted of a code that needs long for it."""

QUICK_GRIDS = {
    "flexarm": {"elements": (1, 2), "steps": (3000, 4000, 8000, 10000)},
    "exudyn-2d": {"elements": (2,), "steps": (3000, 4000, 6000, 8000), "tolerance": (MEDIUM, LOOSE)},
}


def cases(grid):
    """All settings of a grid."""
    found = [{"end": problem.END}]
    for key, values in grid.items():
        found = [{**case, key: value} for case in found for value in values]
    return found


def explore(python, code, grid):
    """Error [mm] and CPU seconds of every setting that the code could solve."""
    tried = cases(grid)
    solved = measure.run(python, "worker.py", {"code": code, "cases": tried, "solves": 4}).answer["results"]
    return [
        {"case": case, "error": problem.error(result["offsets"]), "cpu": min(result["cpu"])}
        for case, result in zip(tried, solved, strict=True)
        if "failed" not in result
    ]


def cheapest(tried, limit):
    """The cheapest setting that reaches an error [mm]; None if there is none."""

    def finer(one):
        rest = [
            other
            for other in tried
            if {**other["case"], "steps": 0} == {**one["case"], "steps": 0}
            and other["case"]["steps"] > one["case"]["steps"]
        ]
        return min(rest, key=lambda other: other["case"]["steps"], default=None)

    good = [
        one
        for one in tried
        if one["error"] <= limit and (next_one := finer(one)) is not None and next_one["error"] <= limit
    ]
    return min(good, key=lambda one: one["cpu"], default=None)


def check_theories(pythons):
    """Error of fine runs against the converged values of each theory [mm]: are the models the same?"""
    fine = {"elements": 8, "steps": 40000, "end": problem.END}
    table = {}
    for code, theories in {
        "flexarm": ("timoshenko", "euler-bernoulli"),
        "exudyn-2d": ("timoshenko", "timoshenko without rotary inertia"),
    }.items():
        if code not in pythons:
            continue
        order = {"code": code, "cases": [{**fine, "theory": theory} for theory in theories]}
        results = measure.run(pythons[code], "worker.py", order).answer["results"]
        for theory, result in zip(theories, results, strict=True):
            table[f"{code}, {theory}"] = problem.error(result["offsets"], theory)
    return table


def compare(pythons, limits, repetitions, quick=False):
    """For each error limit [mm] the cheapest setting of every code, and what it costs.

    Parameters
    ----------
    pythons : dict of code to interpreter
        Codes to compare; "flexarm" is one of them.
    limits : sequence of float
        Errors to reach [mm].
    repetitions : int
        Rounds of the timing.
    """
    grids = QUICK_GRIDS if quick else GRIDS
    tried = {code: explore(pythons[code], code, grids[code]) for code in pythons if code in grids}
    table = []
    for limit in limits:
        chosen = {}
        for code in tried:
            best = cheapest(tried[code], limit)
            if best is None and limit >= 0.01 and code in FINE_GRIDS and not quick:
                tried[code] += explore(pythons[code], code, FINE_GRIDS[code])
                best = cheapest(tried[code], limit)
            if best is not None:
                chosen[code] = best
        # Seconds instead of milliseconds a run need no repetition within a process.
        slow = {code for code, best in chosen.items() if best["cpu"] > 1}
        orders = {c: (pythons[c], c, best["case"]) for c, best in chosen.items() if c not in slow}
        seen = measure.alternate(orders, repetitions)
        seen |= _slow({c: (pythons[c], c, chosen[c]["case"]) for c in slow}, repetitions)
        table.append({"limit": limit, "codes": _rows(chosen, seen)})
    return {"tried": tried, "table": table}


def _slow(orders, repetitions):
    """As measure.alternate, but a third of the rounds and one solve in each, spread to equal lengths."""
    seen = measure.alternate(orders, max(1, repetitions // 3), solves=1) if orders else {}
    for row in seen.values():
        for key in ("solver", "process", "memory"):
            row[key] = [statistics.median(row[key])] * repetitions
    return seen


def _rows(chosen, seen):
    rows = {}
    for code, best in chosen.items():
        row = seen[code]
        rows[code] = {
            "case": best["case"],
            "error": problem.error(row["offsets"]),
            "solver": asdict(measure.Spread.of(row["solver"])),
            "process": asdict(measure.Spread.of(row["process"])),
            "memory": max(row["memory"]),
        }
        if "flexarm" in seen:
            for key in ("solver", "process"):
                spread = measure.ratio(row[key], seen["flexarm"][key])
                rows[code][f"{key} over flexarm"] = asdict(spread)
    return rows


def lines(result):
    """The table as Markdown."""
    columns = "error at most", "code", "elements, step", "error (mm)"
    columns += "solver CPU (s)", "x flexarm", "process CPU (s)", "x flexarm"
    yield f"| {' | '.join(columns)} |"
    yield "|---" * len(columns) + "|"
    for entry in result["table"]:
        for code, row in entry["codes"].items():
            case, spreads = row["case"], {k: measure.Spread(**row[k]) for k in ("solver", "process")}
            ratios = {k: measure.Spread(**row[f"{k} over flexarm"]) for k in spreads}
            step = 1e3 * case["end"] / case["steps"]
            yield (
                f"| {entry['limit']:g} mm | {code} | {case['elements']}, {step:.3g} ms | {row['error']:.4f} "
                f"| {spreads['solver'].text()} | {ratios['solver'].text()} "
                f"| {spreads['process'].text()} | {ratios['process'].text()} |"
            )
