"""Wrong options of the command line: each of each command with values that it cannot have."""

from __future__ import annotations

import random
from pathlib import Path

from torture.campaign import Campaign
from torture.campaigns.processes import COMMANDS, WRITES, needed
from torture.sandbox import CPU, Case, command

NUMBERS = (
    "",
    "x",
    "nan",
    "inf",
    "-inf",
    "-1",
    "0",
    "1e-300",
    "1e-80",
    "1e-9",
    "1e9",
    "1e300",
    "9" * 400,
    "0x1",
)
COUNTS = ("", "x", "-1", "0", "1.5", "1000000000", "9" * 30, "9" * 5000)
NAMES = (
    "",
    "=",
    "nobody",
    "hinge=",
    "=0.1",
    "hinge=nan",
    "hinge=1e300",
    "hinge=1=2",
    "\x1b[2J=1",
    "x" * 5000,
)
PATHS = ("", "nowhere/at/all", ".", "..", "/", "/dev/null", "arm.toml", "slow", "x" * 300, "-")
OPTIONS: dict[str, dict[str, tuple[str, ...]]] = {
    "simulate": {
        "--step": NUMBERS,
        "--alpha": NUMBERS,
        "--seed": COUNTS,
        "--drive": PATHS,
        "--out": PATHS,
    },
    "linearise": {"--joint": NAMES, "--input": NAMES, "--output": NAMES, "--modes": COUNTS, "--out": PATHS},
    "modes": {"--joint": NAMES, "--count": COUNTS},
    "static": {"--joint": NAMES},
    "compare": {"--step": NUMBERS, "--nothing": NAMES},
    "check": {"--nothing": NAMES, "--max-seconds": NUMBERS},
    "example": {"--nothing": NAMES},
    "import": {"--model": PATHS, "--out": PATHS},
    "diagnose": {
        **{option: NUMBERS for option in ("--step", "--max-seconds")},
        **{option: COUNTS for option in ("--jobs", "--seed")},
        **{option: PATHS for option in ("--hold-out", "--out")},
    },
    "calibrate": {
        **{option: NUMBERS for option in ("--step", "--max-seconds")},
        **{"--family": NAMES, "--jobs": COUNTS, "--hold-out": PATHS, "--out": PATHS},
    },
    "plan": {"--drive": PATHS, "--jobs": COUNTS, "--out": PATHS},
    "campaign": {"--scheduler": ("", "x", "tcp://127.0.0.1:1"), "--jobs": COUNTS, "--out": PATHS},
    "export": {"--urdf": PATHS, "--mjcf": PATHS, "--unit": NAMES, "--out": PATHS},
    "view": {
        **{option: PATHS for option in ("--record", "--model", "--mesh", "--out")},
        **{"--joint": NAMES, "--scale": NUMBERS},
    },
    "reproduce": {"--nothing": NAMES},
    "reduce": {
        "--unit": (*NAMES, "mm", "km"),
        "--interface": (*NAMES, "a=BORE:soft", "c=BORE"),
        "--modes": COUNTS,
        "--max-frequency": NUMBERS,
        "--mass": NUMBERS,
        "--damping-ratio": NUMBERS,
        "--merge": NUMBERS,
        "--material": (*NAMES, "E=1,nu=2,rho=3", "E=1e300,nu=0.3,rho=1e-300", "E=nan,nu=0,rho=0"),
        "--picture": PATHS,
        "--out": PATHS,
    },
}
RIGHT = {name: words for name, (_, words) in COMMANDS.items()} | {"reproduce": ("reproduce",)}
SEARCHES = ("diagnose", "calibrate", "plan")
"""Commands that may take a minute where the wrong option is none."""
TRIALS = [
    (name, option, value)
    for name, options in OPTIONS.items()
    for option, values in options.items()
    for value in values
]


def case(number: int, rng: random.Random, seeds: Path) -> Case:
    order = random.Random(0).sample(TRIALS, len(TRIALS))
    name, option, value = order[number % len(order)]
    words = list(RIGHT[name])
    if option in words and option != "--interface":
        words[words.index(option) + 1] = value
    else:
        words += [option, value]
    label = f"{name} {option} {value[:40]!r}"
    step = command(*words, writes=(*WRITES, "nowhere", *PATHS), cpu=60 if name in SEARCHES else CPU)
    return Case(label, (step,), needed(seeds))


CAMPAIGN = Campaign("options", "wrong options of the command line", case, len(TRIALS), 40)
