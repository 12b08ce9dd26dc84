"""Claims about a diagnosis as text, numbers and files; the diagnoses are made by hand around real gaps."""

import json
from math import inf, nan

import diagnoses
import numpy as np
import pytest
from pytest import approx

import flexarm
from flexarm.named_effects import Estimate, NamedEffect, Rejected
from flexarm.report.report_file import ReportFile

VERDICTS = sorted(diagnoses.ALL)
GAP = {"before_rms", "after_rms", "noise_rms", "before_max", "after_max"}
PARAMETER = {"name", "value", "std", "low90", "high90", "unit"}


def strict(text: str) -> dict:
    """JSON without what JSON has not: NaN and Infinity."""

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is no JSON")

    return json.loads(text, parse_constant=refuse)


# ------------------------------------------------------------------------ report.json


@pytest.mark.parametrize("verdict", VERDICTS)
def test_report_has_the_keys_that_programs_rely_on(verdict):
    told = diagnoses.ALL[verdict]().to_json_dict()
    agreed = {"format", "verdict", "effects", "nuisances", "where", "refined", "gap", "next_experiment"}
    assert set(told) == agreed | {"provenance", "details"}
    assert (told["format"], told["verdict"]) == ("flexarm-diagnosis/1", verdict)
    assert set(told["gap"]) == {"signal", "unit", "train", "held_out"}
    assert set(told["gap"]["train"]) == set(told["gap"]["held_out"]) == GAP
    provenance = {"version", "git", "inputs_sha256", "seed", "seconds", "rejected", "step"}
    assert set(told["provenance"]) == provenance


def test_entries_of_a_report_have_the_agreed_keys():
    told = diagnoses.of_effects().to_json_dict()
    [effect] = told["effects"]
    named = {"name", "at", "probability", "parameters", "alternatives", "evidence", "figures"}
    assert set(effect) == named
    assert all(set(each) == PARAMETER for each in effect["parameters"])
    assert [set(each) for each in effect["alternatives"]] == [{"name", "at", "probability"}]
    assert all(set(each) == {"name", "at", "parameters", "undetermined"} for each in told["nuisances"])
    [cell] = told["where"]
    assert set(cell) == {"signal", "direction", "when", "band_hz", "rms", "noise_rms"}
    assert [set(each) for each in told["refined"]] == [{"parameter", "value", "std", "nominal"}]


@pytest.mark.parametrize("verdict", VERDICTS)
def test_report_survives_a_file(verdict):
    told = diagnoses.ALL[verdict]().to_json_dict()
    again = strict(json.dumps(told, allow_nan=False))
    assert again == told
    assert ReportFile.model_validate(again).model_dump(mode="json", exclude_unset=True) == told


def test_a_value_that_nobody_knows_is_null():
    unknown = Estimate("stiffness", 1e5, inf, nan, inf, "N m/rad")
    effect = NamedEffect("joint_compliance", "hinge", 1.0, (unknown,))
    told = diagnoses.of_effects(
        effects=(effect,), rejected=(Rejected("backlash", "hinge", -inf, "does not fit"),)
    ).to_json_dict()
    [parameter] = told["effects"][0]["parameters"]
    assert [parameter[key] for key in ("value", "std", "low90", "high90")] == [1e5, None, None, None]
    assert told["provenance"]["rejected"][0]["log_bayes_factor"] is None


def test_numbers_of_numpy_become_plain():
    [entry] = diagnoses.of_effects().constancy
    moved = {
        **entry,
        "values": {"slow": np.array([1.0, 0.1])},
        "constant": np.bool_(False),
        "q": np.float64(9),
    }
    told = diagnoses.of_effects(constancy=(moved,)).to_json_dict()
    assert told["details"]["constancy"][0]["values"] == {"slow": [1.0, 0.1]}
    assert told["details"]["constancy"][0]["constant"] is False


def test_a_probability_above_one_is_refused():
    effect = NamedEffect("joint_compliance", "hinge", 1.2)
    with pytest.raises(ValueError, match="probability"):
        diagnoses.of_effects(effects=(effect,)).to_json_dict()


# ---------------------------------------------------------------------------- the gap


def test_gap_of_two_records_is_that_of_all_their_samples():
    d = diagnoses.of_effects()
    for side, told in ((d.before, d.gap(d.training).before_rms), (d.after, d.gap(d.training).after_rms)):
        gaps = [side[name].signals["tip"] for name in d.training]
        samples = [np.stack([part for part in g.parts.values() if part is not None], axis=1) for g in gaps]
        squares = np.sum(np.concatenate(samples) ** 2, axis=1)
        assert told == approx(np.sqrt(squares.mean()), rel=1e-9)


