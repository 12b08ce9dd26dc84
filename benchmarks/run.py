"""All benchmarks: `python benchmarks/run.py [--quick] [--only swing] [--out DIR]`.

Run it with the interpreter that has flexarm. EXUDYN is installed into benchmarks/.venv on first use, unless
--exudyn-python names an interpreter that has it, or --no-exudyn leaves it out.
"""

import argparse
import json
import sys
from pathlib import Path

import goals
import identification
import measure
import overhead
import run_133s
import scaling
import sensitivities
import side_by_side
import swing


def options(arguments=None):
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few settings and repetitions: a minute")
    parser.add_argument("--only", choices=list(PARTS), action="append", help="one part; may be repeated")
    parser.add_argument("--out", type=Path, default=measure.HERE / "results", help="folder of results")
    parser.add_argument("--exudyn-python", help="interpreter that has EXUDYN")
    parser.add_argument("--no-exudyn", action="store_true", help="flexarm alone")
    parser.add_argument("--repetitions", type=int, help="rounds of each timing")
    return parser.parse_args(arguments)


def interpreters(chosen):
    """Interpreter of every code that takes part."""
    pythons = {"flexarm": sys.executable}
    if not chosen.no_exudyn:
        other = measure.exudyn_python(chosen.exudyn_python)
        codes = ["exudyn-2d"] if chosen.quick else ["exudyn-2d", "exudyn-3d", "exudyn-manual"]
        pythons |= dict.fromkeys(codes, other)
    return pythons


def run_swing(pythons, chosen, rounds):
    """Check of the models, then the comparison."""
    theories = swing.check_theories(pythons)
    print("Error of fine runs (8 elements, 0.5 ms) against the converged values of their theory:")
    for name, value in theories.items():
        print(f"  {name}: {1e3 * value:.2g} um")
    limits = (0.1, 0.01) if chosen.quick else (0.1, 0.01, 0.001)
    result = {"theories": theories, **swing.compare(pythons, limits, rounds, chosen.quick)}
    return result, swing.lines(result)


def run_133(pythons, chosen, rounds):
    """133 s at 2 ms."""
    result = run_133s.compare(pythons, 1 if chosen.quick else max(1, rounds // 2))
    return result, run_133s.lines(result)


def run_scaling(pythons, chosen, rounds):
    """Cost of a step against size."""
    order = {"repetitions": 1 if chosen.quick else 3}
    if chosen.quick:
        order |= {"segments": scaling.SEGMENTS[::2], "joints": scaling.JOINTS[::2]}
    result = measure.run(pythons["flexarm"], "scaling.py", order).answer
    return result, scaling.lines(result)


def run_identification(pythons, chosen, rounds):
    """60 s with a noisy encoder as drive."""
    result = measure.run(pythons["flexarm"], "identification.py", {"repetitions": rounds}).answer
    return result, identification.lines(result)


def run_sensitivities(pythons, chosen, rounds):
    """The same with derivatives, at the step that `identification` chose, else at 4 ms."""
    kept = chosen.out / "identification.json"
    found = json.loads(kept.read_text())["result"] if kept.exists() else {}
    steps = found.get("damped in tube and hub", {"steps": 15_000})["steps"]
    order = {"steps": steps, "repetitions": rounds}
    result = measure.run(pythons["flexarm"], "sensitivities.py", order, threads=1).answer
    return result, sensitivities.lines(result)


def run_side_by_side(pythons, chosen, rounds):
    """Variants of an arm alone and side by side."""
    order = {"repetitions": rounds}
    result = measure.run(pythons["flexarm"], "side_by_side.py", order, threads=1).answer
    return result, side_by_side.lines(result)


def run_parts(pythons, chosen, rounds):
    """133 s with a hinge of three solid parts, with and without inner modes."""
    result, count = {}, max(1, rounds // 3)
    for name, order in {"20 inner modes": {"modes": 20}, "no inner modes": {"modes": 0}}.items():
        runs = [measure.run(pythons["flexarm"], "arm_of_parts.py", order).answer for _ in range(count)]
        result[name] = {"cpu": [run["cpu"] for run in runs], "iterations": runs[0]["iterations"]}
    text = "three super-elements, {}: {} s, {:.2f} iterations a step"
    return result, [
        text.format(name, measure.Spread.of(seen["cpu"]).text(), seen["iterations"])
        for name, seen in result.items()
    ]


def run_overhead(pythons, chosen, rounds):
    """Python around the core, and the whole process."""
    result = measure.run(pythons["flexarm"], "overhead.py", {"repetitions": rounds}).answer
    return result, overhead.lines(result)


PARTS = {
    "swing": run_swing,
    "133s": run_133,
    "scaling": run_scaling,
    "identification": run_identification,
    "sensitivities": run_sensitivities,
    "side-by-side": run_side_by_side,
    "parts": run_parts,
    "overhead": run_overhead,
}


def main(arguments=None):
    """Every part that was asked for: tables, one JSON file each, and how the goals are met."""
    chosen = options(arguments)
    rounds = chosen.repetitions or (3 if chosen.quick else 7)
    pythons = interpreters(chosen)
    header = {"machine": measure.machine(), "versions": versions(pythons)}
    print(json.dumps(header, indent=2))
    chosen.out.mkdir(parents=True, exist_ok=True)
    results = {}
    for name in chosen.only or PARTS:
        results[name], table = PARTS[name](pythons, chosen, rounds)
        print(f"\n## {name}\n")
        print("\n".join(table), flush=True)
        kept = json.dumps({**header, "result": results[name]}, indent=1)
        (chosen.out / f"{name}.json").write_text(kept)
    print("\n## goals\n")
    print("\n".join(goals.lines(results)))
    return 0


def versions(pythons):
    """Of every code."""
    found = {}
    for code, python in pythons.items():
        found |= measure.run(python, "worker.py", {"code": code, "cases": []}).answer["version"]
    return found


if __name__ == "__main__":
    sys.exit(main())
