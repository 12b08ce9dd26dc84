"""Many runs at once: records, candidates, drives, side by side on the machine's cores.

The core computes without the interpreter's lock, so threads are enough: nothing is copied or pickled. Each
thread takes several arms along one drive at a time, see `flexarm.simulation.side_by_side`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future, wait
from functools import partial
from threading import Event
from typing import Any

from flexarm import _core
from flexarm.arguments import ITEMS, takes
from flexarm.arm import Arm
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter
from flexarm.record import Record
from flexarm.simulation.progress import Progress, Report, reported
from flexarm.simulation.side_by_side import Pair, side_by_side
from flexarm.simulation.simulate import simulate
from flexarm.simulation.simulation import Simulation
from flexarm.threads import thread_pool


@takes(runs=ITEMS)
def simulate_all(
    runs: Iterable[tuple[Arm, Drive | Record]],
    *,
    n_jobs: int | None = None,
    progress: Progress = None,
    stop: Callable[[], bool] | None = None,
    **options: Any,
) -> list[Simulation]:
    """Simulate several runs on several cores.

    Arms of one structure along one drive are computed several at a time in a core's vector registers where
    they fit. Such a run differs from that of `simulate` by a part of what the iteration of its steps leaves
    over, some 1e-9 of the reach in long runs.

    Parameters
    ----------
    runs : iterable of (Arm, Drive or Record)
        What to run.
    n_jobs : int, optional
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
    threads = n_jobs if n_jobs is not None else (os.cpu_count() or 1)
    found: list[Simulation] = []
    stopped = Event()
    ends = stop or (lambda: False)
    shares = [0.0] * len(wanted)
    with reported(progress, f"{len(wanted)} runs") as told, thread_pool(threads) as pool:
        report = None if told is None else _rising(told)
        waiting: list[Future[list[Simulation]]] = []
        places = [(0, 0)] * len(wanted)
        for chosen in _chosen(wanted, threads):
            for place, k in enumerate(chosen):
                places[k] = len(waiting), place
            options["progress"] = partial(_under_way, shares, chosen, lambda: stopped.is_set() or ends())
            waiting.append(pool.submit(_simulated, [wanted[k] for k in chosen], dict(options)))
        try:
            for future, place in places:
                if not _awaited(waiting[future], shares, report) or ends():
                    break
                found.append(waiting[future].result()[place])
                if report is not None and report(len(found) / len(wanted)) is False:
                    break
        finally:
            stopped.set()  # a run that is under way ends early: on an error, or on Ctrl-C
            for each in waiting:
                each.cancel()
    return found


def _rising(report: Callable[[float], object]) -> Callable[[float], object]:
    """Return a report whose share never falls; raise InvalidParameter in a process that it forked."""
    most, process = 0.0, os.getpid()

    def rising(done: float) -> object:
        nonlocal most
        most = max(most, done)
        answer = report(most)
        if os.getpid() != process:
            raise InvalidParameter("has forked, and the new process has no threads", where="progress")
        return answer

    return rising


def _under_way(shares: list[float], chosen: Sequence[int], stops: Callable[[], bool], done: float) -> bool:
    """Note the share done of runs that are computed together; return True if they are to go on."""
    for k in chosen:
        shares[k] = done
    return not stops()


def _awaited(runs: Future[list[Simulation]], shares: Sequence[float], report: Report) -> bool:
    """Wait for runs and report the share done of all meanwhile; return False if `report` does so."""
    pause = 1.0  # between two reports [s]
    while report is not None and not wait([runs], pause).done:
        if report(sum(shares) / len(shares)) is False:
            return False
    runs.result()
    return True


def _chosen(wanted: Sequence[Pair], threads: int) -> list[list[int]]:
    """Return the places of runs that a thread takes together: of one drive, as many as vectors hold."""
    along: dict[int, list[int]] = {}
    for k, (_, drive) in enumerate(wanted):
        along.setdefault(id(drive), []).append(k)
    chosen = []
    for places in along.values():
        size = max(1, min(_core.lanes(), -(-len(places) // threads)))
        chosen += [places[first : first + size] for first in range(0, len(places), size)]
    return chosen


def _simulated(pairs: Sequence[Pair], options: dict[str, Any]) -> list[Simulation]:
    """Return runs of which those that fit are computed together."""
    together = side_by_side(pairs, **options) if len(pairs) > 1 else [None]
    return [
        simulate(*pair, **options) if run is None else run for run, pair in zip(together, pairs, strict=True)
    ]


def _pair(run: Any, k: int) -> tuple[Arm, Drive | Record]:
    """Return a run as a pair of arm and drive; `simulate` checks the drive."""
    if isinstance(run, tuple | list) and len(run) == 2 and isinstance(run[0], Arm):
        return run[0], run[1]
    got = type(run).__name__
    if isinstance(run, tuple | list):
        got = f"({', '.join(type(part).__name__ for part in run)})"
    raise InvalidParameter(f"must be a pair (arm, drive), got {got}", where=f"runs[{k}]")
