"""A campaign gives what each of its runs gives alone, keeps all of it, and goes on where it stopped."""

import json

import numpy as np
import pytest
from campaign_runs import MASS, SIMULATED, STATIC, study_in

import flexarm
from flexarm import InvalidFile
from flexarm.arm.parameter import with_value
from flexarm.campaigns import run_study
from flexarm.campaigns.plan import cut
from flexarm.campaigns.run_study import seconds_of_a_run, task_size
from flexarm.campaigns.store import Store
from flexarm.effects.backlash import Backlash


@pytest.fixture
def simulated(tmp_path):
    return study_in(tmp_path)


def entries(folder):
    """Names in a directory."""
    return sorted(each.name for each in folder.iterdir())


def test_a_row_is_what_its_run_gives_alone(simulated, tmp_path):
    data = flexarm.campaign(simulated, tmp_path / "out", n_jobs=1).dataset
    arm = flexarm.Arm.from_toml(tmp_path / "arm.toml")
    drive = flexarm.Drive.from_csv(tmp_path / "swing.csv", arm)
    nominal = flexarm.simulate(arm, drive, step=5e-3)
    for k in (0, 7, 15):
        row = data.isel(sample=k)
        gap = Backlash(at="hinge", gap=float(row["effects.backlash.hinge.gap"]))
        variant = with_value(arm, MASS, float(row[MASS])).with_effect(gap)
        run = flexarm.simulate(variant, drive, step=5e-3)
        assert row["tip_position"].values == pytest.approx(run.at(row["time"], "tip"), abs=1e-11)
        off = np.linalg.norm(run.position[:, 0] - nominal.position[:, 0], axis=1)
        assert float(row["tip_position_max"]) == pytest.approx(off.max(), rel=1e-9)
        assert float(row["tip_position_rms"]) == pytest.approx(np.sqrt(np.mean(off**2)), rel=1e-9)
        assert float(row["tip_position_final"]) == pytest.approx(off[-1], rel=1e-9)
    rest = nominal.at(data["time"], "tip")
    assert data["tip_position_nominal"].values == pytest.approx(rest, abs=1e-12)


def test_results_say_what_they_are(simulated, tmp_path):
    data = flexarm.campaign(simulated, tmp_path / "out", n_jobs=1).dataset
    assert data.sizes == {"sample": 16, "time": 11, "axis": 3}
    assert set(data["status"].values) == {"ok"}
    assert {MASS, "effects.backlash.hinge.gap"} <= set(data["tip_position"].coords)
    assert data["tip_position"].attrs["units"] == "m"
    assert data[MASS].attrs == {"units": "kg", "nominal": 2.0}


def test_results_are_drawn_over_the_runs(simulated, tmp_path):
    found = flexarm.campaign(simulated, tmp_path / "out", n_jobs=1)
    axes = found.plot("tip_position_max")
    assert axes.get_xlabel() == "tip_position_max [m]"
    assert sum(bar.get_height() for bar in axes.patches) == 16
    bands = found.plot("tip_position")
    assert (bands.get_xlabel(), bands.get_ylabel()) == ("time [s]", "tip_position [m]")
    median = np.median(found.dataset["tip_position"].sel(axis="x").values, axis=0)
    assert bands.lines[0].get_ydata() == pytest.approx(median)
    with pytest.raises(flexarm.InvalidParameter, match="tip_position_rms"):
        found.plot("hub")


def test_the_directory_holds_nothing_else_and_tells_what_ran(simulated, tmp_path):
    done = flexarm.campaign(simulated, tmp_path / "out", n_jobs=1)
    assert entries(tmp_path / "out") == sorted(done.files)
    record = json.loads((tmp_path / "out" / "study.json").read_text())
    assert record["state"] == "finished"
    assert record["runs"] == {"ok": 16, "failed": 0}
    assert set(record["inputs_sha256"]) == {"arm.toml", "swing.csv"}
    assert record["versions"]["flexarm"] == flexarm.__version__
    assert flexarm.Campaign.load(tmp_path / "out").record == record
    assert repr(done).endswith(f": 16 runs, 16 ok, 0 failed: {record['run_seconds']:.1f} s of computing>")


