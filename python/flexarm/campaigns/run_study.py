"""Run a study: compute the samples that are not there yet, keep each batch, put all together at the end."""

from __future__ import annotations

import json
import os
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from flexarm.arguments import FLAG, PATH, TEXT, takes
from flexarm.arm import Arm
from flexarm.campaigns.campaign import FORMAT, STUDY, SUMMARY, Campaign, read_record
from flexarm.campaigns.cases import label_names
from flexarm.campaigns.engine import client_of, compute_here, compute_with, page_of
from flexarm.campaigns.findings import findings_of
from flexarm.campaigns.job import Row
from flexarm.campaigns.outcome import Outcome, Runner
from flexarm.campaigns.plan import Plan, planned, refuse_other
from flexarm.campaigns.results import write_results
from flexarm.campaigns.store import RESULTS, Store, refuse_gaps
from flexarm.configuration import config
from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.output import growing_directory, writing
from flexarm.reading import reading
from flexarm.report.campaign import page, sentences, spreads
from flexarm.termination import told_on_exit


@takes(study=PATH, resume=FLAG, scheduler=TEXT)
def campaign(
    study: str | Path,
    out: str | Path,
    *,
    resume: bool = False,
    force: bool = False,
    scheduler: str | None = None,
    n_jobs: int | None = None,
    progress: Tell | None = None,
    notice: Callable[[str], object] | None = None,
) -> Campaign:
    """Run a study and keep its results.

    Parameters
    ----------
    study : str or Path
        The study, a TOML file; files that it names are found from where it lies.
    out : str or Path
        A new or empty directory: study.json, results.nc and summary.html. While runs are under way
        `results.parts` in it holds what is done.
    resume : bool
        Go on with the campaign that was begun there; what is done is not computed again.
    force : bool
        Begin anew in a directory that holds files; those of a former campaign are removed.
    scheduler : str, optional
        Address of a Dask scheduler; default: a cluster of this machine's cores, for this campaign only.
    n_jobs : int, optional
        Number of worker processes of that cluster; default one a core. One: runs are made in this process,
        and Dask is not needed.
    progress : callable, optional
        Gets the share done, and how many runs are done, their rate and the time left.
    notice : callable, optional
        Gets sentences that the user should know, such as the address of Dask's page.

    Raises
    ------
    InvalidFile
        If the study or a file that it names is at fault, the directory holds other files, or holds a campaign
        of another study.
    InvalidParameter
        If both `resume` and `force` are set, or both `scheduler` and `n_jobs`.
    NotConverged
        If the nominal run fails; a variant that fails is a row of the results.

    Examples
    --------
    >>> found = flexarm.campaign("tolerances.toml", "tolerances")  # doctest: +SKIP
    >>> found.dataset["tip_position_max"]  # doctest: +SKIP
    """
    if resume and force:
        raise InvalidParameter("go on, or begin anew: only one of resume and force", where="resume")
    if scheduler is not None and n_jobs is not None:
        raise InvalidParameter("is of the local cluster; a scheduler has its own workers", where="n_jobs")
    plan, folder = planned(Path(study)), Path(out)
    say = notice or (lambda text: None)
    for remark in plan.remarks:
        say(f"{plan.file}: {remark}")
    names = (STUDY, RESULTS, SUMMARY)
    if not (resume or force) and (folder / STUDY).is_file():
        what = (
            "holds a campaign already; allowed is --resume to go on, --force to begin anew, or another place"
        )
        raise InvalidFile(folder, "output", what)
    with growing_directory(folder, resume or force, [plan.file, *plan.inputs.values()], names) as partial_:
        store = Store(folder, partial_)
        record = _begun(plan, store, resume, force, say)
        done = set(range(plan.count)) if store.results.is_file() else store.done()
        refuse_gaps(store.parts, plan.count, done)
        tally = Tally(plan.count, len(done), progress or (lambda done, what: None))
        with resumable(store, tally):
            if not store.results.is_file():
                _compute(plan, store, done, tally, scheduler, n_jobs, say)
            return _finished(plan, store, record)


def _write_study(store: Store, record: Mapping[str, Any]) -> None:
    """Write what study.json tells of a campaign, as it goes."""
    text = json.dumps(record, indent=2, allow_nan=False)
    store.write(store.directory / STUDY, f"{text}\n".encode())


def _begun(
    plan: Plan, store: Store, resume: bool, force: bool, say: Callable[[str], object]
) -> dict[str, Any]:
    """Return what study.json tells of a new campaign, or of one that goes on."""
    file = store.directory / STUDY
    versions = config()
    if resume and file.is_file():
        record = read_record(file)
        refuse_other(plan, file, record)
        if record["versions"] != versions:
            say(f"{file}: begun with flexarm {record['versions']['git']}, goes on with {versions['git']}")
        record["sessions"].append({"started": _now(), "versions": versions})
    elif resume and (store.parts.exists() or store.results.exists()):
        raise InvalidFile(file, "file", "there is no such file, but results are; --force begins anew")
    else:
        if force:  # what a former campaign left
            store.clear()
            for name in (RESULTS, STUDY, SUMMARY):
                (store.directory / name).unlink(missing_ok=True)
        record = {
            "format": FORMAT,
            "state": "running",
            "file": str(plan.file),
            **plan.fingerprint(),
            "samples": plan.count,
            "parameters": [
                {"key": each.key, "unit": each.unit, "nominal": plan.variation.nominal(each)}
                for each in plan.variation.parameters
            ],
            "versions": versions,
            "sessions": [{"started": _now(), "versions": versions}],
        }
    _write_study(store, record)
    return record


