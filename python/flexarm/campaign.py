"""Many runs at once: records, candidates, drives, side by side on the machine's cores.

The core computes without the interpreter's lock, so threads are enough: nothing is copied or pickled.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from flexarm.arm import Arm
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter
from flexarm.record import Record
from flexarm.simulation import Progress, Simulation, reported, simulate


def simulate_all(
    runs: Iterable[tuple[Arm, Drive | Record]],
    *,
    jobs: int | None = None,
    progress: Progress = None,
    **options: Any,
) -> list[Simulation]:
    """Several runs, each as `simulate` makes it, on several cores.

    Parameters
    ----------
    runs : iterable of (Arm, Drive or Record)
        What to run.
    jobs : int, optional
        Number of threads; default one a core.
    progress : bool or callable, optional
        As in `simulate`, for the whole. What a callable returns False for is the rest of the runs.
    **options
        Of every run: `step`, `alpha`, `end`, `forces`, `rotations`, `sensitivities`.

    Returns
    -------
    list of Simulation
        In the order of `runs`; only those that were finished if `progress` said stop.

    Raises
    ------
    InvalidParameter, NotConverged
        Of the first run that fails; runs that have not begun are then left out.
    """
    wanted = list(runs)
    threads = jobs if jobs is not None else (os.cpu_count() or 1)
    if threads < 1:
        raise InvalidParameter(f"must be at least 1, got {threads}", where="jobs")
    found: list[Simulation] = []
    with reported(progress, f"{len(wanted)} runs") as report, ThreadPoolExecutor(threads) as pool:
        waiting = [pool.submit(simulate, arm, drive, **options) for arm, drive in wanted]
        try:
            for each in waiting:
                found.append(each.result())
                if report is not None and report(len(found) / len(wanted)) is False:
                    break
        finally:
            for each in waiting:
                each.cancel()
    return found