def test_a_record_that_lacks_its_counts_is_refused(tmp_path):
    file = flexarm.campaign(study_in(tmp_path, STATIC), tmp_path / "out", n_jobs=1).directory / "study.json"
    whole = file.read_text()
    for old, told in (("run_seconds", "cannot be read as what"), ("finished", "state: must be 'finished'")):
        file.write_text(whole.replace(f'"{old}"', '"else"', 1))
        with pytest.raises(InvalidFile, match=told):
            flexarm.Campaign.load(tmp_path / "out")


def test_a_variant_that_fails_is_a_row_with_its_reason(tmp_path):
    """Masses from -1 to 3 kg: those below zero are refused, the others are computed."""
    file = study_in(tmp_path, STATIC.replace("low = 1.0", "low = -1.0"))
    done = flexarm.campaign(file, tmp_path / "out", n_jobs=1)
    data = done.dataset
    negative = data[MASS].values < 0
    assert 0 < negative.sum() < 50
    assert np.array_equal(data["status"].values == "failed", negative)
    assert np.array_equal(np.isnan(data["tip_displacement"].values).all(axis=1), negative)
    reason = str(data["reason"].values[negative][0])
    assert reason.startswith(f"{MASS}: must be at least 0, got -0.")
    assert done.record["runs"]["failed"] == negative.sum() == len(done.record["failures"])
    assert done.record["failures"][0]["parameters"][MASS] < 0


def test_modes_of_variants_are_kept_whole(tmp_path):
    text = (
        STATIC[: STATIC.index("[[keep]]")]
        .replace('"static"', '"modes"')
        .replace("joints", "count = 3\njoints")
    )
    data = flexarm.campaign(study_in(tmp_path, text), tmp_path / "out", n_jobs=1).dataset
    heaviest = int(np.argmax(data[MASS].values))
    arm = with_value(flexarm.Arm.from_toml(tmp_path / "arm.toml"), MASS, float(data[MASS][heaviest]))
    alone = flexarm.modes(arm, joints={"hinge": 0.5}, count=3)
    assert np.array_equal(data["frequency_hz"][heaviest], alone.frequency_hz)
    assert data["frequency_hz"].dims == ("sample", "mode")


def stopped_after(parts: int, monkeypatch):
    """Let a campaign stop, as if interrupted, once so many batches were kept."""
    put, kept = Store.put, []

    def counted(self, rows):
        if len(kept) == parts:
            raise KeyboardInterrupt
        kept.append(rows)
        put(self, rows)

    monkeypatch.setattr(Store, "put", counted)


def test_what_is_done_is_not_computed_again(simulated, tmp_path, monkeypatch):
    whole = flexarm.campaign(simulated, tmp_path / "whole", n_jobs=1).dataset
    monkeypatch.setattr(run_study, "task_size", lambda *of: 2)
    with monkeypatch.context() as patched:
        stopped_after(3, patched)
        with pytest.raises(KeyboardInterrupt):
            flexarm.campaign(simulated, tmp_path / "out", n_jobs=1)
    assert entries(tmp_path / "out") == ["results.parts", "study.json"]
    computed = []
    compute = run_study.compute_here
    monkeypatch.setattr(
        run_study,
        "compute_here",
        lambda job, tasks, put: compute(
            job, tasks, lambda rows: (computed.extend(r.sample for r in rows), put(rows))
        ),
    )
    data = flexarm.campaign(simulated, tmp_path / "out", resume=True, n_jobs=1).dataset
    assert computed == list(range(6, 16))  # tasks of two, three of which were kept
    assert data.drop_vars("seconds").equals(whole.drop_vars("seconds"))


def test_tasks_are_cut_smaller_towards_the_end():
    tasks = list(cut(100, 12, 2))
    assert [end for _, end in tasks[:-1]] == [begin for begin, _ in tasks[1:]]
    assert (tasks[0][0], tasks[-1][1]) == (0, 100)
    sizes = [end - begin for begin, end in tasks]
    assert sizes == sorted(sizes, reverse=True)
    assert (sizes[0], sizes[-4:]) == (12, [1] * 4)


