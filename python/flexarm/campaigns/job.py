"""The work of a campaign: which run a sample is, and batches of runs, each with its outcome or its reason."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.campaigns.outcome import Outcome, Runner, tried
from flexarm.campaigns.variation import Variation
from flexarm.errors import printable


@dataclass(frozen=True)
class Job:
    """All that a worker needs but the values of the samples; it is sent to each once."""

    variation: Variation
    """The model and what varies in it."""
    runner: Runner


@dataclass(frozen=True)
class Task:
    """Samples that one worker computes in a row."""

    samples: tuple[int, ...]
    cases: tuple[int, ...]
    """The case of each."""
    values: Floats
    """Their parameters, shape (samples, parameters)."""

    def singly(self) -> list[Task]:
        """Return a task for each sample."""
        return [
            Task((sample,), (case,), self.values[[k]])
            for k, (sample, case) in enumerate(zip(self.samples, self.cases, strict=True))
        ]


@dataclass(frozen=True)
class Row:
    """One sample, computed."""

    sample: int
    outcome: Outcome | None
    """What is kept; None of one that failed."""
    reason: str = ""
    """Why it failed."""
    seconds: float = 0.0
    """Time of the run [s]."""


def computed(job: Job, task: Task) -> list[Row]:
    """Return the rows of a task; whatever a run raises is its reason."""
    size = job.runner.at_once
    rows = []
    for first in range(0, len(task.samples), size):
        some = slice(first, first + size)
        rows += _together(job, task.samples[some], task.cases[some], task.values[some])
    return rows


def _together(job: Job, samples: Sequence[int], cases: Sequence[int], values: Floats) -> list[Row]:
    """Return the rows of runs that are made together; each took its share of the time."""
    began = time.perf_counter()
    arms = [tried(job.variation.arm, list(each)) for each in values]
    found: list[Outcome | Exception] = [arm if isinstance(arm, Exception) else {} for arm in arms]
    made = {k: arm for k, arm in enumerate(arms) if isinstance(arm, Arm)}
    outcomes = job.runner.outcomes(list(made.values()), [cases[k] for k in made])
    for k, outcome in zip(made, outcomes, strict=True):
        found[k] = outcome
    seconds = (time.perf_counter() - began) / len(samples)
    return [
        Row(sample, None, reason_of(each), seconds)
        if isinstance(each, Exception)
        else Row(sample, each, "", seconds)
        for sample, each in zip(samples, found, strict=True)
    ]


def reason_of(error: BaseException) -> str:
    """Return an error in one line."""
    told = " ".join(str(error).split())
    known = type(error).__module__.startswith("flexarm")
    return printable(told if known and told else f"{type(error).__name__}: {told}")