def test_greatest_gap_is_that_of_all_records():
    d = diagnoses.of_effects()
    greatest = [d.before[name].signals["tip"].max["total"] for name in d.training]
    assert d.gap(d.training).before_max == max(greatest)


def test_nothing_is_known_of_a_gap_that_no_record_shows():
    d = diagnoses.of_effects(held_out=())
    assert set(d.to_json_dict()["gap"]["held_out"].values()) == {None}
    assert set(diagnoses.unusable().to_json_dict()["gap"]["train"].values()) == {None}


def test_reported_gap_is_what_compare_finds_with_the_written_model(tmp_path):
    diagnoses.lean().save(tmp_path / "out")
    told = strict((tmp_path / "out" / "report.json").read_text())["gap"]["train"]
    written = flexarm.Arm.from_toml(tmp_path / "out" / "updated.toml")
    after = flexarm.compare(written, diagnoses.record(3, 0.2), step=0.01)
    assert told["after_rms"] == approx(after.signals["tip"].rms["total"], rel=1e-9)


# ------------------------------------------------------------------------------- text


def test_summary_names_effect_rival_interval_gap_and_what_is_next():
    text = diagnoses.of_effects().summary()
    assert "Missing from the model: joint compliance at hinge (probability 0.93)" in text
    assert "cannot tell from link stiffness at rod" in " ".join(text.split())
    assert "140.0 kN m/rad     90 % interval 137.7 to 142.3" in text
    assert "shrinks from 7.92 mm to 0.067" in " ".join(text.split())
    assert "measure next: A second payload" in text


def test_summary_fits_a_terminal():
    for make in diagnoses.ALL.values():
        assert max(map(len, repr(make()).splitlines())) <= 100


@pytest.mark.parametrize(
    ("verdict", "sentence"),
    [
        ("adequate", "No effect is missing as far as these data tell"),
        ("unexplained", "What remains oscillates at 0.7 Hz with 2.1 mm rms"),
        ("unusable", "The sensor is at fault, not the physics: sign error at signal tip."),
    ],
)
def test_every_verdict_is_a_sentence(verdict, sentence):
    assert sentence in " ".join(diagnoses.ALL[verdict]().summary().split())


def test_a_gap_that_stays_is_not_said_to_shrink():
    assert "shrinks" not in diagnoses.adequate().summary()


# ------------------------------------------------------------------------------ files


@pytest.mark.parametrize("verdict", ["effects", "unusable"])
def test_save_writes_report_page_model_and_every_figure_it_names(verdict, tmp_path):
    d = diagnoses.lean() if verdict == "effects" else diagnoses.unusable()
    d.save(tmp_path / "out")
    there = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"report.json", "report.html", "updated.toml"} <= there
    told = strict((tmp_path / "out" / "report.json").read_text())
    named = {name for effect in told["effects"] for name in effect["figures"]}
    assert named <= there
    assert bool(named) == (verdict == "effects")
    assert flexarm.Arm.from_toml(tmp_path / "out" / "updated.toml") == d.updated


def test_save_twice_gives_the_same_bytes(tmp_path):
    for name in ("a", "b"):
        diagnoses.lean().save(tmp_path / name)
    for file in (tmp_path / "a").iterdir():
        assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes(), file.name


def test_nothing_is_written_when_the_page_fails(tmp_path):
    broken = diagnoses.lean(where=({"signal": "tip"},))
    with pytest.raises(KeyError):
        broken.save(tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_save_does_not_overwrite_unasked(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(flexarm.InvalidFile, match="holds files already"):
        diagnoses.unusable().save(tmp_path)
    diagnoses.unusable().save(tmp_path, force=True)
    assert (tmp_path / "mine.txt").read_text() == "mine"


def test_names_of_records_become_names_of_files(tmp_path):
    before, after = diagnoses.comparisons()
    strange = "../day 1:other"
    d = diagnoses.lean(
        before={strange: before["other"]}, after={strange: after["other"]}, training=(strange,)
    )
    d.save(tmp_path / "out")
    assert (tmp_path / "out" / "gap-day-1-other.png").is_file()
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


# ------------------------------------------------------------------------------- plot


def test_plot_shows_before_and_after_with_units():
    ax = diagnoses.of_effects().plot()
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("time [s]", "tip, tangential [mm]")
    nominal, updated = ax.get_lines()
    before, after = diagnoses.comparisons()
    assert nominal.get_ydata() == approx(1e3 * before["other"].signals["tip"].parts["tangential"])
    assert updated.get_ydata() == approx(1e3 * after["other"].signals["tip"].parts["tangential"])


def test_plot_of_an_unknown_record_tells_which_there_are():
    with pytest.raises(flexarm.InvalidParameter, match="slow, fast"):
        diagnoses.of_effects().plot(record="slwo")
