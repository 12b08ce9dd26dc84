"""A diagnosis that was saved is the same when it is loaded: in words, numbers and pictures."""

import json
from math import nan

import diagnoses
import matplotlib as mpl
import numpy as np
import pytest

import flexarm
from flexarm.cli.run import run
from flexarm.effects import SensorOffset
from flexarm.errors import InvalidFile
from flexarm.fit_statistics import ChannelStatistics, FitStatistics
from flexarm.named_effects import Refined
from flexarm.report.diagnosis import drawings

mpl.use("Agg")
MADE = {**diagnoses.ALL, "poses": diagnoses.of_poses}
NOT_KEPT = {"states", "rotations"}
"""Pictures of the gap against states of the joints."""


@pytest.fixture(scope="module", params=sorted(MADE))
def pair(request, tmp_path_factory):
    """A diagnosis, and the same from its files."""
    made = MADE[request.param]()
    directory = tmp_path_factory.mktemp("saved") / "out"
    made.save(directory)
    return made, flexarm.Diagnosis.load(directory), directory


def test_it_says_the_same(pair):
    made, loaded, _ = pair
    assert loaded.summary() == made.summary()
    assert loaded.to_json_dict() == made.to_json_dict()


def test_the_file_of_its_gaps_stands_for_a_diagnosis(tmp_path):
    made = diagnoses.adequate()
    made.save(tmp_path / "out")
    assert flexarm.load(tmp_path / "out" / "gaps.nc").summary() == made.summary()
    assert run(["view", str(tmp_path / "out" / "gaps.nc"), "--out", str(tmp_path / "page.html")]) == 0


def test_it_holds_the_same_models_values_and_gaps(pair):
    made, loaded, _ = pair
    assert (loaded.arm, loaded.updated) == (made.arm, made.updated)
    for name in ("verdict", "effects", "nuisances", "refined", "rejected", "stages", "remarks"):
        assert getattr(loaded, name) == getattr(made, name)
    for side in ("before", "after"):
        ours, theirs = getattr(made, side), getattr(loaded, side)
        assert list(ours) == list(theirs)
        for record, comparison in ours.items():
            again = theirs[record]
            assert again.notes == comparison.notes
            assert again.to_json_dict()["alignment"] == comparison.to_json_dict()["alignment"]
            assert list(again.evidence) == list(comparison.evidence)
            for name, gap in comparison.evidence.items():
                assert again.signals[name].to_json_dict() == gap.to_json_dict()
                for direction, part in gap.parts.items():
                    np.testing.assert_array_equal(again.signals[name].parts[direction], part)


def test_statistics_that_nobody_knows_are_read_again(tmp_path):
    channel = ChannelStatistics("slow", "tip", 0, 3, nan, None, nan, None)
    diagnoses.of_effects(statistics=FitStatistics(channels=(channel,))).save(tmp_path / "out")
    (again,) = flexarm.Diagnosis.load(tmp_path / "out").statistics.channels
    assert np.isnan([again.chi_square, again.discrepancy]).all() and again.length is None


def test_a_zero_that_only_the_updated_model_has_is_read_again(tmp_path):
    """A diagnosis fits zeros of sensors; the nominal model has no effect for them."""
    updated = diagnoses.with_spring().with_effect(SensorOffset(at="tip", offset=(1e-4, 0.0, 0.0)))
    zero = Refined("effects.sensor_offset.tip.offset.x", 1e-4, 2e-7, 0.0, "m")
    diagnoses.of_effects(updated=updated, refined=(zero,)).save(tmp_path / "out")
    assert flexarm.Diagnosis.load(tmp_path / "out").refined == (zero,)


def test_its_pictures_are_the_same_but_those_against_states(pair):
    made, loaded, _ = pair
    ours, again = ({each.name: each.png for each in drawings(d)} for d in (made, loaded))
    effects = {name for name in ours if name not in again or ours[name] != again[name]}
    named = {file.removesuffix(".png") for effect in made.effects for file in made.figures_of(effect)}
    assert effects <= NOT_KEPT | named  # an effect's picture has states where these are known
    assert set(ours) - NOT_KEPT == set(again)


def test_its_gap_is_drawn_like_that_of_the_diagnosis(pair):
    made, loaded, _ = pair
    if not made.has_gap:
        pytest.skip("nothing was compared")
    for ours, again in zip(made.plot().lines, loaded.plot().lines, strict=True):
        np.testing.assert_array_equal(ours.get_xydata(), again.get_xydata())


def test_it_can_be_given_by_its_report_and_saved_again(pair, tmp_path):
    made, _, directory = pair
    flexarm.Diagnosis.load(directory / "report.json").save(tmp_path / "again")
    told, again = (json.loads((d / "report.json").read_text()) for d in (directory, tmp_path / "again"))
    assert again == told
    assert flexarm.Diagnosis.load(tmp_path / "again").summary() == made.summary()


def test_what_is_no_diagnosis_is_refused_by_name(tmp_path):
    with pytest.raises(InvalidFile, match=r"report\.json: file: there is no such file"):
        flexarm.Diagnosis.load(tmp_path)
    (tmp_path / "report.json").write_text("{}")
    with pytest.raises(InvalidFile, match="is no report of a diagnosis"):
        flexarm.Diagnosis.load(tmp_path)
    (tmp_path / "report.json").write_text("no JSON")
    with pytest.raises(InvalidFile, match="is no report of a diagnosis"):
        flexarm.Diagnosis.load(tmp_path / "report.json")


def test_gaps_that_are_missing_are_refused_by_name(tmp_path):
    diagnoses.unusable().save(tmp_path / "out")
    (tmp_path / "out" / "gaps.nc").unlink()
    with pytest.raises(InvalidFile, match=r"gaps\.nc: file: there is no such file"):
        flexarm.Diagnosis.load(tmp_path / "out")
