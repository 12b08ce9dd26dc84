"""Workers and clients may die: nothing is lost, and nothing is computed twice but what was under way."""

import os
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from campaign_runs import SIMULATED, logged_job, study_in, tasks_of

import flexarm
from flexarm import InvalidFile, InvalidParameter
from flexarm.campaigns.engine import client_of, compute_here, compute_with
from flexarm.campaigns.store import Store

pytest.importorskip("distributed")
MASSES = [float(mass) for mass in np.linspace(1.0, 2.0, 60)]


def logged(file: Path) -> Counter:
    """How often each mass was run."""
    return Counter(float(line.split()[0]) for line in file.read_text().splitlines())


@pytest.fixture
def client(tmp_path):
    with client_of(None, 2, tmp_path / "room") as found:
        yield found


def test_two_workers_give_what_one_process_gives(client, tmp_path):
    rows = []
    compute_with(client, logged_job(tmp_path / "log", seconds=0.0), tasks_of(MASSES, 7), rows.extend)
    alone = []
    compute_here(logged_job(tmp_path / "alone", seconds=0.0), tasks_of(MASSES, 7), alone.extend)
    assert [(r.sample, r.outcome) for r in sorted(rows, key=lambda r: r.sample)] == [
        (r.sample, r.outcome) for r in alone
    ]
    assert set(logged(tmp_path / "log").values()) == {1}
    assert len({line.split()[1] for line in (tmp_path / "log").read_text().splitlines()}) == 2


def test_no_other_machine_reaches_the_cluster_of_a_campaign(client):
    psutil = pytest.importorskip("psutil")
    here = psutil.Process()
    found = [
        each.laddr.ip
        for process in (here, *here.children(recursive=True))
        for each in process.net_connections()
        if each.status == psutil.CONN_LISTEN
    ]
    assert len(found) > 4
    assert set(found) == {"127.0.0.1"}


def test_workers_keep_memory_that_the_next_runs_need(client):
    """Dask would have each give memory back to the system between runs, which costs a third of their time."""
    assert not any(client.run(lambda: "MALLOC_TRIM_THRESHOLD_" in os.environ).values())


def test_few_tasks_are_under_way_at_once(client, tmp_path):
    """Two for each of two workers, and one that is being put."""
    given, put, most = 0, 0, []

    def tasks():
        nonlocal given
        for task in tasks_of(MASSES, 2):
            given += 1
            yield task

    def count(rows):
        nonlocal put
        put += 1
        most.append(given - put)

    compute_with(client, logged_job(tmp_path / "log", seconds=0.005), tasks(), count)
    assert put == 30
    assert max(most) <= 5


def test_a_worker_that_is_killed_costs_its_tasks_alone(client, tmp_path):
    rows, killed = [], []

    def put(found):
        rows.extend(found)
        if len(rows) >= 20 and not killed:
            killed.append(int((tmp_path / "log").read_text().splitlines()[-1].split()[1]))
            os.kill(killed[0], signal.SIGKILL)

    compute_with(client, logged_job(tmp_path / "log", seconds=0.05), tasks_of(MASSES, 5), put)
    assert killed
    assert Counter(row.sample for row in rows) == Counter(range(60))
    assert all(row.outcome == {"twice": 2 * MASSES[row.sample]} for row in rows)
    again = [mass for mass, times in logged(tmp_path / "log").items() if times > 1]
    assert len(again) <= 5  # those of the task that was under way there


def test_a_run_under_which_workers_die_is_a_row_and_spares_the_others(client, tmp_path):
    client.cluster.scheduler.allowed_failures = 1
    rows = []
    job = logged_job(tmp_path / "log", seconds=0.0, deadly=1.99)  # the last mass alone
    compute_with(client, job, tasks_of(MASSES[-6:], 3), rows.extend)
    found = {row.sample: row for row in rows}
    assert sorted(found) == list(range(6))
    assert [found[k].outcome for k in range(5)] == [{"twice": 2 * mass} for mass in MASSES[-6:-1]]
    assert found[5].reason == "each worker that tried it died; it may need more memory than there is"


def test_a_scheduler_that_is_nowhere_is_told(tmp_path, monkeypatch):
    monkeypatch.setattr("flexarm.campaigns.engine.CONNECT_SECONDS", 0.5)
    with pytest.raises(InvalidParameter, match=r"scheduler: cannot be reached: 'tcp://127\.0\.0\.1:9'"):
        flexarm.campaign(study_in(tmp_path), tmp_path / "out", scheduler="tcp://127.0.0.1:9")


