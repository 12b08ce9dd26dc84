"""The comment above the repaired model: where it comes from, what was changed; the model is still read."""

import diagnoses
import pytest

import flexarm
from flexarm.named_effects import Refined
from flexarm.report.diagnosis import write_updated


def head(diagnosis, path):
    """The comment as one line, and the model below it."""
    write_updated(diagnosis, path)
    lines = path.read_text(encoding="utf-8").splitlines()
    told = [line.removeprefix("# ").strip() for line in lines if line.startswith("#")]
    return " ".join(told), flexarm.Arm.from_toml(path)


def test_comments_of_the_nominal_model_are_kept_below_the_head(tmp_path):
    diagnosis, model, path = diagnoses.of_effects(), tmp_path / "arm.toml", tmp_path / "updated.toml"
    diagnosis.arm.to_toml(model)
    model.write_text("# Arm of the second hall.\n" + model.read_text())
    write_updated(diagnosis, path, model)
    text = path.read_text()
    assert 0 < text.index("Made by flexarm diagnose") < text.index("# Arm of the second hall.")
    assert flexarm.Arm.from_toml(path) == diagnosis.updated


def test_what_was_added_is_told_with_its_interval(tmp_path):
    told, model = head(diagnoses.of_effects(), tmp_path / "updated.toml")
    assert model == diagnoses.with_spring()
    assert "Made by flexarm diagnose 1.0, seed 0: verdict effects" in told
    assert "the records slow and fast tried on the record other, which no fit has seen" in told
    assert "joint compliance at hinge, probability 0.93" in told
    assert "stiffness = 140000 N m/rad, 137697 to 142303" in told  # 1 %, 1.645 sigma
    assert "which the data cannot tell from link stiffness at rod" in told
    # 2.08e11 +- 1.645e9
    assert "youngs_modulus: 2.1e+11 -> 2.08e+11, 2.06355e+11 to 2.09645e+11 Pa" in told


def test_a_value_that_went_back_is_told_as_it_was(tmp_path):
    left = Refined("points.tip.position.y", 0.0, 5e-4, 0.0, "m")
    told, _ = head(diagnoses.of_effects(refined=(left,)), tmp_path / "updated.toml")
    assert "since the data do not determine them: points.tip.position.y" in told
    assert "refined within" not in told


def test_a_model_that_was_not_touched_says_so(tmp_path):
    told, model = head(diagnoses.unusable(), tmp_path / "updated.toml")
    assert model == diagnoses.nominal()
    assert "and the record slow nothing" in told
    assert told.endswith("nothing is changed: this is the nominal model")


@pytest.mark.parametrize("kind", diagnoses.ALL)
def test_the_same_diagnosis_gives_the_same_file(kind, tmp_path):
    for name in ("one.toml", "two.toml"):
        write_updated(diagnoses.ALL[kind](), tmp_path / name)
    assert (tmp_path / "one.toml").read_bytes() == (tmp_path / "two.toml").read_bytes()
