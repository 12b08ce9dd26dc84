"""How many runs make a task, from the time that one run takes."""

from __future__ import annotations

import os
import time

from flexarm.arm import Arm
from flexarm.campaigns.outcome import Runner

TASK_SECONDS, FOR_EACH_WORKER = 2.0, 0.02
"""Time that a task should take at least, and for each worker [s]: the engine needs 5 to 10 ms for one."""


def seconds_of_a_run(runner: Runner, arm: Arm, nominal: float) -> float:
    """Return the time of one run among others [s], given that of the nominal one, which loads libraries."""
    found = nominal
    for size in (1, runner.at_once):
        if found * size > TASK_SECONDS:
            break
        began = time.perf_counter()
        runner.outcomes([arm] * size, [0] * size)
        found = min(found, (time.perf_counter() - began) / size)
    return found


def alone(jobs: int | None, seconds: float) -> bool:
    """Return True if this process should compute alone: one job, or less work than a start of workers."""
    start_seconds = 5.0  # work for which no workers are started [s]
    return (jobs or os.cpu_count() or 1) == 1 or (jobs is None and seconds < start_seconds)


def task_size(seconds: float, row_bytes: int, workers: int) -> int:
    """Return the greatest number of runs in a task, given the time [s] and the size of one."""
    task_bytes, task_runs = 2**25, 10_000  # what a task may return at most: bytes of rows, and rows
    enough = int(max(TASK_SECONDS, FOR_EACH_WORKER * workers) / max(seconds, 1e-6))
    return max(1, min(enough, task_bytes // row_bytes, task_runs))
