"""Reduction of solid parts beside SciPy and EXUDYN: `python benchmarks/run_reduction.py [--quick]`.

The ring of ring.py with 10, 35 and 98, if wanted 300 thousand degrees of freedom, every run in a process of
its own, all codes on the same K and M. flexarm's seconds include the assembly of these, those of the others
do not. Then 133 s of an arm whose hinge is three such rings. Run it with the interpreter that has flexarm.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import agreement
import measure
import reduction_table as tables

SIZES = ("10k", "35k", "98k", "300k")

NAMES = {
    "flexarm": "flexarm",
    "flexarm, two threads": "flexarm",
    "scipy, with skill": "scipy-skilled",
    "scipy, as usually written": "scipy",
    "exudyn": "exudyn",
}
"""Competitor -> code of reduce_worker.py."""

REACH = {
    "scipy, with skill": ("10k", "35k", "98k"),
    "scipy, as usually written": ("10k", "35k"),
    "exudyn": ("10k", "35k"),
}
"""Sizes of those that do not reach all: beyond, their factor takes many minutes and GB."""

QUICK = ("flexarm", "flexarm, two threads", "scipy, with skill")

ENOUGH = 60.0
"""CPU seconds of one competitor at one size after which its runs are not repeated."""

ARMS = {"super-elements, 20 modes": {"modes": 20}, "super-elements, no modes": {"modes": 0}, "beams": {}}
"""Hinge of the arm -> order of arm_of_parts.py."""


def options(arguments=None):
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="smallest part, once, quick codes: a minute")
    parser.add_argument("--largest", choices=SIZES, default="98k", help="leave out larger parts")
    parser.add_argument("--rounds", type=int, default=3, help="of each timing; slow codes run once")
    parser.add_argument("--only", choices=list(NAMES), action="append", help="this code; may be repeated")
    parser.add_argument("--no-arm", action="store_true", help="leave out the moving arm")
    parser.add_argument("--no-exudyn", action="store_true", help="leave out EXUDYN")
    parser.add_argument("--exudyn-python", help="interpreter that has EXUDYN and SciPy")
    parser.add_argument("--out", type=Path, help="folder for reduction.json and reduction.csv")
    return parser.parse_args(arguments)


def competitors(chosen):
    """Name -> interpreter."""
    wanted = chosen.only or (QUICK if chosen.quick else NAMES)
    names = [name for name in NAMES if name in wanted and not (name == "exudyn" and chosen.no_exudyn)]
    pythons = dict.fromkeys(names, sys.executable)
    if "exudyn" in pythons:
        pythons["exudyn"] = measure.exudyn_python(chosen.exudyn_python)
    return pythons


def measure_size(size, pythons, rounds, folder):
    """All competitors in turns; name -> list of runs."""
    say(f"{size}: writing K and M")
    order = {"code": "write", "size": size, "file": str(folder / f"{size}.npz")}
    measure.run(sys.executable, "reduce_worker.py", order)
    runs = {name: [] for name in pythons if size in REACH.get(name, SIZES)}
    for _ in range(rounds):
        for name, done in runs.items():
            if sum(run["cpu"] for run in done) < ENOUGH:
                done.append(run_once(name, pythons[name], order, result_of(folder, size, name)))
    return runs


def run_once(name, python, order, out):
    """One process: CPU and wall seconds of the reduction (and flexarm's assembly), memory, its answer."""
    threads = 2 if "two threads" in name else 1
    order = {**order, "code": NAMES[name], "threads": threads, "out": str(out)}
    process = measure.run(python, "reduce_worker.py", order, threads)
    seconds = process.answer["seconds"]
    counted = [seconds[key] for key in ("assembly", "reduction") if key in seconds]
    cpu, wall = (sum(entry[key] for entry in counted) for key in ("cpu", "wall"))
    say(f"  {order['size']} {name}: {cpu:.3g} s of CPU time, {process.memory:.0f} MB")
    return {"cpu": cpu, "wall": wall, "process": process.cpu, "memory": process.memory, **process.answer}


def result_of(folder, size, name):
    """Where a run leaves frequencies and reduced matrices."""
    return folder / f"{size} {name}.npz"


def summary(runs):
    """Spreads of a competitor's runs; its answer from the last."""
    spreads = {key: measure.Spread.of([run[key] for run in runs]) for key in tables.COLUMNS}
    peak = max(run["memory"] for run in runs)
    return {**runs[-1], **spreads, "memory": peak, "rounds": len(runs)}


def measure_arms(rounds):
    """133 s of the arm with each kind of hinge, in turns."""
    runs = {name: [] for name in ARMS}
    for _ in range(rounds):
        for name, done in runs.items():
            process = measure.run(sys.executable, "arm_of_parts.py", ARMS[name])
            say(f"  arm, hinge of {name}: {process.answer['cpu']:.3g} s of CPU time")
            done.append({**process.answer, "memory": process.memory})
    return {
        name: {**done[-1], "cpu": measure.Spread.of([run["cpu"] for run in done])}
        for name, done in runs.items()
    }


def main(arguments=None):
    """Measures, prints, writes."""
    chosen = options(arguments)
    pythons = competitors(chosen)
    rounds = 1 if chosen.quick else chosen.rounds
    found = {"machine": measure.machine(), "sizes": {}, "agreement": {}}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for size in SIZES[: SIZES.index("10k" if chosen.quick else chosen.largest) + 1]:
            runs = measure_size(size, pythons, rounds, folder)
            found["sizes"][size] = {name: summary(done) for name, done in runs.items()}
            found["agreement"][size] = agreement.worst([result_of(folder, size, name) for name in runs])
    print("\n".join(report(found)), flush=True)
    if not chosen.no_arm:
        found["arm"] = measure_arms(rounds)
        print("\n".join(["", *tables.arm_lines(found["arm"])]), flush=True)
    if chosen.out:
        tables.save(chosen.out, found)
    return 0


def report(found):
    """Machine, versions, table, phases, goals."""
    sizes = found["sizes"]
    versions = {k: v for rows in sizes.values() for row in rows.values() for k, v in row["version"].items()}
    yield ", ".join(f"{key} {value}" for key, value in (found["machine"] | versions).items())
    for block in (
        tables.lines(sizes, REACH, found["agreement"]),
        tables.phases(sizes),
        tables.verdicts(sizes),
    ):
        yield ""
        yield from block


def say(text):
    """Progress, away from the table."""
    print(text, file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