def test_a_task_takes_longer_where_there_are_many_workers():
    assert [task_size(0.01, 8, workers) for workers in (2, 100, 1000)] == [200, 200, 2000]
    assert task_size(100.0, 8, 2) == 1
    assert task_size(1e-3, 2**20, 2) == 32  # what it returns is bounded


def test_the_time_of_a_run_is_not_that_of_the_first_one():
    """The nominal run loads what all need, and others go several at a time."""

    class Quick:
        at_once = 4

        def outcomes(self, arms, cases):
            return [{} for _, _ in zip(arms, cases, strict=True)]

    assert seconds_of_a_run(Quick(), None, 1.9) < 0.05
    assert seconds_of_a_run(Quick(), None, 10.0) == 10.0


def test_another_study_does_not_go_on_with_this_one(simulated, tmp_path):
    flexarm.campaign(simulated, tmp_path / "out", n_jobs=1)
    simulated.write_text(SIMULATED.replace("n = 16", "n = 32"))
    with pytest.raises(
        InvalidFile, match=r"study.json: study.sampling: was .*\"n\": 16.*is .*\"n\": 32.* now; allowed"
    ):
        flexarm.campaign(simulated, tmp_path / "out", resume=True)
    simulated.write_text(SIMULATED)
    (tmp_path / "arm.toml").write_text((tmp_path / "arm.toml").read_text() + "\n# changed\n")
    with pytest.raises(InvalidFile, match=r"study.json: inputs_sha256.arm.toml: the file has changed"):
        flexarm.campaign(simulated, tmp_path / "out", resume=True)


def test_a_directory_with_files_needs_resume_or_force(simulated, tmp_path):
    flexarm.campaign(simulated, tmp_path / "out", n_jobs=1)
    with pytest.raises(InvalidFile, match="holds a campaign already; allowed is --resume"):
        flexarm.campaign(simulated, tmp_path / "out")
    (tmp_path / "out" / "notes.txt").write_text("mine")
    before = (tmp_path / "out" / "results.nc").stat().st_mtime_ns
    again = flexarm.campaign(simulated, tmp_path / "out", force=True, n_jobs=1)
    assert (tmp_path / "out" / "results.nc").stat().st_mtime_ns > before
    assert entries(tmp_path / "out") == sorted([*again.files, "notes.txt"])


def test_going_on_and_beginning_anew_exclude_each_other(simulated, tmp_path):
    with pytest.raises(flexarm.InvalidParameter, match="only one of resume and force"):
        flexarm.campaign(simulated, tmp_path / "out", resume=True, force=True, n_jobs=1)
    assert not (tmp_path / "out").exists()


def test_a_study_at_fault_leaves_no_directory(simulated, tmp_path):
    simulated.write_text(SIMULATED.replace("n = 16", "n = -1"))
    with pytest.raises(InvalidFile, match=r"sampling\.n"):
        flexarm.campaign(simulated, tmp_path / "new" / "out")
    assert not (tmp_path / "new").exists()


def test_several_drives_are_cases_of_their_own(tmp_path):
    file = study_in(tmp_path, SIMULATED.replace('"swing.csv"', '["swing.csv", "short.csv"]'))
    lines = (tmp_path / "swing.csv").read_text().splitlines()
    (tmp_path / "short.csv").write_text("\n".join([*lines[:7], ""]))
    data = flexarm.campaign(file, tmp_path / "out", n_jobs=1).dataset
    assert data.sizes["sample"] == 32
    assert data["drive"].values.tolist() == ["swing.csv"] * 16 + ["short.csv"] * 16
    series = data["tip_position"].values
    assert np.isfinite(series[:16]).all()
    assert np.isfinite(series[16:, :6]).all()
    assert np.isnan(series[16:, 6:]).all()


def test_no_more_workers_are_started_than_there_are_runs(simulated, tmp_path, monkeypatch):
    def asked(scheduler, jobs, room):
        raise RuntimeError(f"{jobs} workers")

    monkeypatch.setattr(run_study, "client_of", asked)
    with pytest.raises(RuntimeError, match="16 workers"):
        flexarm.campaign(simulated, tmp_path / "out", n_jobs=10**6)
