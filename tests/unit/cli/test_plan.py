"""The command `flexarm plan`: what it prints, writes and refuses. The numbers: test_planning.py."""

import json

import diagnoses
import numpy as np
import pytest
from arms import TUBE, arm, beam, hinge, point

import flexarm
from flexarm.cli.run import run
from flexarm.diagnosis.design.plan_result import Plan, PlannedEffect
from flexarm.report.plan import near_effects


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """A model without sensors, a motion as a CSV file and one as a record."""
    directory = tmp_path_factory.mktemp("bench")
    arm(
        name="crane",
        gravity=[0, 0, -9.81],
        joints=[hinge("hinge", "rod", gear_ratio=120)],
        links=[beam("rod", [0, 0, 3.0], TUBE, elements=1, damping_ratio=0.02)],
        points=[point("tip", "rod", [0, 0, 3.0])],
    ).to_toml(directory / "arm.toml")
    t = np.linspace(0.0, 2.0, 21)
    angles = np.column_stack([t, np.sin(np.pi * t / 2) ** 2])
    np.savetxt(directory / "swing.csv", angles, delimiter=",", header="time_s,hinge", comments="")
    diagnoses.record(1).save(directory / "slow")
    return directory


def command(bench, *more, drive="swing.csv"):
    return ["plan", str(bench / "arm.toml"), "--drive", str(bench / drive), *more]


def test_the_page_the_file_and_the_figures_are_written(bench, tmp_path, capsys):
    out = tmp_path / "plan"
    assert run(command(bench, "--out", str(out))) == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert told.out.startswith("plan of crane: swing\n")
    assert (
        "assumed: a tracker of 'tip', the last of the model's points, with 50 µm of noise at 10 Hz"
        in told.out
    )
    assert "(SI)" not in told.out
    assert told.out.endswith(f"open {out / 'plan.html'}\n")
    assert {path.name for path in out.iterdir()} == {
        "plan.json",
        "plan.html",
        "matrix.png",
        "smallest-sizes.png",
    }
    html = (out / "plan.html").read_text()
    assert html.count("data:image/png;base64,") == 2
    assert "http" not in html  # nothing is fetched
    report = json.loads((out / "plan.json").read_text())
    assert report["format"] == "flexarm-plan/1"
    assert {"name": "joint_compliance", "at": "hinge"}.items() <= report["effects"][0].items()


def test_json_is_one_object_and_nothing_else_without_a_terminal(bench, capsys, monkeypatch):
    monkeypatch.setattr("flexarm.cli.progress.SECONDS", 0.0)
    assert run(command(bench, "--json")) == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert json.loads(told.out)["runs"] == ["swing"]


def test_several_motions_follow_one_drive_or_several(bench, tmp_path, monkeypatch, capsys):
    seen = []

    def plan(arm, motions, **options):
        seen.append(list(motions))
        raise flexarm.NotConverged("no equilibrium", time=0.0, iteration=1, residual=1.0)

    monkeypatch.setattr(flexarm, "plan", plan, raising=False)
    (tmp_path / "fast.csv").write_text((bench / "swing.csv").read_text())
    for words in (["slow", "fast"], ["--drive", "slow", "--drive", "fast"]):
        paths = {"slow": str(bench / "slow"), "fast": str(tmp_path / "fast.csv")}
        assert run(command(bench, *(paths.get(word, word) for word in words))) == 3
    assert seen == [["swing", "slow", "fast"]] * 2


# ---------------------------------------------------------------------------- refusals


def refused(arguments, capsys):
    code = run(arguments)
    told = capsys.readouterr()
    assert told.out == ""
    return code, told.err


def test_the_step_of_the_simulations_can_be_chosen(bench, monkeypatch, capsys):
    steps = []

    def plan(arm, motions, *, step, **options):
        steps.append(step)
        raise flexarm.NotConverged("no equilibrium", time=0.0, iteration=1, residual=1.0)

    monkeypatch.setattr(flexarm, "plan", plan, raising=False)
    assert run(command(bench, "--step", "0.001")) == 3
    capsys.readouterr()
    code, err = refused(command(bench, "--step", "0"), capsys)
    assert steps == [0.001] and code == 2 and "--step: must be positive" in err


def test_an_occupied_directory_is_refused(bench, tmp_path, capsys):
    (tmp_path / "mine.txt").write_text("mine")
    code, err = refused(command(bench, "--out", str(tmp_path)), capsys)
    assert code == 2
    assert "holds files already" in err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_a_drive_of_no_joint_is_named_with_its_column(bench, tmp_path, capsys):
    (tmp_path / "swing.csv").write_text("time_s,wrist\n0,0\n1,1\n")
    code, err = refused(command(bench, drive=tmp_path / "swing.csv"), capsys)
    assert code == 2
    assert err.startswith(f"error: {tmp_path / 'swing.csv'}: column wrist: is no moving joint")


def test_a_record_of_another_arm_is_named(bench, tmp_path, capsys):
    strange = tmp_path / "strange"
    diagnoses.record(1).save(strange)
    text = (strange / "record.toml").read_text()
    (strange / "record.toml").write_text(text.replace('point = "tip"', 'point = "nose"'))
    code, err = refused(command(bench, drive=strange), capsys)
    assert code == 2
    assert err.splitlines()[-1].startswith(f"error: {strange / 'record.toml'}: signals.tip.point: ")


def test_two_motions_of_one_name_are_refused(bench, capsys):
    code, err = refused(command(bench, "--drive", str(bench / "swing.csv")), capsys)
    assert code == 2
    assert "--drive: is called 'swing' as another one is" in err


def test_a_motion_must_be_given(bench, capsys):
    code, err = refused(["plan", str(bench / "arm.toml")], capsys)
    assert code == 2
    assert "--drive" in err


def test_help_tells_what_it_is_for(capsys):
    assert run(["plan", "--help"]) == 0
    told = capsys.readouterr().out
    assert "the day before a campaign" in told
    assert "flexarm plan arm.toml --drive swing.csv" in told


def test_the_matrix_shows_those_that_are_near_another():
    """Of four effects two are tied, one is told well from all, and one is not seen, nor taken for another."""
    effects = [
        PlannedEffect(name, "hinge", "x", "", 1.0, 0.0, 0.1, b)
        for name, b in zip("abcd", (50, 50, 50, 1), strict=True)
    ]
    factors = np.full((4, 4), 1e4)
    factors[0, 1] = factors[1, 0] = 0.5
    np.fill_diagonal(factors, 0.0)
    plan = Plan(None, ("run",), tuple(effects), factors, ((0, 1),), ())
    assert near_effects(plan) == [0, 1]
    factors[2, 0] = 28.0  # hardly told, yet a explains less than half of the 50 that speak for c
    assert near_effects(plan) == [0, 1]
    factors[2, 3] = 1.0  # c would be taken for d, which alone would not be seen
    assert near_effects(plan) == [0, 1, 2, 3]


def test_a_header_is_printed_again_on_every_page(bench, tmp_path):
    assert run(command(bench, "--out", str(tmp_path / "plan"))) == 0
    html = (tmp_path / "plan" / "plan.html").read_text()
    assert html.count("<thead>") == html.count("<table")
