"""What the engine of campaigns costs, and whether its memory stays flat.

    python benchmarks/campaign.py

Runs of a fixed time sleep, so that what is measured is the engine alone, whatever else the machine does. The
overhead of a campaign of N runs of T s on W workers is

    elapsed W / (N T) - 1                                                                                 (1)

of the tasks alone, once workers are there; their start is told by itself. For 1, 10, 100 ms and 1 s, in
tasks as `flexarm.campaigns.campaign` sizes them, and one by one. Memory is that of this process, with the
scheduler, after a tenth of many short tasks and after all of them.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import psutil

import flexarm
from flexarm.campaigns.campaign import task_size
from flexarm.campaigns.engine import client_of, compute_with
from flexarm.campaigns.job import Job, Task
from flexarm.campaigns.outcome import Outcome, Variable
from flexarm.campaigns.plan import cut
from flexarm.campaigns.store import Store
from flexarm.campaigns.variation import Variation

MODEL = Path(__file__).parents[1] / "examples" / "one_link.toml"


@dataclass
class Sleep:
    """A run that takes its time and returns a series as a simulation would."""

    seconds: float
    length: int = 500
    variables: tuple[Variable, ...] = ()

    def nominal(self, arm: flexarm.Arm) -> list[Outcome]:
        return []

    def outcome(self, arm: flexarm.Arm, case: int) -> Outcome:
        if self.seconds:
            time.sleep(self.seconds)
        return {"series": np.zeros(self.length)}


def tasks(count: int, size: int, workers: int):
    for first, last in cut(count, size, workers):
        samples = tuple(range(first, last))
        yield Task(samples, (0,) * len(samples), np.zeros((len(samples), 0)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=20.0, help="of each measurement, roughly")
    parser.add_argument("--short", type=int, default=20_000, help="runs of the measurement of memory")
    options = parser.parse_args()
    workers = options.workers
    variation = Variation(flexarm.Arm.from_toml(MODEL), frozenset(), (), (), (), ())
    with TemporaryDirectory() as folder:
        began = time.perf_counter()
        with client_of(None, workers, Path(folder) / "room") as client:
            compute_with(
                client, Job(variation, Sleep(0.0)), tasks(8 * workers, 1, workers), lambda rows: None
            )
            print(f"start of {workers} workers, first tasks: {time.perf_counter() - began:.1f} s")
            print("| run [s] | runs | in a task | overhead [%] |\n|---|---|---|---|")
            for seconds in (1e-3, 1e-2, 1e-1, 1.0):
                count = int(options.seconds * workers / seconds)
                for size in sorted({1, task_size(seconds, 4000, workers)}):
                    runs = min(count, 4000) if size == 1 else count
                    put = fresh_store(Path(folder)).put
                    began = time.perf_counter()
                    compute_with(client, Job(variation, Sleep(seconds)), tasks(runs, size, workers), put)
                    spent = (time.perf_counter() - began) * workers / (runs * seconds) - 1  # eq. (1)
                    print(f"| {seconds:g} | {runs} | {size} | {100 * spent:.1f} |", flush=True)
            memory(client, variation, fresh_store(Path(folder)), options.short)


def memory(client, variation: Variation, store: Store, count: int) -> None:
    """Print the memory of this process along many short tasks."""
    process, sizes, done = psutil.Process(), [], 0

    def put(rows) -> None:
        nonlocal done
        store.put(rows)
        done += len(rows)
        sizes.append((done, process.memory_info().rss / 2**20))

    compute_with(client, Job(variation, Sleep(0.0)), tasks(count, 5, 2), put)
    tenth = next(size for done, size in sizes if done >= count / 10)
    last = sizes[-1][1]
    print(f"client and scheduler: {tenth:.0f} MB after {count // 10} runs, {last:.0f} after {count}")


def fresh_store(folder: Path) -> Store:
    room = folder / "files"
    room.mkdir(exist_ok=True)
    store = Store(folder, room)
    store.clear()
    return store


if __name__ == "__main__":
    main()
