"""Cases, and the child process in which each runs: a fork of a process that has imported all that it needs.

A fork takes milliseconds where the imports of a new process take half a second. What a child does to itself,
a crash included, stays in it.
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import os
import resource
import select
import shutil
import signal
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

from torture.outcome import Outcome, of_command, of_exception

CPU = 10
"""Seconds of CPU after which a step hangs. The clock on the wall says little on a busy machine."""
WALL = 60
"""Seconds after which a step hangs that waits for something."""
MEMORY = 1000
"""Most that a case may use [MB], beyond what its imports hold."""
CAP = 3 << 30
"""Address space that a child may add [bytes], so that no case takes the machine down."""


@dataclass(frozen=True)
class Step:
    """One thing that a case tries.

    Attributes
    ----------
    label : str
        What it is, as one would type it.
    run : callable
        Returns an exit code if `command`, else anything; a dict is kept as figures.
    writes : tuple of str
        Names that may be there afterwards, if it ends well.
    must_tell : bool
        Success without a warning is a wrong result.
    cpu : int
        Seconds of CPU after which it hangs.
    """

    label: str
    run: Callable[[], object]
    command: bool = False
    writes: tuple[str, ...] = ()
    must_tell: bool = False
    cpu: int = CPU


@dataclass(frozen=True)
class Case:
    """Files, by path in a directory of the case's own, and the steps that use them in turn."""

    kind: str
    steps: tuple[Step, ...]
    files: Mapping[str, bytes] = field(default_factory=dict)
    prepare: Callable[[], object] | None = None  # makes what is no plain file
    wall: float = WALL
    memory: float = MEMORY


def command(*arguments: str, **more: Any) -> Step:
    """A step of the command line; `more` are fields of the step."""

    def run() -> object:
        from flexarm.cli.run import run as main

        try:
            return main(list(arguments))
        except SystemExit as ending:
            return ending.code
        except BaseException:
            traceback.print_exc()
            return 1

    return Step(f"flexarm {' '.join(arguments)}", run, command=True, **more)


