"""Campaigns: a numbered series of cases from a seed, run by several workers, kept line by line in a file."""

from __future__ import annotations

import hashlib
import json
import os
import random
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

from torture import sandbox
from torture.outcome import FAILED, Outcome
from torture.sandbox import Case

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Campaign:
    """One idea of what may go wrong.

    Attributes
    ----------
    name : str
        As on the command line.
    title : str
        As in the table.
    case : callable
        Makes the case of a number, given a generator of random numbers of its own and the folder of seeds.
    cases, sample : int
        How many `make torture` and `make test` run.
    """

    name: str
    title: str
    case: Callable[[int, random.Random, Path], Case]
    cases: int
    sample: int


def generator(campaign: Campaign, seed: int, number: int) -> random.Random:
    """The random numbers of one case: the same ones whichever others run."""
    text = f"{campaign.name} {seed} {number}".encode()
    return random.Random(int.from_bytes(hashlib.sha256(text).digest()[:8], "big"))


def outcomes(campaign: Campaign, number: int, seed: int, out: Path, show: bool = False) -> dict[str, Any]:
    """Runs one case; its line of the record."""
    case = campaign.case(number, generator(campaign, seed, number), seeds(out))
    began, cpu = time.monotonic(), _cpu()
    found = sandbox.run(case, out / "work" / f"{campaign.name}-{seed}-{number}", show)
    return {
        "number": number,
        "case": case.kind,
        **asdict(worst(found)),
        "values": {key: value for outcome in found for key, value in outcome.values.items()},
        "seconds": round(time.monotonic() - began, 3),
        "cpu": round(_cpu() - cpu, 3),
    }


def worst(found: Iterable[Outcome]) -> Outcome:
    """The failure, if there is one; else the outcome that is furthest from success."""
    order = ["ok", "numbers", "refused", *FAILED]
    return max(found, key=lambda outcome: order.index(outcome.kind))


def _cpu() -> float:
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def run(campaign: Campaign, numbers: Iterable[int], seed: int, jobs: int, out: Path) -> list[dict[str, Any]]:
    """Runs cases that the record lacks, and returns the lines of all of them.

    The record of a commit has a line a case; a run that was stopped goes on where it was. What is not
    committed yet has no record that lasts.
    """
    seeds(out)
    file = record(campaign, seed, out)
    if "dirty" in file.name:
        file.unlink(missing_ok=True)
    wanted = list(numbers)
    done = {line["number"] for line in lines(file)}
    left = [number for number in wanted if number not in done]
    if left:
        sandbox.preload(seeds(out))
        _in_workers(campaign, left, seed, jobs, out, file)
    chosen = set(wanted)
    return [line for line in lines(file) if line["number"] in chosen]


def _in_workers(campaign: Campaign, left: list[int], seed: int, jobs: int, out: Path, file: Path) -> None:
    """Each worker takes every jobs-th case and appends whole lines."""
    import shutil

    sys.stdout.flush()
    workers = []
    for worker in range(jobs):
        if (child := os.fork()) != 0:
            workers.append(child)
            continue
        try:
            with file.open("a") as record:
                for number in left[worker::jobs]:
                    record.write(json.dumps(outcomes(campaign, number, seed, out)) + "\n")
                    record.flush()
                    shutil.rmtree(out / "work" / f"{campaign.name}-{seed}-{number}", ignore_errors=True)
        except BaseException:
            import traceback

            traceback.print_exc()
            os._exit(1)
        os._exit(0)
    if any(os.waitpid(child, 0)[1] for child in workers):
        raise SystemExit(f"{campaign.name}: the harness itself failed")


@cache
def commit() -> str:
    """The commit that is tried; "dirty" if files differ from it."""
    words = ["git", "describe", "--always", "--dirty", "--exclude", "*"]
    found = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    return found.stdout.strip() or "dirty"


def record(campaign: Campaign, seed: int, out: Path) -> Path:
    """Where the outcomes of a campaign's cases stand."""
    return out / f"{campaign.name}-{seed}-{commit()}.jsonl"


def lines(file: Path) -> list[dict[str, Any]]:
    """The record so far; a line that was cut off counts as not there."""
    if not file.exists():
        return []
    return [json.loads(line) for line in file.read_text().splitlines() if line.endswith("}")]


def seeds(out: Path) -> Path:
    """A folder of right files that campaigns spoil, made once by flexarm itself."""
    folder = out / "seeds"
    if not (folder / "done").exists():
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        words = [sys.executable, "-m", "torture.seeds", str(folder)]
        subprocess.run(words, env=environment, check=True, stdout=subprocess.DEVNULL)
    return folder
