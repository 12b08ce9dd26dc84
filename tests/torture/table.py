"""The counts of a page: what came out of the cases on record, between two marks in docs/reliability.md."""

from __future__ import annotations

import collections
import datetime
import os
import platform
import statistics
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from torture import campaign as campaigns
from torture.campaigns import CAMPAIGNS
from torture.outcome import FAILED

BEGIN, END = "<!-- counts, written by make torture -->", "<!-- end of counts -->"
FIGURES = {
    "latency": "seconds from an interrupt to the end",
    "latency_cpu": "the same in seconds of CPU",
    "early": "seconds where Python itself was starting",
    "torque at alpha 0": "error of torques at 2 ms, alpha 0, of the largest",
    "torque at alpha -0.05": "the same with alpha -0.05",
    "position at alpha 0": "error of positions at 2 ms, alpha 0, of the largest",
    "position at alpha -0.05": "the same with alpha -0.05",
    "energy": "energy from nowhere at 1 ms, of what is exchanged",
}


def write(page: Path, out: Path, seed: int) -> None:
    """Replaces what stands between the marks."""
    before, _, rest = page.read_text().partition(BEGIN)
    _, mark, after = rest.partition(END)
    if not mark:
        raise SystemExit(f"{page} has no marks {BEGIN} and {END}")
    page.write_text(f"{before}{BEGIN}\n{counts(out, seed)}\n{END}{after}")


def counts(out: Path, seed: int) -> str:
    """Where and when, a row a campaign, and the figures that campaigns gather."""
    commit = campaigns.commit()
    found = {name: campaigns.lines(campaigns.record(each, seed, out)) for name, each in CAMPAIGNS.items()}
    head = (
        f"Commit {commit}, {datetime.date.today():%-d %B %Y}, seed {seed}, {machine()}.\n\n"
        "| what is tried | cases | done | refused | no convergence | failures | CPU [s] |\n"
        "|---|---|---|---|---|---|---|\n"
    )
    rows = "".join(row(CAMPAIGNS[name].title, lines) for name, lines in found.items() if lines)
    every = [line for lines in found.values() for line in lines]
    return head + rows + row("all", every) + figures(every)


def row(title: str, lines: list[dict[str, Any]]) -> str:
    kinds = collections.Counter(line["kind"] for line in lines)
    failures = ", ".join(f"{kinds[kind]} {kind}" for kind in FAILED if kinds[kind]) or "0"
    cpu = sum(line["cpu"] for line in lines)
    done = " | ".join(str(kinds[kind]) for kind in ("ok", "refused", "numbers"))
    return f"| {title} | {len(lines)} | {done} | {failures} | {cpu:.0f} |\n"


def figures(lines: Iterable[dict[str, Any]]) -> str:
    gathered = collections.defaultdict(list)
    for line in lines:
        for key, value in line["values"].items():
            gathered[key].append(value)
    text = "\n| figure | cases | median | 95 % below | largest |\n|---|---|---|---|---|\n"
    for key, title in FIGURES.items():
        if values := sorted(gathered[key]):
            high = values[min(len(values) - 1, int(0.95 * len(values)))]
            middle = statistics.median(values)
            text += f"| {title} | {len(values)} | {middle:.2g} | {high:.2g} | {values[-1]:.2g} |\n"
    return text


def machine() -> str:
    names = [
        line.partition(":")[2].strip()
        for line in Path("/proc/cpuinfo").read_text().splitlines()
        if line.startswith("model name")
    ]
    kind = names[0] if names else platform.processor()
    return f"{os.cpu_count()} cores of {kind}, Python {platform.python_version()}"
