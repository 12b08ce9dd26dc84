"""All benchmarks: `python benchmarks/run.py [--quick] [--only swing] [--out DIR]`.

Run it with the interpreter that has flexarm. EXUDYN is installed into benchmarks/.venv on first use, unless
--exudyn-python names an interpreter that has it, or --no-exudyn leaves it out.
"""

import argparse
import json
import sys
from pathlib import Path

import measure
import run_133s
import scaling
import swing

PARTS = ("swing", "133s", "scaling")


def options(arguments=None):
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few settings and repetitions: a minute")
    parser.add_argument("--only", choices=PARTS, action="append", help="run only this part; may be repeated")
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


def main(arguments=None):
    """Every part that was asked for; prints tables and writes one JSON file each."""
    chosen = options(arguments)
    rounds = chosen.repetitions or (3 if chosen.quick else 7)
    pythons = interpreters(chosen)
    header = {"machine": measure.machine(), "versions": versions(pythons)}
    print(json.dumps(header, indent=2))
    chosen.out.mkdir(parents=True, exist_ok=True)
    parts = {"swing": run_swing, "133s": run_133, "scaling": run_scaling}
    for name in chosen.only or PARTS:
        result, table = parts[name](pythons, chosen, rounds)
        print(f"\n## {name}\n")
        print("\n".join(table), flush=True)
        (chosen.out / f"{name}.json").write_text(json.dumps({**header, "result": result}, indent=1))
    return 0


def versions(pythons):
    """Of every code."""
    found = {}
    for code, python in pythons.items():
        found |= measure.run(python, "worker.py", {"code": code, "cases": []}).answer["version"]
    return found


if __name__ == "__main__":
    sys.exit(main())
