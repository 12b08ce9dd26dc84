"""Many runs at once: records, candidates, drives, side by side on the machine's cores.

The core computes without the interpreter's lock, so threads are enough: nothing is copied or pickled.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from threading import Event
from typing import Any

from flexarm.arguments import ITEMS, JOBS, takes
from flexarm.arm import Arm
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter
from flexarm.record import Record
from flexarm.simulation.progress import Progress, reported
from flexarm.simulation.simulate import simulate
from flexarm.simulation.simulation import Simulation
from flexarm.threads import thread_pool


@takes(runs=ITEMS, jobs=JOBS)
def simulate_all(
    runs: Iterable[tuple[Arm, Drive | Record]],
    *,
    jobs: int | None = None,
    progress: Progress = None,
    stop: Callable[[], bool] | None = None,
    **options: Any,
) -> list[Simulation]:
    """Simulate several runs on several cores.

    Parameters
    ----------
    runs : iterable of (Arm, Drive or Record)
        What to run.
    jobs : int, optional
        Number of threads; default one a core.
    progress : bool or callable, optional
        As in `simulate`, for the whole. What a callable returns False for is the rest of the runs.
    stop : callable, optional
        Asked while runs are under way; once it returns True, those that are not finished are left out.
    **options
        Of every run: `step`, `alpha`, `end`, `forces`, `rotations`, `sensitivities`.

    Returns
    -------
    list of Simulation
        In the order of `runs`; only the first ones that were finished if `progress` or `stop` said so.

    Raises
    ------
    InvalidParameter, NotConverged
        If a run is no pair; else of the first run that fails: runs that have not begun are then left out.
        Also in a process that `progress` forked, which has none of the threads.
    """
    wanted = [_pair(run, k) for k, run in enumerate(runs)]
    threads = jobs if jobs is not None else (os.cpu_count() or 1)
    found: list[Simulation] = []
    stopped, process = Event(), os.getpid()
    ends = stop or (lambda: False)
    options["progress"] = lambda done: not (stopped.is_set() or ends())
    with reported(progress, f"{len(wanted)} runs") as report, thread_pool(threads) as pool:
        waiting = [pool.submit(simulate, arm, drive, **options) for arm, drive in wanted]
        try:
            for each in waiting:
                run = each.result()
                if ends():
                    break
                found.append(run)
                if report is not None and report(len(found) / len(wanted)) is False:
                    break
                if os.getpid() != process:
                    raise InvalidParameter("has forked, and the new process has no threads", where="progress")
        finally:
            stopped.set()  # a run that is under way ends early: on an error, or on Ctrl-C
            for each in waiting:
                each.cancel()
    return found


def _pair(run: Any, k: int) -> tuple[Arm, Drive | Record]:
    """Return a run as a pair of arm and drive; `simulate` checks the drive."""
    if isinstance(run, tuple | list) and len(run) == 2 and isinstance(run[0], Arm):
        return run[0], run[1]
    got = type(run).__name__
    if isinstance(run, tuple | list):
        got = f"({', '.join(type(part).__name__ for part in run)})"
    raise InvalidParameter(f"must be a pair (arm, drive), got {got}", where=f"runs[{k}]")
