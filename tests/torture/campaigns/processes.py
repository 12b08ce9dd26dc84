"""Commands as processes of their own, for campaigns that send them signals or close their streams."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from torture.outcome import Failure
from torture.sandbox import cpu_of

PACKAGE = Path(__file__).resolve().parents[3] / "python" / "flexarm"
REDUCE = ("--unit", "mm", "--interface", "a=BORE", "--interface", "b=FLANGE", "--modes", "3")
COMMANDS: dict[str, tuple[float, tuple[str, ...]]] = {
    "simulate": (1.0, ("simulate", "arm.toml", "--drive", "swing.csv", "--step", "0.001", "--out", "run")),
    "linearise": (0.7, ("linearise", "arm.toml", "--out", "arm.mat")),
    "reduce": (1.3, ("reduce", "bracket.inp", *REDUCE, "--out", "part.nc")),
    "modes": (0.6, ("modes", "arm.toml", "--joint", "hinge=0.4")),
    "check": (1.0, ("check", "arm.toml", "slow")),
    "compare": (1.0, ("compare", "arm.toml", "slow")),
    "diagnose": (4.0, ("diagnose", "arm.toml", "slow", "--jobs", "1", "--out", "why")),
    "calibrate": (4.0, ("calibrate", "arm.toml", "slow", "--jobs", "1", "--out", "fit")),
    "plan": (3.0, ("plan", "arm.toml", "--drive", "slow", "--jobs", "1", "--out", "plan")),
    "campaign": (1.5, ("campaign", "study.toml", "--jobs", "1", "--out", "study")),
    "import": (0.8, ("import", "log.toml", "--out", "record")),
    "export": (0.7, ("export", "arm.toml", "--urdf", "robot.urdf", "--out", "new.urdf")),
    "view": (1.0, ("view", "arm.toml", "--out", "arm.html")),
    "example": (0.7, ("example", "tryout")),
    "static": (0.5, ("static", "arm.toml", "--joint", "hinge=0.4")),
}
"""Seconds of CPU that a command takes, roughly, and its words. `reproduce` runs for minutes and has none."""
WRITES = (
    "run",
    "part.nc",
    "arm.mat",
    "why",
    "fit",
    "plan",
    "study",
    "record",
    "new.urdf",
    "arm.html",
    "tryout",
)


def needed(seeds: Path) -> dict[str, bytes]:
    """The files that the commands read."""
    example = seeds / "example"
    found = [*example.glob("*.*"), *(example / "slow").iterdir()]
    files = {str(path.relative_to(example)): path.read_bytes() for path in found}
    log = "motive.csv"
    return files | {
        log: (seeds / "logs" / log).read_bytes(),
        "log.toml": (seeds / "logs" / f"{log}.toml").read_bytes(),
    }


@dataclass
class Ended:
    """How a process ended: its code, texts, and what it took."""

    code: int
    out: str
    err: str
    cpu: float


def started(words: tuple[str, ...], **more: Any) -> subprocess.Popen[bytes]:
    """A command as a process, with its texts in files beside the case's own."""
    number = len(list(Path("..").glob("*.text")))
    with Path(f"../{number}.text").open("wb") as out, Path(f"../{number}e.text").open("wb") as err:
        streams = {"stdout": out, "stderr": err, "stdin": subprocess.DEVNULL} | more
        process = subprocess.Popen([sys.executable, "-m", "flexarm", *words], **streams)
    process.texts = (Path(out.name), Path(err.name))  # type: ignore[attr-defined]
    return process


def ended(process: subprocess.Popen[bytes], within: float = 300) -> Ended:
    """Waits for a process; one that does not end is a hang. A traceback through flexarm is a failure."""
    until = time.monotonic() + within
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            break
        if time.monotonic() > until:
            process.kill()
            raise Failure("hang", f"does not end within {within:g} s")
        time.sleep(0.002)
    process.returncode = os.waitstatus_to_exitcode(status)
    out, err = (path.read_text(errors="replace") for path in process.texts)  # type: ignore[attr-defined]
    if "Traceback" in err and str(PACKAGE) in err:
        raise Failure("traceback", err.strip().splitlines()[-1])
    return Ended(process.returncode, out, err, usage.ru_utime + usage.ru_stime)


def after(process: subprocess.Popen[bytes], seconds: float) -> float:
    """Waits until a process has used so much CPU, or has ended; its CPU then [s]. Negative: by the clock."""
    time.sleep(max(0.0, -seconds))
    while (used := cpu_of(process.pid)) < seconds:
        time.sleep(0.001)
    return used


def must(truth: bool, kind: str, detail: Callable[[], str] | str) -> None:
    """Raises a failure unless it is true."""
    if not truth:
        raise Failure(kind, detail if isinstance(detail, str) else detail())


def send(process: subprocess.Popen[bytes], number: signal.Signals) -> float:
    """Sends a signal; when [s]."""
    os.kill(process.pid, number)  # Popen's own way would reap it
    return time.monotonic()
