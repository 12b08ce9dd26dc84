"""The paper's experiment in length: 133 s of the swing at steps of 2 ms, with 4 and 20 segments."""

from dataclasses import asdict

import measure

END, STEPS = 133.0, 66500

GOALS = {4: 0.05, 20: 0.2}
"""CPU seconds that flexarm's solver may need."""

MEDIUM = (1e-5, 1e-4)

COMPETITORS = {
    "exudyn-2d, quadratic": ("exudyn-2d", {"nodes": 3, "tolerance": MEDIUM}),
    "exudyn-2d, linear": ("exudyn-2d", {"nodes": 2, "tolerance": MEDIUM}),
}


def compare(pythons, repetitions, segments=(4, 20)):
    """CPU seconds of every code for each number of segments."""
    table = []
    for n in segments:
        case = {"elements": n, "end": END, "steps": STEPS}
        orders = {"flexarm": (pythons["flexarm"], "flexarm", case)}
        orders["flexarm, in space"] = (pythons["flexarm"], "flexarm", {**case, "dimension": "space"})
        for name, (code, more) in COMPETITORS.items():
            if code in pythons:
                orders[name] = (pythons[code], code, {**case, **more})
        seen = measure.alternate(orders, repetitions, solves=1)
        rows = {}
        for name, row in seen.items():
            rows[name] = {key: asdict(measure.Spread.of(row[key])) for key in ("solver", "process")}
            rows[name]["solver over flexarm"] = asdict(
                measure.ratio(row["solver"], seen["flexarm"]["solver"])
            )
            rows[name]["memory"] = max(row["memory"])
            rows[name]["offset"] = row["offsets"][-1]
        table.append({"segments": n, "goal": GOALS.get(n), "codes": rows})
    return table


def lines(table):
    """The table as Markdown."""
    yield "| segments | code | solver CPU (s) | x flexarm | process CPU (s) | memory (MB) | at 15 s (mm) |"
    yield "|---|---|---|---|---|---|---|"
    for entry in table:
        for name, row in entry["codes"].items():
            goal = f" (goal {entry['goal']:g})" if name == "flexarm" and entry["goal"] else ""
            yield (
                f"| {entry['segments']} | {name} | {measure.Spread(**row['solver']).text()}{goal} "
                f"| {measure.Spread(**row['solver over flexarm']).text()} "
                f"| {measure.Spread(**row['process']).text()} | {row['memory']:.0f} | {row['offset']:.4f} |"
            )
