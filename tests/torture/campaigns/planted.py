"""Failures planted on purpose: the harness tells each by its name, or it would find nothing elsewhere."""

from __future__ import annotations

import ctypes
import os
import random
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

from torture.campaign import Campaign
from torture.outcome import Failure
from torture.sandbox import Case, Step, run


def _traceback() -> int:
    sys.stderr.write("Traceback (most recent call last):\nKeyError: 'x'\n")
    return 1


def _refused() -> int:
    print("error: arm.toml: links.rod.mass: must be positive, got -1 kg", file=sys.stderr)
    return 2


def _mumbled() -> int:
    print("error", file=sys.stderr)
    return 2


def _coloured() -> int:
    print("error: arm.toml: name: must not be \x1b[31mred", file=sys.stderr)
    return 2


def _waits() -> None:
    time.sleep(100)


def _spins() -> None:
    while True:
        pass


def _swells() -> None:
    bytearray(1_200_000_000)[::4096]


def _leaves() -> int:
    Path(".arm.partial-1").mkdir()
    return 0


def _foreign() -> None:
    {}["nobody"]


def _deep() -> None:
    sum([None, 1])  # type: ignore[list-item]


def _clumsy() -> None:
    raise TypeError("mass must be a number, got 'heavy'")


def _wrong() -> None:
    raise Failure("wrong result", "energy comes from nowhere")


PLANTED: tuple[tuple[str, Callable[[], object], bool], ...] = (
    ("ok", lambda: 0, True),
    ("refused", _refused, True),
    ("refused", _clumsy, False),
    ("wrong result", _wrong, False),
    ("crash", lambda: ctypes.string_at(0), False),
    ("crash", lambda: os._exit(3), False),
    ("traceback", _traceback, True),
    ("foreign exception", _foreign, False),
    ("foreign exception", _deep, False),
    ("raw warning", lambda: warnings.warn("overflow", RuntimeWarning, stacklevel=1) or 0, True),
    ("unclear message", _mumbled, True),
    ("unclear message", _coloured, True),
    ("hang", _waits, False),
    ("hang", _spins, False),
    ("memory", _swells, False),
    ("memory", lambda: bytearray(1 << 36), False),
    ("left files", _leaves, True),
)


def case(number: int, rng: random.Random, seeds: Path) -> Case:
    """A case whose step is right if the sandbox calls what was planted by its name."""
    kind, act, command = PLANTED[number % len(PLANTED)]
    inner = Case(
        kind,
        (Step("planted", act, command=command, cpu=1 if act is _spins else 10),),
        wall=2 if act is _waits else 30,
    )

    def named() -> None:
        found = run(inner, Path(tempfile.mkdtemp()))[-1].kind
        if found != kind:
            raise Failure("wrong result", f"{kind} was planted, {found} was found")

    return Case(f"planted: {kind}", (Step("planted", named),), wall=60, memory=4000)


CAMPAIGN = Campaign("planted", "failures planted in the harness", case, len(PLANTED), len(PLANTED))
