"""Diagnoses cases with hidden effects and prints how often the answer is right.

    python benchmarks/blind.py --out results/blind [--groups single,none] [--count 20] [--jobs 2]
        [--seed 1] [--reuse] [--save table.json]

The data come from rods joined by springs (tests/blind), not from flexarm. Cases are made once and kept under
--out; so is what was said of each (`outcome.json`), which --reuse takes instead of diagnosing again. Each
case is diagnosed in one process with one thread; on a machine that does other things, read the CPU seconds.
"""

import argparse
import json
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import asdict
from math import nan
from multiprocessing import get_context
from pathlib import Path

from blind_plan import COUNTS, Spec, planned
from blind_table import Outcome, tabulated

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "blind"))


def case_of(spec: Spec, out: Path):
    """The case, from the disk if it was made before."""
    from cases import Case

    directory = out / spec.name
    if not (directory / "answer.json").exists():
        spec.made().save(directory)
    return Case.load(directory)


def tip_rms(model, record) -> float:
    """What compare prints for the tip [m]; nan if it sees none, or none that can be aligned."""
    import flexarm

    gap = flexarm.compare(model, record).signals.get("tip")
    total = gap.rms["total"] if gap is not None else None
    return float(total) if total is not None else nan


def diagnosed(spec: Spec, out: Path, reuse: bool) -> Outcome:
    """What flexarm says of a case, and how the repaired model does on the record that was held back."""
    import flexarm

    kept = out / spec.name / "outcome.json"
    if reuse and kept.exists():
        return Outcome(**json.loads(kept.read_text()))
    case = case_of(spec, out)
    answer = case.answer.to_dict() | {"group": spec.group}
    start, cpu = time.perf_counter(), time.process_time()
    try:
        records = {"train_a": case.train_a, "train_b": case.train_b}
        found = flexarm.diagnose(case.model, records, hold_out=case.held_out, n_jobs=1)
        spent = {"seconds": time.perf_counter() - start, "cpu": time.process_time() - cpu}
        rms = {"before": tip_rms(case.model, case.held_out), "after": tip_rms(found.updated, case.held_out)}
        outcome = Outcome(answer, found.to_json_dict(), **spent, **rms)
    except Exception as error:  # a case that fails is counted, and the rest goes on
        outcome = Outcome(answer, {}, time.perf_counter() - start, error=f"{type(error).__name__}: {error}")
    kept.write_text(json.dumps(asdict(outcome), default=float) + "\n")
    return outcome


def kept_by_a_process(spec: Spec, out: Path, reuse: bool, timeout: float) -> Outcome:
    """The outcome of a process of its own: one that crashes or lasts too long costs its case alone."""
    start = time.perf_counter()
    process = get_context("spawn").Process(target=diagnosed, args=(spec, out, reuse))
    process.start()
    process.join(timeout)
    if process.exitcode == 0:
        return Outcome(**json.loads((out / spec.name / "outcome.json").read_text()))
    said = f"no answer after {timeout:g} s" if process.exitcode is None else f"exit code {process.exitcode}"
    process.kill()
    answer = {"group": spec.group, "kind": spec.kind, "effects": [], "noise": 0.0, "verdict": []}
    made = out / spec.name / "answer.json"
    if made.exists():
        answer |= json.loads(made.read_text()) | {"group": spec.group}
    return Outcome(answer, {}, time.perf_counter() - start, error=said)


def outcomes_of(specs: list[Spec], out: Path, jobs: int, reuse: bool, timeout: float) -> list[Outcome]:
    """All of them, in their order; said on standard error as they finish."""

    def one(spec: Spec) -> Outcome:
        found = kept_by_a_process(spec, out, reuse, timeout)
        print(
            f"{spec.name}: {found.error or found.verdict}, {found.seconds:.0f} s", file=sys.stderr, flush=True
        )
        return found

    with ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(one, specs))


def arguments() -> argparse.Namespace:
    """Of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="directory for cases and outcomes")
    parser.add_argument("--groups", default=",".join(COUNTS), help=f"of {', '.join(COUNTS)}")
    parser.add_argument("--count", type=int, help="cases a group")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--timeout", type=float, default=600.0, metavar="S", help="of a case, with making it")
    parser.add_argument("--reuse", action="store_true", help="take outcomes that are there")
    parser.add_argument("--make-only", action="store_true", help="make cases, diagnose nothing")
    parser.add_argument("--save", type=Path, metavar="FILE.json", help="write the table and all outcomes")
    given = parser.parse_args()
    for group in given.groups.split(","):
        if group not in COUNTS:
            parser.error(f"--groups: no group {group!r}; there are {', '.join(COUNTS)}")
    return given


def main() -> None:
    """Makes, diagnoses, prints."""
    given = arguments()
    specs = [
        spec
        for group in given.groups.split(",")
        for spec in planned(group, given.count or COUNTS[group], given.seed)
    ]
    given.out.mkdir(parents=True, exist_ok=True)
    if given.make_only:
        with ProcessPoolExecutor(given.jobs, mp_context=get_context("spawn")) as pool:
            list(pool.map(case_of, specs, [given.out] * len(specs)))
        return
    outcomes = outcomes_of(specs, given.out, given.jobs, given.reuse, given.timeout)
    table = tabulated(outcomes)
    print(f"{len(outcomes)} cases, seed {given.seed}\n\n{table}")
    if given.save:
        everything = table.to_dict() | {"seed": given.seed, "outcomes": [asdict(one) for one in outcomes]}
        given.save.write_text(json.dumps(everything, default=float, indent=1) + "\n")


if __name__ == "__main__":
    main()
