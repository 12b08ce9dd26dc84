"""Freeze the answers of diagnoses as JSON, and compare later answers with them.

    python tests/golden/freeze.py [--seed 25] [--cases ../shared/cases] [--jobs 2] [--only NAME,NAME]
    python tests/golden/freeze.py --check ...

Cases of the blind benchmark are drawn from the seed (`benchmarks/blind_plan.py`); shared cases are read
from a directory. Each case is diagnosed in a process of its own; answers are kept under --work, so a run
that was stopped goes on. Without --check they are written beside this file.
With it, each difference beyond rounding is printed and the exit code is 1.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from math import isclose
from multiprocessing import get_context
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
COUNTS = {"single": 12, "double": 7, "poor": 4, "none": 4, "outside": 4, "fault": 4}
"""Cases drawn from a seed, by group."""
RELATIVE, OF_SIGMA = 1e-4, 1e-3
"""Differences of numbers that count as rounding: of the number itself, and of its standard deviation."""


def answer_of(report: dict[str, Any]) -> dict[str, Any]:
    """Return what a refactoring must not change of a `report.json`."""
    named = [
        {
            "name": effect["name"],
            "at": effect["at"],
            "probability": effect["probability"],
            "alternatives": {f"{a['name']} at {a['at']}": a["probability"] for a in effect["alternatives"]},
            "parameters": {p["name"]: _estimate(p) for p in effect["parameters"]},
        }
        for effect in report["effects"]
    ]
    refined = {
        r["parameter"]: {"value": _rounded(r["value"]), "std": _rounded(r["std"])} for r in report["refined"]
    }
    gaps = {
        part: {key: _rounded(value) for key, value in report["gap"][part].items()}
        for part in ("train", "held_out")
    }
    return {"verdict": report["verdict"], "effects": named, "refined": refined, "gap": gaps}


def _estimate(parameter: dict[str, Any]) -> dict[str, float | None]:
    return {key: _rounded(parameter[key]) for key in ("value", "std", "low90", "high90")}


def _rounded(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.7g}")


def differences(old: Any, new: Any, at: str = "", sigma: float = 0.0) -> list[str]:
    """Return the places where two answers differ by more than rounding."""
    if isinstance(old, dict) and isinstance(new, dict):
        if old.keys() != new.keys():
            return [f"{at}: {sorted(old)} became {sorted(new)}"]
        spread = float(old.get("std") or 0.0)
        return [line for key in old for line in differences(old[key], new[key], f"{at}.{key}", spread)]
    if isinstance(old, list) and isinstance(new, list):
        if len(old) != len(new):
            return [f"{at}: {len(old)} became {len(new)}"]
        pairs = zip(old, new, strict=True)
        return [line for i, (a, b) in enumerate(pairs) for line in differences(a, b, f"{at}[{i}]", sigma)]
    if isinstance(old, float) and isinstance(new, float):
        same = isclose(old, new, rel_tol=RELATIVE, abs_tol=OF_SIGMA * sigma + 1e-12)
    else:
        same = old == new
    return [] if same else [f"{at}: {old} became {new}"]


def shared_case(directory: Path) -> dict[str, Any]:
    """Return the answer to a case of the shared directory."""
    import flexarm

    train = {name: flexarm.Record.load(directory / name) for name in ("train_a", "train_b")}
    held_out = flexarm.Record.load(directory / "held_out")
    arm = flexarm.Arm.from_toml(directory / "model.toml")
    return answer_of(flexarm.diagnose(arm, train, hold_out=held_out, n_jobs=1).to_json_dict())


def blind_case(name: str, seed: int) -> dict[str, Any]:
    """Return the answer to a case drawn from a seed."""
    import flexarm

    case = planned_cases(seed)[name].made()
    train = {"train_a": case.train_a, "train_b": case.train_b}
    return answer_of(flexarm.diagnose(case.model, train, hold_out=case.held_out, n_jobs=1).to_json_dict())


def planned_cases(seed: int) -> dict[str, Any]:
    """Return the drawn cases by name, the groups in turn, so that a part of the run holds all of them."""
    for folder in ("benchmarks", "tests/blind"):
        if str(ROOT / folder) not in sys.path:
            sys.path.append(str(ROOT / folder))
    from blind_plan import planned

    groups = {group: planned(group, count, seed) for group, count in COUNTS.items()}
    drawn = [(i / len(specs), spec) for specs in groups.values() for i, spec in enumerate(specs)]
    return {spec.name: spec for _, spec in sorted(drawn, key=lambda item: item[0])}


def _write(kept: Path, compute: Any, *arguments: Any) -> None:
    kept.write_text(json.dumps(compute(*arguments)) + "\n")


def _kept(kept: Path, task: tuple[Any, ...]) -> dict[str, Any]:
    """Return an answer from the disk, or from a process of its own if it is not there."""
    if not kept.exists():
        process = get_context("spawn").Process(target=_write, args=(kept, *task))
        process.start()
        process.join()
        if process.exitcode:
            raise RuntimeError(f"{kept.stem}: exit code {process.exitcode}")
        print(f"{kept.stem}: {json.loads(kept.read_text())['verdict']}", file=sys.stderr, flush=True)
    answer: dict[str, Any] = json.loads(kept.read_text())
    return answer


def main() -> int:
    """Freeze or compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, help="of the blind cases")
    parser.add_argument("--cases", type=Path, help="directory of the shared cases")
    parser.add_argument("--only", help="names of cases, separated by commas")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument(
        "--work", type=Path, default=ROOT / "results" / "golden", help="where answers are kept"
    )
    parser.add_argument("--check", action="store_true", help="compare instead of writing")
    given = parser.parse_args()
    if given.seed is None and given.cases is None:
        parser.error("nothing to do: give --seed or --cases")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    given.work.mkdir(parents=True, exist_ok=True)
    tasks: dict[str, dict[str, tuple[Any, ...]]] = {}
    if given.cases is not None:
        directories = sorted(path for path in given.cases.iterdir() if (path / "model.toml").exists())
        tasks["shared_cases.json"] = {path.name: (shared_case, path) for path in directories}
    if given.seed is not None:
        names = planned_cases(given.seed)
        tasks[f"seed_{given.seed}.json"] = {name: (blind_case, name, given.seed) for name in names}
    failed = False
    for file, cases in tasks.items():
        frozen = HERE / file
        old = json.loads(frozen.read_text()) if frozen.exists() else {}
        chosen = given.only.split(",") if given.only else list(old if given.check else cases)
        chosen = [name for name in chosen if name in cases]
        work = [given.work / f"{name}.json" for name in chosen]
        with ThreadPoolExecutor(given.jobs) as pool:
            answers = pool.map(_kept, work, [cases[name] for name in chosen])
            found = dict(zip(chosen, answers, strict=True))
        if given.check:
            lines = [line for name in chosen for line in differences(old[name], found[name], name)]
            print("\n".join([*lines, f"{file}: {len(chosen)} cases, {len(lines)} differences"]))
            failed = failed or bool(lines)
        else:
            frozen.write_text(json.dumps(old | found, indent=1, sort_keys=True) + "\n")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
