"""Changes each threshold of the search and counts the answers that change with it.

    python benchmarks/ablation.py --out results/ablation [--cases 20] [--jobs 2] [--only FIELD]...
        [--groups single,double,none] [--kinds hinged] [--seed 1]

Every field of `flexarm.SelectionPolicy` is halved and doubled, and every move is left out. Each case of the
blind test is diagnosed by each of these policies in a process of its own with one thread. Answers are kept
under --out, one file a policy and case; what is there is not computed again. Where a move did nothing in the
search of the default policy, the answer without it is that of the default, and not computed.

The table, `ablation.md`, counts the cases in which a change could act, of which verdict or names differ
from those of the default, and which name exactly what was hidden, before and after; the median CPU seconds
of both where it acted; and the cases without an answer, which are kept nowhere and tried again by the next
run.
"""

import argparse
import json
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from statistics import median

from blind import case_of
from blind_plan import COUNTS, KINDS, Spec, planned
from blind_table import Outcome, same

from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.moves.search_state import Move
from flexarm.diagnosis.policy import MOVES, SelectionPolicy
from flexarm.diagnosis.selection import CONFLICT, ELSEWHERE, FORWARD, SETS, SHAPES

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


class Recorded(SelectionPolicy):
    """A policy that adds the moves that a search makes to `ACTED`: those it asks for before they act."""

    def allows(self, move: str) -> bool:
        """Return True if a step of the search is on."""
        allowed = super().allows(move)
        if allowed and move not in PROPOSING:
            ACTED.add(move)
        return allowed


ACTED: set[str] = set()
"""Moves that acted in the diagnosis of this process."""
PROPOSING = {name for table in (FORWARD, SETS, ELSEWHERE, SHAPES) for name in table}
"""Moves that are always asked for; they act if they propose a model."""


def record_proposals() -> None:
    """Let moves that propose models add themselves to `ACTED`."""

    def recorded(name: str, move: Move) -> Move:
        def proposed(*about) -> list[Fit]:
            found = move(*about)
            if found:
                ACTED.add(name)
            return found

        return proposed

    for table in (FORWARD, CONFLICT, SETS, ELSEWHERE, SHAPES):
        table.update({name: recorded(name, move) for name, move in table.items()})


def diagnosed(spec: Spec, changes: dict, cases: Path, kept: Path) -> None:
    """Write what is told of a case by the policy with some changes, its CPU seconds, and what moves acted."""
    import flexarm

    case = case_of(spec, cases)
    record_proposals()
    policy = Recorded(**{key: tuple(v) if isinstance(v, list) else v for key, v in changes.items()})
    records = {"train_a": case.train_a, "train_b": case.train_b}
    start = time.process_time()
    found = flexarm.diagnose(case.model, records, hold_out=case.held_out, n_jobs=1, policy=policy)
    outcome = Outcome(case.answer.to_dict(), found.to_json_dict())
    answer = {
        "verdict": found.verdict,
        "names": sorted([e.name, e.at] for e in found.effects),
        "probabilities": {f"{e.name} at {e.at}": e.probability for e in found.effects},
        "right": len(outcome.named) == len(outcome.hidden)
        and all(any(same(one, hidden) for one in outcome.named) for hidden in outcome.hidden),
        "cpu": time.process_time() - start,
        "acted": sorted(ACTED),
    }
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(answer) + "\n")


def acted_without(answer: dict, moves: list[str]) -> set[str]:
    """Return the moves that acted in a search and are none of those that are left on."""
    return set(answer["acted"]) & set(MOVES) - set(moves)


def answer_of(name: str, changes: dict, spec: Spec, out: Path, timeout: float) -> dict | None:
    """Return the answer to a case by a policy, None if it fails.

    It comes from the disk, from the default policy if the move left out did nothing there, or from a process.
    """
    kept, default = (out / each.replace(" ", "-") / f"{spec.name}.json" for each in (name, DEFAULT[0]))
    if not kept.exists() and "moves" in changes and default.exists():
        answer = json.loads(default.read_text())
        if not acted_without(answer, changes["moves"]):
            return answer
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
        "| policy | value | default | compared | acted | verdicts changed | names changed | right | CPU [s] "
        "| no answer |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for name, answers in found.items():
        if name == "default":
            continue
        [(field, value)] = changed[name].items()
        pairs = [(a, b) for a, b in zip(answers, found["default"], strict=True) if a and b]
        acted = [(a, b) for a, b in pairs if field != "moves" or acted_without(b, value)]
        verdicts, names = (sum(a[key] != b[key] for a, b in acted) for key in ("verdict", "names"))
        right = " -> ".join(str(sum(pair[k]["right"] for pair in pairs)) for k in (1, 0))
        cpu = " -> ".join(f"{median(pair[k]['cpu'] for pair in acted):.0f}" for k in (1, 0)) if acted else ""
        failed = sum(answer is None for answer in answers)
        shown = (
            ("off", "on") if field == "moves" else (f"{value:.4g}", f"{getattr(SelectionPolicy, field):.4g}")
        )
        cells = [name, *shown, len(pairs), len(acted), verdicts, names, right, cpu, failed]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
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
    with ThreadPoolExecutor(given.jobs) as pool:
        found = {
            name: list(
                pool.map(partial(answer_of, name, changes, out=given.out, timeout=given.timeout), specs)
            )
            for name, changes in tried
        }
    text = table(found, dict(tried))
    (given.out / "ablation.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
