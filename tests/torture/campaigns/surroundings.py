"""Commands without what they count on: room on the disk, a place of their own, streams, a backend."""

from __future__ import annotations

import os
import random
import resource
from collections.abc import Callable
from pathlib import Path
from typing import Any

from torture.campaign import Campaign
from torture.campaigns.processes import COMMANDS, WRITES, Ended, after, ended, must, needed, started
from torture.campaigns.signals import KILLED, entries, whole
from torture.outcome import of_command
from torture.sandbox import Case, Step

OWN: dict[str, tuple[str, ...]] = {
    "slow": ("simulate", "arm.toml", "--drive", "slow", "--out", "slow", "--force"),
    "model.mat": ("linearise", "model.mat", "--out", "model.mat", "--force"),
    "model.nc": ("linearise", "model.nc", "--out", "model.nc", "--force"),
    "arm.toml": ("simulate", "arm.toml", "--drive", "swing.csv", "--out", "arm.toml", "--force"),
}
"""What a command reads, and would write over."""


def told(found: Ended) -> None:
    """Fails unless the exit code and the texts are those of a success or a refusal."""
    must(found.code >= 0, "crash", lambda: f"signal {-found.code}: {found.err[-200:]}")
    kind, detail = of_command(found.code, found.out, found.err)
    must(kind in ("ok", "refused"), kind, detail)


def full(name: str, size: int) -> None:
    """No file may grow beyond a size, as on a full disk: whole output, or a refusal and none.

    What a campaign has done stays, if it says so; `--resume` must go on.
    """
    before, words = entries(), COMMANDS[name][1]
    found = ended(started(words, preexec_fn=lambda: _limit(size)))
    told(found)
    if "--resume goes on" in found.err:
        found = ended(started((*words, "--resume")))
        must(found.code == 0, "wrong result", lambda: f"--resume ends with {found.code}: {found.err[-200:]}")
    if found.code == 0:
        whole(name)
        before |= {entry for entry in entries() if entry.split("/")[0] in WRITES}
    left = entries() - before
    must(not left, "left files", f"{', '.join(sorted(left))[:200]} after: {found.err[-100:]}")


def _limit(size: int) -> None:
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"  # a .pyc file that is cut off would outlive this run
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def twice(name: str, apart: float) -> None:
    """Two runs into one new place: one writes it, the other is refused."""
    one = started(COMMANDS[name][1])
    after(one, apart)
    two = started(COMMANDS[name][1])
    found = [ended(process) for process in (one, two)]
    for each in found:
        told(each)
    codes = sorted(each.code for each in found)
    must(codes == [0, 2], "wrong result", f"two runs into one place end with {codes[0]} and {codes[1]}")
    whole(name)


def over(place: str) -> None:
    """A command that would write over its own input leaves it as it is."""
    before = _contents(place)
    told(ended(started(OWN[place])))
    must(_contents(place) == before, "wrong result", f"writes over {place}, which it reads")


def _contents(place: str) -> dict[str, bytes]:
    files = [Path(place)] if Path(place).is_file() else Path(place).rglob("*")
    return {str(file): file.read_bytes() for file in files if file.is_file()}


def without(name: str, how: str) -> None:
    """A stream that is closed, full or read by nobody, or an environment that lacks something."""
    words = COMMANDS[name][1]
    if how in ("no stdout", "no stderr", "no stdin"):
        number = {"no stdin": 0, "no stdout": 1, "no stderr": 2}[how]
        return told(ended(started(words, preexec_fn=lambda: os.close(number))))
    if how == "full stdout":
        with Path("/dev/full").open("wb") as out:
            return told(ended(started(words, stdout=out)))
    if how == "no reader":
        read, write = os.pipe()
        os.close(read)
        process = started(words, stdout=write)
        os.close(write)
        return told(ended(process))
    Path("arm.toml").write_text(Path("arm.toml").read_text().replace('"example arm"', '"Übergröße ω"'))
    return told(ended(started(words, env=os.environ | ENVIRONMENTS[how])))


ENVIRONMENTS: dict[str, dict[str, str]] = {
    "an ASCII terminal": {"PYTHONIOENCODING": "ascii", "LC_ALL": "C"},
    "an unknown encoding": {"LC_ALL": "nowhere.UTF-9"},
    "no backend": {"MPLBACKEND": "none"},
    "an unknown backend": {"MPLBACKEND": "nothing"},
    "no home": {"HOME": "/nowhere", "MPLCONFIGDIR": "/nowhere/matplotlib"},
    "a narrow terminal": {"COLUMNS": "1", "TERM": "dumb"},
}
STREAMS = ("no stdout", "no stderr", "no stdin", "full stdout", "no reader")


def trials() -> dict[str, Callable[[random.Random], Any]]:
    """What may be tried, by what one would call it."""
    found: dict[str, Callable[[random.Random], Any]] = {}
    for name in KILLED:
        found[f"{name} on a full disk"] = lambda rng, name=name: full(name, int(10 ** rng.uniform(2, 5.5)))
        found[f"{name} twice at once"] = lambda rng, name=name: twice(name, rng.uniform(0, 0.8))
    for place in OWN:
        found[f"{OWN[place][0]} over {place}"] = lambda rng, place=place: over(place)
    for name in COMMANDS:
        for how in (*STREAMS, *ENVIRONMENTS):
            found[f"{name} with {how}"] = lambda rng, name=name, how=how: without(name, how)
    return found


def case(number: int, rng: random.Random, seeds: Path) -> Case:
    found = trials()
    order = list(found)
    random.Random(1).shuffle(order)
    label = order[number % len(order)]
    step = Step(label, lambda: found[label](rng), writes=WRITES, cpu=300)
    files = needed(seeds)
    files |= dict.fromkeys(("model.mat", "model.nc"), files["arm.toml"])
    return Case(label, (step,), files, wall=600)


CAMPAIGN = Campaign(
    "surroundings", "full disks, two runs at once, streams, environments", case, len(trials()), 10
)