@cache
def preload(seeds: Path) -> None:
    """Imports what children need, by running commands and readers once as well: some imports are late."""
    import gc
    import importlib
    import pkgutil

    import flexarm

    for module in pkgutil.walk_packages(flexarm.__path__, "flexarm."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    model, drive = str(seeds / "crane.toml"), str(seeds / "drive.csv")
    with tempfile.TemporaryDirectory() as directory, contextlib.redirect_stdout(io.StringIO()):
        for words in (
            ("check", model),
            ("modes", model),
            ("check", str(seeds / "example" / "arm.toml"), str(seeds / "example" / "slow")),
            ("simulate", model, "--drive", drive, "--out", f"{directory}/run"),
        ):
            assert command(*words).run() == 0, words
    from torture.campaigns.files import READERS

    with contextlib.chdir(seeds):
        for name, reader in READERS.items():
            reader.read(Path(name))
    gc.collect()
    gc.freeze()  # a collection would make each child copy all that it inherits


def run(case: Case, directory: Path, show: bool = False) -> list[Outcome]:
    """The outcomes of a case's steps, of commands up to the first failure, from a child in a new directory.

    With `show` the texts of the steps go to this process's own output as well.
    """
    shutil.rmtree(directory, ignore_errors=True)
    (directory / "files").mkdir(parents=True)
    for name, content in case.files.items():
        (directory / "files" / name).parent.mkdir(parents=True, exist_ok=True)
        (directory / "files" / name).write_bytes(content)
    sys.stdout.flush()
    read, write = os.pipe()
    before = _resident()
    child = os.fork()
    if child == 0:
        os.close(read)
        _child(case, directory, write)
    os.close(write)
    outcomes, hung = _followed(child, read, case.wall)
    _, status, usage = os.wait4(child, 0)
    _kill_group(child)
    if len(outcomes) < len(case.steps) and (hung or status != 0):
        step = case.steps[len(outcomes)].label
        outcomes.append(_ended(status, hung, step, _text(directory / f"{len(outcomes)}.err")))
    used = usage.ru_maxrss // 1024 - before
    if used > case.memory and not outcomes[-1].failed:
        outcomes[-1].kind, outcomes[-1].detail = "memory", f"{used} MB at the peak"
    if show:
        for number in range(len(outcomes)):
            print(_text(directory / f"{number}.out") + _text(directory / f"{number}.err"), end="")
    return outcomes


def _resident() -> int:
    """Memory that a child inherits [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() >> 20


def _followed(child: int, read: int, wall: float) -> tuple[list[Outcome], bool]:
    """What the child tells, and whether it had to be killed: it waits without using CPU."""
    text, hung, used = b"", False, 0.0
    while True:
        if not select.select([read], [], [], wall)[0]:
            if (now := cpu_of(child)) > used + 0.5:  # slow since the machine is busy; RLIMIT_CPU ends it
                used = now
                continue
            hung = True
            _kill_group(child)
        piece = os.read(read, 65536)
        if not piece:
            break
        text += piece
    os.close(read)
    return [Outcome(**json.loads(line)) for line in text.splitlines() if line.endswith(b"}")], hung


def cpu_of(process: int) -> float:
    """CPU that a running process has used [s]; infinite if it has ended."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return math.inf
    return math.inf if fields[0] == "Z" else (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _kill_group(child: int) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(child, signal.SIGKILL)


def _ended(status: int, hung: bool, step: str, err: str) -> Outcome:
    """The outcome of a step that ended its process."""
    last = err.strip().splitlines()[-1][:300] if err.strip() else ""
    if hung or (os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU):
        return Outcome("hang", step, f"waits for ever: {last}" if hung else f"too much CPU: {last}")
    if os.WIFSIGNALED(status):
        return Outcome("crash", step, f"{signal.Signals(os.WTERMSIG(status)).name}: {last}")
    return Outcome("crash", step, f"leaves with exit code {os.WEXITSTATUS(status)}: {last}")


def _child(case: Case, directory: Path, report: int) -> NoReturn:
    """Runs the steps, telling of each."""
    try:
        os.setsid()
        os.chdir(directory / "files")
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        warnings.resetwarnings()
        _limit(resource.RLIMIT_CORE, 0)
        _limit(resource.RLIMIT_AS, int(Path("/proc/self/statm").read_text().split()[0]) * 4096 + CAP)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if case.prepare is not None:
            case.prepare()
        for number, step in enumerate(case.steps):
            outcome = _tried(step, directory, number)
            os.write(report, json.dumps(asdict(outcome)).encode() + b"\n")
            if outcome.failed and step.command:
                break
    except BaseException:
        traceback.print_exc()
        os._exit(70)
    os._exit(0)


def _limit(which: int, value: int) -> None:
    resource.setrlimit(which, (value, resource.getrlimit(which)[1]))


def _tried(step: Step, directory: Path, number: int) -> Outcome:
    before = _names()
    for stream, name in ((1, "out"), (2, "err")):
        os.dup2(os.open(directory / f"{number}.{name}", os.O_WRONLY | os.O_CREAT | os.O_TRUNC), stream)
    sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", encoding="utf-8", closefd=False, buffering=1)  # noqa: SIM115
    usage = resource.getrusage(resource.RUSAGE_SELF)
    _limit(resource.RLIMIT_CPU, int(usage.ru_utime + usage.ru_stime) + step.cpu + 1)
    values: dict[str, object] = {}
    try:
        found = step.run()
        sys.stdout.flush()
        kind, detail = ("ok", "") if not step.command else ("", "")
        values = found if isinstance(found, dict) else {}
    except BaseException as error:
        found, (kind, detail) = None, of_exception(error)
        values = getattr(error, "values", {})
    err = _text(directory / f"{number}.err")
    if step.command or kind == "ok":
        kind, detail = of_command(found if step.command else 0, _text(directory / f"{number}.out"), err)
    if step.must_tell and kind == "ok" and "warning: " not in err:
        kind, detail = "wrong result", "a success without a warning"
    left = {
        name for name in _names() - before if name.split("/")[0] not in (step.writes if kind == "ok" else ())
    }
    if left and kind in ("ok", "refused", "numbers"):
        kind, detail = "left files", f"{', '.join(sorted(left)[:5])} after: {detail or 'exit 0'}"
    return Outcome(kind, step.label, detail, values)


def _names() -> set[str]:
    return {str(path.relative_to(".")) for path in Path().rglob("*")}


def _text(path: Path) -> str:
    return path.read_text(errors="replace") if path.exists() else ""
