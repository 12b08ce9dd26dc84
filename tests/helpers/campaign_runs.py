"""Studies and runs for tests of campaigns; workers import this, so that runs can count themselves and die."""

import os
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from arms import TUBE, beam, hinge, point

import flexarm
from flexarm.campaigns.job import Job, Task
from flexarm.campaigns.outcome import Runner, Variable
from flexarm.campaigns.sampling import Distribution
from flexarm.campaigns.study import Study
from flexarm.campaigns.variation import Variation, variation_of

MASS = "payloads.load.mass"
SIMULATED = """
format = "flexarm-study/1"
run = "simulate"
model = "arm.toml"
drive = "swing.csv"
step = 5e-3
[sampling]
method = "sobol"
n = 16
seed = 1
[[vary]]
parameter = "payloads.load.mass"
distribution = "normal"
std = 0.1
[[vary]]
parameter = "effects.backlash.hinge.gap"
distribution = "uniform"
low = 1e-5
high = 1e-3
[[keep]]
quantity = "position"
point = "tip"
rate_hz = 10
statistics = ["rms", "max", "final"]
tolerance = 1e-3
"""
STATIC = """
format = "flexarm-study/1"
run = "static"
model = "arm.toml"
joints = { hinge = 0.5 }
[sampling]
method = "random"
n = 50
seed = 3
[[vary]]
parameter = "payloads.load.mass"
distribution = "uniform"
low = 1.0
high = 3.0
[[keep]]
quantity = "displacement"
point = "tip"
"""


def arm() -> flexarm.Arm:
    """A tube on a soft hinge, with 2 kg at its tip; its mass is uncertain by 1 %."""
    return flexarm.Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [beam("rod", [0, 0, 1.0], TUBE, elements=2, damping_ratio=0.01)],
            "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 1.0], "mass": 2.0}],
            "points": [point("tip", "rod", [0, 0, 1.0])],
            "effects": [{"name": "joint_compliance", "at": "hinge", "stiffness": 2e4, "damping": 20.0}],
            "uncertainty": {MASS: 0.01, "points.tip.position_m": 0.001},
        }
    )


def study_in(folder: Path, text: str = SIMULATED) -> Path:
    """The file of a study, with its model and drive beside it."""
    arm().to_toml(folder / "arm.toml")
    time_s = np.linspace(0, 1.0, 11)
    rows = [f"{t:.1f},{0.3 * np.sin(np.pi * t / 2) ** 2:.6f}" for t in time_s]
    (folder / "swing.csv").write_text("\n".join(["time_s,hinge", *rows, ""]))
    (folder / "study.toml").write_text(text)
    return folder / "study.toml"


@dataclass
class LoggedRun(Runner):
    """A run that takes a while, tells in a file that it was made, and may kill its process.

    Attributes
    ----------
    log : Path
        Gets a line for each run: its mass and process.
    seconds : float
        Time of one.
    deadly : float
        Mass above which the process ends at once.
    """

    log: Path
    seconds: float = 0.02
    deadly: float = np.inf
    variables: tuple[Variable, ...] = (Variable("twice", "kg", "twice the mass"),)

    def nominal(self, arm: flexarm.Arm) -> list:
        return []

    def outcome(self, arm: flexarm.Arm, case: int) -> dict:
        mass = arm.payload("load").mass
        with self.log.open("a") as file:
            file.write(f"{mass!r} {os.getpid()}\n")
        if mass > self.deadly:
            os._exit(9)
        time.sleep(self.seconds)
        return {"twice": 2 * mass}


def logged_job(log: Path, **options: float) -> Job:
    """The job of runs that tell they were made."""
    study = Study(
        run="static",
        model="arm.toml",
        sampling={"n": 1},
        vary=[{"parameter": MASS, "distribution": "uniform", "low": 1.0, "high": 2.0}],
        keep=[{"quantity": "position", "point": "tip"}],
    )
    variation, found = variation_of(study, arm())
    assert found == []
    assert isinstance(variation, Variation)
    assert variation.distributions == (Distribution("uniform", (1.0, 2.0)),)
    return Job(variation, LoggedRun(log, **options))


def tasks_of(masses: list[float], size: int) -> list[Task]:
    """Tasks of runs with these masses."""
    return [
        Task(
            tuple(range(first, min(first + size, len(masses)))),
            (0,) * len(masses[first : first + size]),
            np.array(masses[first : first + size])[:, None],
        )
        for first in range(0, len(masses), size)
    ]
