"""Run a study: compute the samples that are not there yet, keep each batch, put all together at the end."""

from __future__ import annotations

import json
import os
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.arguments import AXES, FLAG, JOBS, PATH, TEXT, takes
from flexarm.arm import Arm
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
from flexarm.pictures import Shown
from flexarm.reading import check_hdf5, reading
from flexarm.report.campaign import page
from flexarm.termination import told_on_exit

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

STUDY, SUMMARY = "study.json", "summary.html"
FORMAT = "flexarm-campaign/1"
TASK_SECONDS, FOR_EACH_WORKER = 2.0, 0.02
"""Time that a task should take at least, and for each worker [s]: the engine needs 5 to 10 ms for one."""

Tell = Callable[[float, str], object]


@dataclass(frozen=True)
class Campaign(Shown):
    """A campaign that is done.

    Attributes
    ----------
    directory : Path
        Where its files lie.
    record : dict
        What `study.json` holds: what ran, versions, hashes, failures.
    """

    directory: Path
    record: dict[str, Any]

    def __repr__(self) -> str:
        return f"<Campaign in {str(self.directory)!r}: {self.summary().splitlines()[0]}>"

    @property
    def dataset(self) -> xr.Dataset:
        """Return the results, which stay in their file until they are asked for."""
        import xarray as xr

        path = self.directory / RESULTS
        check_hdf5(path)
        with reading(path, "NetCDF"):
            return xr.open_dataset(path, engine="h5netcdf")

    @classmethod
    @takes(directory=PATH)
    def load(cls, directory: str | Path) -> Campaign:
        """Return the campaign in a directory.

        Raises
        ------
        InvalidFile
            If there is none, or it is not finished.
        """
        folder = Path(directory)
        record = _read_record(folder / STUDY)
        if not (folder / RESULTS).is_file():
            what = "is not there: the campaign is not finished; --resume goes on"
            raise InvalidFile(folder, "results.nc", what)
        if record.get("state") != "finished":
            raise InvalidFile(folder / STUDY, "state", "must be 'finished'; --resume goes on")
        found = cls(folder, record)
        with reading(folder / STUDY, "what a campaign wrote"):
            found.summary()  # of the counts in the record
        return found

    @property
    def files(self) -> tuple[str, ...]:
        """Names of its files."""
        return tuple(name for name in (STUDY, RESULTS, SUMMARY) if (self.directory / name).is_file())

    @takes(name=TEXT, ax=AXES)
    def plot(self, name: str | None = None, ax: Axes | None = None) -> Axes:
        """Draw how a result spreads over the runs that did not fail.

        A number is drawn as a histogram, a series as its median and the band that holds 90 % of the runs.

        Parameters
        ----------
        name : str, optional
            A variable of `dataset`; default: the first that was asked for.
        ax : matplotlib Axes, optional
            Where to draw.

        Raises
        ------
        InvalidParameter
            If there is no such result.
        """
        from flexarm.campaigns.picture import draw

        with self.dataset as data:
            return draw(data, name, ax)

    def summary(self) -> str:
        """Return what ran, in lines."""
        runs, counts = self.record["runs"], self.record["reasons"]
        lines = [
            f"{runs['ok'] + runs['failed']} runs, {runs['ok']} ok, {runs['failed']} failed: "
            f"{self.record['run_seconds']:.1f} s of computing"
        ]
        lines += [f"  {count} x {reason}" for reason, count in list(counts.items())[:5]]
        return "\n".join(lines)


