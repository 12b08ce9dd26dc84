"""Spread the tasks of a campaign over workers, and hand back their rows as they come.

Dask distributes: a cluster of this machine's cores is started without any set-up, or an existing scheduler is
used. Each worker gets the job once, as a plugin, also one that joins later. At most `ahead` tasks a thread
are under way, so the memory of client and scheduler does not grow with the campaign. A worker that dies costs
its tasks, which others take over. The runs of a task under which several died are tried once more, each
alone, and the one under which they die again becomes a failed row.
"""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import Any

from flexarm.campaigns.job import Job, Row, Task, computed, reason_of
from flexarm.errors import InvalidParameter

Client = Any
"""A client of `distributed`, which is imported when it is needed and never with flexarm."""

Put = Callable[[Sequence[Row]], object]


def compute_here(job: Job, tasks: Iterable[Task], put: Put) -> None:
    """Compute all tasks in this process, one after the other."""
    for task in tasks:
        put(computed(job, task))


def compute_with(client: Client, job: Job, tasks: Iterable[Task], put: Put) -> None:
    """Compute all tasks on the workers of a client, and put the rows of each as it comes.

    Raise InvalidParameter if the workers cannot compute at all, or the scheduler goes away; what was put
    stays.
    """
    waiting, under_way, suspects = iter(tasks), dict[Any, Task](), list[Task]()
    with _sent(client, job) as name:
        done = _dask().as_completed([], loop=client.loop, with_results=True, raise_errors=False)

        def submit() -> None:
            for _, task in zip(range(_ahead(client) - len(under_way)), waiting, strict=False):
                future = client.submit(_computed_there, name, task, pure=False)
                under_way[future.key] = task
                done.add(future)

        submit()
        for future, result in done:
            task = under_way.pop(future.key)
            if future.status == "finished":
                put(result)
            else:
                _refuse_unless_killed(future)
                suspects += task.singly()
            future.release()
            submit()
        for task in suspects:  # alone, so that no other run is under way when a worker dies
            put(_alone(client, name, task))


def _alone(client: Client, name: str, task: Task) -> list[Row]:
    """Return the rows of a run under which workers died, tried once more by itself."""
    future = client.submit(_computed_there, name, task, pure=False)
    _dask().wait(future)
    if future.status == "finished":
        found: list[Row] = future.result()
        return found
    _refuse_unless_killed(future)
    return [
        Row(task.samples[0], None, "each worker that tried it died; it may need more memory than there is")
    ]


def _refuse_unless_killed(future: Any) -> None:
    """Raise InvalidParameter if a task was lost for another reason than the death of its workers."""
    error = None if future.status == "cancelled" else future.exception()
    if error is None:
        what = "has lost the runs, or cannot be reached any more; --resume goes on with what is kept"
        raise InvalidParameter(what, where="scheduler")
    if type(error).__name__ != "KilledWorker":
        what = f"cannot compute ({reason_of(error)}); each needs this release of flexarm and the files"
        raise InvalidParameter(what, where="workers")


def _dask() -> Any:
    """Return the package that distributes.

    Raise InvalidParameter if it is not installed.
    """
    try:
        return import_module("distributed")
    except ImportError:
        what = 'needs Dask: pip install "flexarm[campaign]"; with one job the runs are made in this process'
        raise InvalidParameter(what, where="campaign") from None


def page_of(client: Client) -> str:
    """Return the address of Dask's page, or nothing where the scheduler has none."""

    def draws() -> bool:
        from importlib.util import find_spec

        return find_spec("bokeh") is not None

    drawn = client.run_on_scheduler(draws)
    return str(client.dashboard_link) if drawn else ""


def _ahead(client: Client) -> int:
    """Return the number of tasks to be under way; workers may join and leave."""
    ahead = 2  # tasks under way for each thread of a worker: one that it computes, one that waits there
    threads = int(sum(client.nthreads().values()))
    return max(ahead, ahead * threads)


_jobs: dict[str, Job] = {}
"""Jobs that this process has been sent."""


def _computed_there(name: str, task: Task) -> list[Row]:
    """Compute a task on a worker."""
    return computed(_jobs[name], task)


@contextmanager
def _sent(client: Client, job: Job) -> Iterator[str]:
    """Send a job to all workers, those that join later too, and take it back at the end."""
    content = pickle.dumps(job)
    name = f"flexarm-{sha256(content).hexdigest()[:16]}"

    class Sent(_dask().WorkerPlugin):  # type: ignore[misc]
        """The job; pickled by value, so it needs nothing but flexarm on the worker."""

        def __init__(self) -> None:
            self.name, self.content = name, content

        def setup(self, worker: Any) -> None:
            from flexarm.campaigns.engine import take

            take(self.name, self.content)

        def teardown(self, worker: Any) -> None:
            from flexarm.campaigns.engine import leave

            leave(self.name)

    client.register_plugin(Sent(), name=name)
    try:
        yield name
    finally:
        client.unregister_worker_plugin(name)


def take(name: str, content: bytes) -> None:
    """Keep a job that was sent to this worker."""
    _jobs[name] = pickle.loads(content)


def leave(name: str) -> None:
    """Forget a job."""
    _jobs.pop(name, None)


@contextmanager
def client_of(scheduler: str | None, jobs: int | None, room: Path) -> Iterator[Client]:
    """Yield a client of a scheduler at an address, or of a cluster of worker processes on this machine.

    `jobs` is their number, by default one a core, and `room` a directory for files that these need.

    Raise InvalidParameter if Dask is not installed, or the scheduler cannot be reached.
    """
    dask = _dask()
    if scheduler is None:
        cluster = _local(jobs, room)
        client = dask.Client(cluster)
        try:
            yield client
        finally:
            for each in (client, cluster):
                with suppress(Exception):  # a worker that is being started again cannot be stopped
                    each.close()
        return
    try:
        client = dask.Client(scheduler, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError) as error:
        what = f"cannot be reached: {scheduler!r}: {' '.join(str(error).split())}"
        raise InvalidParameter(
            f"{what}; allowed is an address such as tcp://10.0.0.1:8786", where="scheduler"
        ) from None
    with client:
        yield client


CONNECT_SECONDS = 10
"""Time in which a scheduler must answer [s]."""


def _local(jobs: int | None, room: Path) -> Any:
    """Return a cluster of processes of one thread each that only this machine reaches.

    Its workers keep memory that the next runs need, which Dask's give back. They take no samples of stacks,
    and no loop looks 50 times a second how late it is.
    """
    settings = {
        "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": None,
        "distributed.worker.profile.enabled": False,
        "distributed.admin.tick.interval": "1s",
        "distributed.admin.system-monitor.interval": "10s",
    }
    with _quiet_tracker(), import_module("dask").config.set(settings):
        return _dask().LocalCluster(
            n_workers=jobs or os.cpu_count() or 1,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            local_directory=str(room),
            silence_logs=50,
        )


@contextmanager
def _quiet_tracker() -> Iterator[None]:
    """Keep the process that tidies up after a client silent about what it removes once that is gone.

    `multiprocessing` starts it with the first worker, and it takes its filters from the environment.
    """
    name = "PYTHONWARNINGS"
    before = os.environ.get(name)
    quiet = "ignore::UserWarning:multiprocessing.resource_tracker"
    os.environ[name] = ",".join(filter(None, (before, quiet)))
    try:
        yield
    finally:
        if before is None:
            del os.environ[name]
        else:
            os.environ[name] = before
