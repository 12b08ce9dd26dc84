"""What run_reduction.py found, as Markdown, against the goals, and as files."""

import csv
import json

GOALS = {
    "35k": {"times": 3.0},
    "98k": {"times": 6.0, "cpu": 5.0, "memory": 1300.0},
    "300k": {"cpu": 45.0, "memory": 4000.0},
}
"""`times`: faster than SciPy with skill; seconds and MB of flexarm on one thread."""

UNITS = {"times": "times faster than SciPy with skill", "cpu": "s of CPU time", "memory": "MB"}

COLUMNS = ("cpu", "wall", "process")


def lines(table, reach, differences):
    """Costs of every size and code, what was left out, how well the codes agree."""
    yield "| size | code | CPU (s) | x flexarm | wall (s) | memory (MB) | process CPU (s) |"
    yield "|---|---|---|---|---|---|---|"
    for size, rows in table.items():
        for name, row in rows.items():
            times = f"{row['cpu'].median / rows['flexarm']['cpu'].median:.3g}" if "flexarm" in rows else "-"
            yield (
                f"| {size} | {name} | {row['cpu'].text()} | {times} | {row['wall'].median:.3g} "
                f"| {row['memory']:.0f} | {row['process'].median:.3g} |"
            )
        for name in [name for name, sizes in reach.items() if size not in sizes]:
            yield f"| {size} | {name} | not run: beyond its reach | | | | |"
    yield ""
    for size, worst in differences.items():
        yield f"{size}: largest differences " + ", ".join(
            f"{key} {value:.1e}" for key, value in worst.items()
        )


def phases(table):
    """Where flexarm's seconds went."""
    for size, rows in table.items():
        for name, row in rows.items():
            if "factor" not in row["statistics"]:
                continue
            found = row["statistics"]
            seconds = ", ".join(f"{key} {value:.3g}" for key, value in found["seconds"].items())
            yield (
                f"{size} {name}: wall seconds: assembly {row['seconds']['assembly']['wall']:.3g}, {seconds}; "
                f"{found['factor']}, {found['entries']['entries']:.3g} entries, {found['operations']:.3g} "
                f"operations, {found['lanczos']['steps']} blocks of {found['lanczos']['block']}"
            )


def verdicts(table):
    """Each goal beside what was measured."""
    for size, goal in GOALS.items():
        rows = table.get(size, {})
        if "flexarm" not in rows:
            continue
        mine = rows["flexarm"]
        measured = {"cpu": mine["cpu"].median, "memory": mine["memory"]}
        if "scipy, with skill" in rows:
            measured["times"] = rows["scipy, with skill"]["cpu"].median / mine["cpu"].median
        for key in goal.keys() & measured.keys():
            value, wanted = measured[key], goal[key]
            met = value >= wanted if key == "times" else value <= wanted
            yield f"{size}: {value:.3g} {UNITS[key]}, goal {wanted:g}: {'met' if met else 'MISSED'}"


def arm_lines(arms):
    """The 133 s of the arm with a hinge of parts."""
    yield "| hinge of | solver CPU (s) | iterations a step | memory (MB) | tip at 15 s (mm) |"
    yield "|---|---|---|---|---|"
    for name, row in arms.items():
        yield (
            f"| {name} | {row['cpu'].text()} | {row['iterations']:.2f} | {row['memory']:.0f} "
            f"| {row['offsets'][-1]:.4f} |"
        )


def save(folder, everything):
    """reduction.json with everything, reduction.csv with the table of sizes and codes."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "reduction.json").write_text(json.dumps(everything, indent=1, default=vars))
    with (folder / "reduction.csv").open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["size", "code", "cpu_s", "wall_s", "process_cpu_s", "memory_MB", "rounds"])
        for size, codes in everything["sizes"].items():
            for name, row in codes.items():
                seconds = [row[key].median for key in COLUMNS]
                rows.writerow([size, name, *seconds, row["memory"], row["rounds"]])