@takes(study=PATH, out=PATH, resume=FLAG, force=FLAG, scheduler=TEXT, n_jobs=JOBS)
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
    NotConverged
        If the nominal run fails; a variant that fails is a row of the results.

    Examples
    --------
    >>> found = flexarm.campaign("tolerances.toml", "tolerances")  # doctest: +SKIP
    >>> found.dataset["tip_position_max"]  # doctest: +SKIP
    """
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
        session = _begun(plan, store, resume, force, say)
        done = set(range(plan.count)) if store.results.is_file() else store.done()
        refuse_gaps(store.parts, plan.count, done)
        tally = _Tally(plan.count, len(done), progress or (lambda done, what: None))
        with _resumable(store, tally):
            if not store.results.is_file():
                _compute(plan, store, done, tally, scheduler, n_jobs, say)
            return _finished(plan, store, session)


@dataclass
class _Session:
    """What study.json tells of a campaign, as it goes."""

    record: dict[str, Any]

    def write(self, store: Store) -> None:
        text = json.dumps(self.record, indent=2, allow_nan=False)
        store.write(store.directory / STUDY, f"{text}\n".encode())


def _begun(plan: Plan, store: Store, resume: bool, force: bool, say: Callable[[str], object]) -> _Session:
    """Return the session of a new campaign, or of one that goes on."""
    file = store.directory / STUDY
    versions = config()
    if resume and file.is_file():
        record = _read_record(file)
        refuse_other(plan, file, record)
        if record["versions"] != versions:
            say(f"{file}: begun with flexarm {record['versions']['git']}, goes on with {versions['git']}")
        record["sessions"].append({"started": _now(), "versions": versions})
        session = _Session(record)
    elif resume and (store.parts.exists() or store.results.exists()):
        raise InvalidFile(file, "file", "there is no such file, but results are; --force begins anew")
    else:
        if force:  # what a former campaign left
            store.clear()
            for name in (RESULTS, STUDY, SUMMARY):
                (store.directory / name).unlink(missing_ok=True)
        session = _Session(
            {
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
        )
    session.write(store)
    return session


def _compute(
    plan: Plan,
    store: Store,
    done: set[int],
    tally: _Tally,
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
    each = seconds_of_a_run(plan.job.runner, plan.arm, spent / len(nominal)) if nominal else TASK_SECONDS

    def put(rows: Sequence[Row]) -> None:
        store.put(rows)
        tally.add(len(rows))

    if not pending:
        pass
    elif scheduler is None and _here(jobs, each * len(pending)):
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


def _here(jobs: int | None, seconds: float) -> bool:
    """Return True if this process should compute alone: one job, or less work than a start of workers."""
    start_seconds = 5.0  # work for which no workers are started [s]
    return (jobs or os.cpu_count() or 1) == 1 or (jobs is None and seconds < start_seconds)


def task_size(seconds: float, row_bytes: int, workers: int) -> int:
    """Return the greatest number of runs in a task, given the time [s] and the size of one."""
    task_bytes, task_runs = 2**25, 10_000  # what a task may return at most: bytes of rows, and rows
    enough = int(max(TASK_SECONDS, FOR_EACH_WORKER * workers) / max(seconds, 1e-6))
    return max(1, min(enough, task_bytes // row_bytes, task_runs))


@dataclass
class _Tally:
    """How many runs are done, their rate, and the time left."""

    count: int
    before: int
    tell: Tell
    added: int = 0
    began: float = field(default_factory=time.monotonic)

    @property
    def done(self) -> int:
        return self.before + self.added

    def add(self, more: int) -> None:
        self.added += more
        rate = self.added / max(time.monotonic() - self.began, 1e-9)
        left = (self.count - self.done) / rate
        self.tell(self.done / self.count, f"{self.done}/{self.count} runs, {rate:.3g}/s, {_clock(left)} left")


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


@contextmanager
def _resumable(store: Store, tally: _Tally) -> Iterator[None]:
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


def _finished(plan: Plan, store: Store, session: _Session) -> Campaign:
    """Write down what ran, and remove the batches."""
    most_failures = 1000  # failures that study.json lists; it counts all
    campaign_ = Campaign(store.directory, session.record)
    with campaign_.dataset as data:
        status, reasons = data["status"].values, data["reason"].values
        seconds = float(data["seconds"].sum())
    failed = [int(i) for i in (status == "failed").nonzero()[0]]
    keys, rows = plan.variation.keys, len(plan.values)
    session.record |= {
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
    store.write(store.directory / SUMMARY, page(findings, session.record).encode())
    session.write(store)
    store.clear()
    return campaign_


def _read_record(file: Path) -> dict[str, Any]:
    if not file.is_file():
        raise InvalidFile(file, "file", "there is no such file; a campaign leaves it")
    with reading(file, "what a campaign wrote"):
        found = json.loads(file.read_text(encoding="utf-8"))
    if not isinstance(found, dict) or found.get("format") != FORMAT:
        raise InvalidFile(file, "format", f"must be {FORMAT!r}")
    return found


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
