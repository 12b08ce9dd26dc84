"""Changes each threshold of the search and counts the answers that change with it.

    python benchmarks/ablation.py --out results/ablation [--cases 20] [--jobs 2] [--only FIELD]...
        [--groups single,double,none] [--kinds hinged] [--seed 1]

Every field of `flexarm.SelectionPolicy` is halved and doubled, and every move is left out. Each case of the
blind test is diagnosed by each of these policies in a process of its own with one thread. Answers are kept
under --out, one file a policy and case; what is there is not computed again. The table, `ablation.md`, counts
the cases of which verdict or names differ from those of the default, and those without an answer, which
are kept nowhere and tried again by the next run.
"""

import argparse
import json
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from multiprocessing import get_context
from pathlib import Path

from blind import case_of
from blind_plan import COUNTS, KINDS, Spec, planned

from flexarm.diagnosis.policy import MOVES, SelectionPolicy

DEFAULT = ("default", {})
"""Name of a policy, and the fields that it changes."""


def variants(only: list[str]) -> list[tuple[str, dict]]:
    """Return the policies to try, each with one change; those of some fields or moves alone if named."""
    found = []
    for field in fields(SelectionPolicy):
        value = field.default
        if field.name == "moves":
            found += [(f"{move} off", {"moves": [m for m in MOVES if m != move]}) for move in MOVES]
        else:
            half = max(1, value // 2) if isinstance(value, int) else value / 2
            found += [(f"{field.name} halved", {field.name: half})]
            found += [(f"{field.name} doubled", {field.name: 2 * value})]
    wanted = [
        one
        for one in found
        if not only or one[0].split()[0] in only or ("moves" in one[1] and "moves" in only)
    ]
    return [DEFAULT, *wanted]


def diagnosed(spec: Spec, changes: dict, cases: Path, kept: Path) -> None:
    """Write verdict and names of a case by the policy with some changes."""
    import flexarm

    case = case_of(spec, cases)
    policy = SelectionPolicy(**{key: tuple(v) if isinstance(v, list) else v for key, v in changes.items()})
    records = {"train_a": case.train_a, "train_b": case.train_b}
    found = flexarm.diagnose(case.model, records, hold_out=case.held_out, jobs=1, policy=policy)
    answer = {"verdict": found.verdict, "names": sorted([e.name, e.at] for e in found.effects)}
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(answer) + "\n")


def answer_of(spec: Spec, name: str, changes: dict, out: Path, timeout: float) -> dict | None:
    """Return the answer to a case by a policy, from the disk or a process of its own; None if it fails."""
    kept = out / name.replace(" ", "-") / f"{spec.name}.json"
    if not kept.exists():
        process = get_context("spawn").Process(target=diagnosed, args=(spec, changes, out / "cases", kept))
        process.start()
        process.join(timeout)
        if process.exitcode != 0:
            process.kill()
            print(f"{name}: {spec.name}: no answer", file=sys.stderr, flush=True)
            return None
        print(f"{name}: {spec.name}", file=sys.stderr, flush=True)
    return json.loads(kept.read_text())


def table(found: dict[str, list[dict | None]], changed: dict[str, dict]) -> str:
    """Return the Markdown table of the answers by policy, in the order of the cases."""
    lines = [
        f"{len(found['default'])} cases; `default` is `SelectionPolicy()`.\n",
        "| policy | value | default | compared | verdicts changed | names changed | no answer |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, answers in found.items():
        if name == "default":
            continue
        pairs = [(a, b) for a, b in zip(answers, found["default"], strict=True) if a and b]
        verdicts, names = (sum(a[key] != b[key] for a, b in pairs) for key in ("verdict", "names"))
        failed = sum(answer is None for answer in answers)
        [(field, value)] = changed[name].items()
        shown = (
            ("off", "on") if field == "moves" else (f"{value:.4g}", f"{getattr(SelectionPolicy, field):.4g}")
        )
        lines.append(f"| {name} | {shown[0]} | {shown[1]} | {len(pairs)} | {verdicts} | {names} | {failed} |")
    return "\n".join(lines) + "\n"


def arguments() -> argparse.Namespace:
    """Return those of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="directory for cases, answers and table")
    parser.add_argument("--cases", type=int, help="cases in all")
    parser.add_argument("--groups", default=",".join(COUNTS), help=f"of {', '.join(COUNTS)}")
    parser.add_argument("--kinds", default=",".join(KINDS), help=f"of {', '.join(KINDS)}")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--timeout", type=float, default=1200.0, metavar="S", help="of a case")
    parser.add_argument("--only", action="append", default=[], metavar="FIELD", help="a field or a move")
    return parser.parse_args()


def specs_of(given: argparse.Namespace) -> list[Spec]:
    """Return the cases asked for, groups in turn."""
    kinds = given.kinds.split(",")
    groups = [
        [spec for spec in planned(group, COUNTS[group], given.seed) if spec.kind in kinds]
        for group in given.groups.split(",")
    ]
    longest = max(map(len, groups))
    mixed = [group[k] for k in range(longest) for group in groups if k < len(group)]
    return mixed[: given.cases]


def main() -> None:
    """Diagnose the cases by all policies, and write and print the table."""
    given = arguments()
    specs, tried = specs_of(given), variants(given.only)
    given.out.mkdir(parents=True, exist_ok=True)
    for spec in specs:
        case_of(spec, given.out / "cases")
    jobs = [(spec, name, changes, given.out, given.timeout) for name, changes in tried for spec in specs]
    with ThreadPoolExecutor(given.jobs) as pool:
        answers = iter(list(pool.map(lambda job: answer_of(*job), jobs)))
    found = {name: [next(answers) for _ in specs] for name, _ in tried}
    text = table(found, dict(tried))
    (given.out / "ablation.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