@pytest.mark.slow
def test_an_existing_scheduler_is_used_and_left_as_it_was(client, tmp_path):
    """By the command, which has no other client in its process."""
    study, address = study_in(tmp_path), client.scheduler.address
    code = "import sys; from flexarm.cli import main; main(sys.argv[1:])"
    command = ["campaign", str(study), "--out", str(tmp_path / "out"), "--scheduler", address]
    done = subprocess.run([sys.executable, "-c", code, *command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert all(" runs, " in line for line in done.stderr.splitlines()), "nothing but progress"
    assert done.stdout.startswith("16 runs, 16 ok, 0 failed")
    data = flexarm.Campaign.load(tmp_path / "out").dataset
    alone = flexarm.campaign(study, tmp_path / "alone", n_jobs=1).dataset
    assert data.drop_vars("seconds").equals(alone.drop_vars("seconds"))
    left = client.run(lambda: len(sys.modules["flexarm.campaigns.engine"]._jobs))
    assert set(left.values()) == {0}


LONG = SIMULATED.replace("n = 16", "n = 128")


def started(study: Path, out: Path, *more: str) -> subprocess.Popen:
    """A campaign on two workers in a session of its own, once it has kept a batch."""
    command = ["campaign", str(study), "--out", str(out), "--jobs", "2", *more]
    code = "import sys; from flexarm.cli import main; main(sys.argv[1:])"
    process = subprocess.Popen(
        [sys.executable, "-c", code, *command],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )
    until = time.monotonic() + 60
    while not list((out / "results.parts").glob("*.npz")):
        assert process.poll() is None, process.stderr.read()
        assert time.monotonic() < until
        time.sleep(0.02)
    return process


def went_on(study: Path, out: Path, tmp_path: Path) -> None:
    """Asserts that a campaign goes on with what is there, and ends as an undisturbed one."""
    parts = {each: each.stat().st_mtime_ns for each in Store(out, out).files()}
    assert parts
    kept = Store(out, out).done()
    computed = []
    put = Store.put

    def counted(self, rows):
        computed.extend(row.sample for row in rows)
        put(self, rows)

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(Store, "put", counted)
        patched.setattr(Store, "clear", lambda self: None)
        data = flexarm.campaign(study, out, resume=True, n_jobs=1).dataset
    assert Counter(computed) == Counter(set(range(128)) - kept)
    assert {each: each.stat().st_mtime_ns for each in parts} == parts
    whole = flexarm.campaign(study, tmp_path / "whole", n_jobs=1).dataset
    assert data.drop_vars("seconds").equals(whole.drop_vars("seconds"))


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="SIGKILL")
def test_a_client_that_is_killed_loses_nothing_that_was_kept(tmp_path):
    study, out = study_in(tmp_path, LONG), tmp_path / "out"
    process = started(study, out)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate()
    went_on(study, out, tmp_path)


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals to a group of processes")
def test_ctrl_c_leaves_a_state_that_goes_on(tmp_path):
    study, out = study_in(tmp_path, LONG), tmp_path / "out"
    process = started(study, out)
    os.killpg(process.pid, signal.SIGINT)
    *progress, told = process.communicate()[1].splitlines()
    assert process.returncode == 130
    assert all("/128 runs, " in line for line in progress)
    assert told.startswith("interrupted: ")
    assert told.endswith(f" of 128 runs are kept in {out}; --resume goes on")
    assert sorted(each.name for each in out.iterdir()) == ["results.parts", "study.json"]
    went_on(study, out, tmp_path)


def test_flexarm_and_its_campaigns_load_without_dask():
    code = "import sys, flexarm; flexarm.campaign; assert not {'dask', 'distributed'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_without_dask_one_job_still_works(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    study = study_in(tmp_path)
    assert flexarm.campaign(study, tmp_path / "one", n_jobs=1).record["runs"]["ok"] == 16
    with pytest.raises(InvalidParameter, match=r'needs Dask: pip install "flexarm\[campaign\]"'):
        flexarm.campaign(study, tmp_path / "two", n_jobs=2)
    with pytest.raises(InvalidFile, match="holds a campaign already"):
        flexarm.campaign(study, tmp_path / "one", n_jobs=2)
