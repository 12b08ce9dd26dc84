"""What the engine of campaigns costs, and whether its memory stays flat.

    python benchmarks/campaign.py [--swing VARIANTS]

Runs of a fixed time sleep, so that what is measured is the engine alone, whatever else the machine does. The
overhead of a campaign of N runs of T s on W workers is

    elapsed W / (N T) - 1                                                                                 (1)

of the tasks alone, once workers are there; their start is told by itself. For 1, 10, 100 ms and 1 s, in
tasks as `flexarm.campaigns.run_study.task_size` sizes them, and one by one. Memory is that of this process,
with the scheduler, after a tenth of many short tasks and after all of them.

With `--swing` so many variants of the swing (problem.py) run instead, in the elements and steps that reach
0.01 mm, and statistics of the tip are kept.
"""

from __future__ import annotations

import argparse
import os
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import psutil

import flexarm
from flexarm.campaigns.engine import client_of, compute_with
from flexarm.campaigns.job import Job, Task
from flexarm.campaigns.outcome import Outcome, Variable
from flexarm.campaigns.plan import cut
from flexarm.campaigns.run_study import task_size
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
    parser.add_argument("--swing", type=int, help="variants of the swing")
    options = parser.parse_args()
    workers = options.workers
    if options.swing:
        swing(options.swing, workers)
        return
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


ELEMENTS, STEP = 1, 2.5e-3  # of the swing at 0.01 mm (docs/benchmarks.md)
STUDY = f"""format = "flexarm-study/1"
run = "simulate"
model = "arm.toml"
drive = "swing.csv"
step = {STEP}
sampling = {{method = "sobol", n = COUNT, seed = 1}}
vary = [
    {{parameter = "links.rod.material.youngs_modulus", distribution = "normal", std = 2e9}},
    {{parameter = "payloads.load.mass", distribution = "normal", std = 0.07}},
    {{parameter = "effects.joint_compliance.hinge.stiffness", distribution = "lognormal", std = 1e4}},
]
keep = [{{quantity = "position", point = "tip", statistics = ["rms", "max", "final"]}}]
"""


def swing(count: int, workers: int) -> None:
    """Print the time of a campaign of the swing, by the clock and of the processors, and its memory."""
    import problem
    from solve_flexarm import swinging_arm

    with TemporaryDirectory() as folder:
        room = Path(folder)
        swinging_arm(ELEMENTS).to_toml(room / "arm.toml")
        time_s = np.linspace(0, problem.END, 2001)
        rows = np.c_[time_s, problem.angle(time_s)]
        np.savetxt(room / "swing.csv", rows, "%.12f", ",", header="time_s,hinge", comments="")
        (room / "study.toml").write_text(STUDY.replace("COUNT", str(count)))
        process, most = psutil.Process(), [0.0]

        def look(done: float, what: str) -> None:
            family = (process, *process.children(recursive=True))
            most.append(sum(each.memory_info().rss for each in family) / 2**20)

        began = time.perf_counter()
        done = flexarm.campaign(room / "study.toml", room / "out", n_jobs=workers, progress=look)
        spent = time.perf_counter() - began
        runs, computing = done.record["runs"], done.record["run_seconds"]
    print(
        f"{runs['ok']} of {count} runs on {workers} workers: {spent:.1f} s, {computing:.1f} s of computing, "
        f"overhead {100 * (spent * workers / computing - 1):.0f} %, at most {max(most):.0f} MB; "
        f"1e5 would take {1e5 / count * spent:.0f} s (load {os.getloadavg()[0]:.1f})"
    )


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
