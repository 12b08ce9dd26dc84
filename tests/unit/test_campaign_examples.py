"""The studies of the examples, and those that the documentation shows, can be run."""

import re
from pathlib import Path

from example_scripts import load_script

from flexarm import Arm
from flexarm.campaigns.plan import planned

ROOT = Path(__file__).parents[2]


def test_the_tolerances_are_a_study_of_the_papers_arm():
    plan = planned(ROOT / "examples" / "tolerances" / "tolerances.toml")
    assert plan.count == 1024
    assert plan.remarks == ()
    readme = (ROOT / "examples" / "tolerances" / "README.md").read_text(encoding="utf-8")
    assert len(re.findall(r"^\| (?!all|tolerance|-)", readme, flags=re.M)) == 6  # five costs and the header
    assert len(plan.variation.keys) == 9


def test_a_fleet_is_diagnosed_machine_by_machine_and_date_by_date(tmp_path):
    make_fleet = load_script("fleet", "make_fleet")
    make_fleet.make(tmp_path, 2, dates=make_fleet.DATES[:2])
    plan = planned(tmp_path / "fleet.toml")
    assert [tuple(case.labels.values()) for case in plan.cases] == [
        (machine, date) for machine in ("m01", "m02") for date in make_fleet.DATES[:2]
    ]
    rows = [line.split(",") for line in (tmp_path / "truth.csv").read_text().splitlines()[1:]]
    gaps = [float(row[2]) for row in rows]
    assert gaps[1] > gaps[0]
    assert gaps[3] > gaps[2]
    assert sum(name.endswith("record.toml") for name in plan.inputs) == 4 * 2


def test_the_study_of_the_documentation_can_be_run(tmp_path):
    text = (ROOT / "docs" / "campaigns.md").read_text(encoding="utf-8")
    study = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)[0]
    (tmp_path / "study.toml").write_text(study, encoding="utf-8")
    Arm.from_toml(ROOT / "examples" / "one_link.toml").to_toml(tmp_path / "arm.toml")
    (tmp_path / "swing.csv").write_text((ROOT / "examples" / "swing.csv").read_text())
    assert planned(tmp_path / "study.toml").count == 1024
