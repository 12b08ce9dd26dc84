"""The work of a campaign: which run a sample is, and batches of runs, each with its outcome or its reason."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from flexarm.arrays import Floats
from flexarm.campaigns.outcome import Outcome, Runner
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
    return [
        _row(job, sample, case, values)
        for sample, case, values in zip(task.samples, task.cases, task.values, strict=True)
    ]


def _row(job: Job, sample: int, case: int, values: Sequence[float] | Floats) -> Row:
    began = time.perf_counter()
    try:
        outcome, reason = job.runner.outcome(job.variation.arm(list(values)), case), ""
    except Exception as error:  # a failed variant is a row, whatever it fails in
        outcome, reason = None, reason_of(error)
    return Row(sample, outcome, reason, time.perf_counter() - began)


def reason_of(error: BaseException) -> str:
    """Return an error in one line."""
    told = " ".join(str(error).split())
    known = type(error).__module__.startswith("flexarm")
    return printable(told if known and told else f"{type(error).__name__}: {told}")