def _compute(
    plan: Plan,
    store: Store,
    done: set[int],
    tally: Tally,
    scheduler: str | None,
    jobs: int | None,
    say: Callable[[str], object],
) -> None:
    """Compute what is not done yet, and put the results together."""
    pending = [sample for sample in range(plan.count) if sample not in done]
    began = time.perf_counter()
    with reading(plan.file.parent / plan.study.model, "a model", "model"):
        nominal = plan.job.runner.nominal(plan.arm)
    spent = time.perf_counter() - began
    if pending:
        each = 60.0  # of a diagnosis, which has no nominal run [s]: two are worth two workers
        if nominal:
            each = seconds_of_a_run(plan.job.runner, plan.arm, spent / len(nominal))

        def put(rows: Sequence[Row]) -> None:
            store.put(rows)
            tally.add(len(rows))

        if scheduler is None and alone(jobs, each * len(pending)):
            compute_here(plan.job, plan.tasks(pending, task_size(each, plan.row_bytes, 1), 1), put)
        else:
            wanted = min(jobs or os.cpu_count() or 1, len(pending))
            with client_of(scheduler, wanted, store.room) as client:
                if address := page_of(client):
                    say(f"Dask's page: {address}")
                workers = max(1, sum(client.nthreads().values()))
                size = task_size(each, plan.row_bytes, workers)
                compute_with(client, plan.job, plan.tasks(pending, size, workers), put)
    _write(plan, store, nominal)


def _write(plan: Plan, store: Store, nominal: list[Outcome]) -> None:
    """Put all batches together."""
    attributes = {
        "format": FORMAT,
        "run": plan.study.run,
        "cases": len(plan.cases),
        "study": plan.file.name,
        "study_sha256": plan.fingerprint()["study_sha256"],
        "flexarm_version": config()["flexarm"],
        "git": config()["git"],
        "created": _now(),
    }
    path = store.directory / RESULTS
    partial_ = store.room / RESULTS
    with writing(path):
        write_results(store, partial_, plan.job.runner.variables, plan.coordinates(), nominal, attributes)
        partial_.replace(path)


def _finished(plan: Plan, store: Store, record: dict[str, Any]) -> Campaign:
    """Write down what ran, and remove the batches."""
    most_failures = 1000  # failures that study.json lists; it counts all
    campaign_ = Campaign(store.directory, record)
    with campaign_.dataset as data:
        status, reasons = data["status"].values, data["reason"].values
        seconds = float(data["seconds"].sum())
    failed = [int(i) for i in (status == "failed").nonzero()[0]]
    keys, rows = plan.variation.keys, len(plan.values)
    record |= {
        "state": "finished",
        "finished": _now(),
        "run_seconds": seconds,
        "runs": {"ok": int((status == "ok").sum()), "failed": len(failed)},
        "reasons": dict(Counter(str(reasons[i]) for i in failed).most_common(20)),
        "failures": [
            {
                "sample": i,
                "reason": str(reasons[i]),
                "parameters": dict(zip(keys, map(float, plan.values[i % rows]), strict=True)),
                **dict(plan.cases[i // rows].labels),
            }
            for i in failed[:most_failures]
        ],
    }
    seed = plan.study.sampling.seed if plan.study.sampling else 0
    with campaign_.dataset as data:
        findings = findings_of(data, plan.variation.keys, label_names(plan.cases), seed)
    store.write(store.directory / SUMMARY, page(findings, record).encode())
    record["findings"] = [*sentences(findings), *spreads(findings)]
    _write_study(store, record)
    store.clear()
    return campaign_


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")


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


Tell = Callable[[float, str], object]


@dataclass
class Tally:
    """How many runs are done, their rate, and the time left."""

    count: int
    before: int
    tell: Tell
    added: int = 0
    began: float = field(default_factory=time.monotonic)

    @property
    def done(self) -> int:
        """Number of runs that are done."""
        return self.before + self.added

    def add(self, more: int) -> None:
        """Count more runs as done, and tell."""
        self.added += more
        rate = self.added / max(time.monotonic() - self.began, 1e-9)
        left = (self.count - self.done) / rate
        self.tell(self.done / self.count, f"{self.done}/{self.count} runs, {rate:.3g}/s, {_clock(left)} left")


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


@contextmanager
def resumable(store: Store, tally: Tally) -> Iterator[None]:
    """Say what is kept, if the process leaves within the block or cannot write a file."""

    def kept() -> str:
        return f"{tally.done} of {tally.count} runs are kept in {store.directory}; --resume goes on"

    with told_on_exit(kept):
        try:
            yield
        except InvalidFile as error:
            if error.where != "output":
                raise
            raise InvalidFile(error.file, "output", f"{error.problems[0].what}; {kept()}") from None
