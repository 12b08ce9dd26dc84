"""Kills and interrupts at random instants, from the first one on, told by the CPU that a command has used."""

from __future__ import annotations

import random
import signal
import time
from pathlib import Path

from torture.campaign import Campaign
from torture.campaigns.processes import COMMANDS, WRITES, after, ended, must, needed, send, started
from torture.sandbox import Case, Step

KILLED = tuple(name for name, (_, words) in COMMANDS.items() if "--out" in words)
"""Commands that write."""
SLOW = 1.0
"""CPU that a command may use after an interrupt [s]: 0.3 s is asked for, the rest is a busy machine's."""
ENDS = {signal.SIGINT: 130, signal.SIGTERM: 143}


def instant(name: str, rng: random.Random) -> float:
    """CPU used when the signal comes [s]; negative, by the clock, for a third that come at the start."""
    return -rng.uniform(0, 0.2) if rng.random() < 0.34 else rng.uniform(0, COMMANDS[name][0])


def told(seconds: float) -> str:
    return f"{-seconds:.3f} s" if seconds < 0 else f"{seconds:.2f} s of CPU"


def entries() -> set[str]:
    return {str(path) for path in Path().rglob("*")}


def whole(name: str) -> None:
    """Loads what a command wrote: a torn file fails."""
    import json
    from xml.etree import ElementTree

    import flexarm

    loads = {
        "simulate": lambda: (flexarm.Simulation.load("run/simulation.nc"), flexarm.Record.load("run")),
        "reduce": lambda: flexarm.SuperElement.load("part.nc"),
        "linearise": lambda: flexarm.LinearModel.load("arm.mat"),
        "diagnose": lambda: flexarm.Diagnosis.load("why"),
        "calibrate": lambda: flexarm.Calibration.load("fit"),
        "plan": lambda: json.loads(Path("plan/plan.json").read_text()),
        "campaign": lambda: flexarm.Campaign.load("study").dataset.close(),
        "import": lambda: flexarm.Record.load("record"),
        "example": lambda: flexarm.Arm.load("tryout/arm.toml"),
        "export": lambda: ElementTree.parse("new.urdf"),
        "view": lambda: must(
            Path("arm.html").read_text().rstrip().endswith("</html>"), "wrong result", "no end"
        ),
    }
    try:
        loads[name]()
    except Exception as error:
        must(False, "wrong result", f"the output is torn: {type(error).__name__}: {error}")


def killed(name: str, seconds: float) -> dict[str, object]:
    """SIGKILL: the output is whole or not there, and the next run clears what was left.

    What a campaign has done stays, and `--resume` goes on.
    """
    before, words = entries(), COMMANDS[name][1]
    process = started(words)
    after(process, seconds)
    send(process, signal.SIGKILL)
    ended(process)
    place = words[words.index("--out") + 1]
    left = len(entries() - before)
    further = ("--resume", "--force") if name == "campaign" and Path(place).exists() else ("--force",)
    if Path(place).exists() and "--resume" not in further:
        whole(name)
    for option in further:
        again = ended(started((*words, option)))
        must(
            again.code == 0,
            "wrong result",
            f"the run with {option} ends with {again.code}: {again.err[-200:]}",
        )
        whole(name)
    rest = {entry for entry in entries() - before if not entry.startswith(place)}
    must(not rest, "left files", f"the next run leaves {', '.join(sorted(rest))[:200]}")
    return {"left": left}


def interrupted(name: str, number: signal.Signals, seconds: float) -> dict[str, object]:
    """SIGINT or SIGTERM: its exit code, no traceback, soon, and nothing left but whole output, told."""
    before = entries()
    process = started(COMMANDS[name][1])
    used = after(process, seconds)
    sent = send(process, number)
    found = ended(process)
    if "Traceback" in found.err and entries() == before:  # Python's own, before code of flexarm is loaded
        return {"early": round(time.monotonic() - sent, 3)}
    values = {"latency": round(time.monotonic() - sent, 3), "latency_cpu": round(max(0, found.cpu - used), 3)}
    if found.code == 0 and entries() - before:  # it was done already
        whole(name)
        return {}
    must(
        found.code in (0, 2, ENDS[number], -number),
        "unclear message",
        f"exit code {found.code}: {found.err[-200:]}",
    )
    must(
        found.code != 0 or name in ("check", "compare", "modes") or values["latency"] < SLOW,
        "wrong result",
        "swallowed",
    )
    left = entries() - before
    if left and "was written whole" in found.err:  # it came after the output, and before the end
        whole(name)
        left = set()
    must(not left, "left files", f"{', '.join(sorted(left))[:200]} after {number.name}")
    must(values["latency_cpu"] < SLOW, "hang", f"{values['latency_cpu']} s of CPU after {number.name}")
    return values


def kill_case(number: int, rng: random.Random, seeds: Path) -> Case:
    name = rng.choice(KILLED)
    seconds = instant(name, rng)
    label = f"{name} killed after {told(seconds)}"
    step = Step(label, lambda: killed(name, seconds), writes=WRITES, cpu=300)
    return Case(label, (step,), needed(seeds), wall=600)


def interrupt_case(number: int, rng: random.Random, seeds: Path) -> Case:
    name, sent = rng.choice(list(COMMANDS)), rng.choice(list(ENDS))
    seconds = instant(name, rng)
    label = f"{name} gets {sent.name} after {told(seconds)}"
    step = Step(label, lambda: interrupted(name, sent, seconds), writes=WRITES, cpu=300)
    return Case(label, (step,), needed(seeds), wall=600)


KILLS = Campaign("kills", "kill -9 at random instants", kill_case, 200, 5)
INTERRUPTS = Campaign("interrupts", "interrupts at random instants", interrupt_case, 200, 12)
