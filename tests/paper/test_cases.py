"""Every record of every development case beside its model, before any repair."""

import json

import numpy as np
import pytest

from flexarm import Arm, Record, compare
from flexarm.arm import effect_class

RECORDS = ("train_a", "train_b", "held_out")


@pytest.fixture(scope="module", params=range(1, 19), ids=lambda number: f"case_{number:02d}")
def case(shared_dir, request):
    """Comparisons of a case by record, and the verdict that its answer states."""
    name = f"case_{request.param:02d}"
    folder = shared_dir / "cases" / name
    arm = Arm.from_toml(folder / "model.toml")
    found = {record: compare(arm, Record.load(folder / record)) for record in RECORDS}
    return found, json.loads((shared_dir / "cases/answers" / f"{name}.json").read_text())["verdict"]


def test_every_record_is_compared_whole_and_driven_without_its_noise(case):
    """What smoothing takes from an encoder is its stated noise, no motion and (but for a fifth) no less."""
    for found in case[0].values():
        assert found.skipped == {}
        assert found.evidence
        for gap in found.evidence.values():
            assert np.isfinite(gap.rms["total"])
            assert gap.rms["total"] > 0.9 * gap.noise_rms
        for gap in found.signals.values():
            if gap.is_drive:
                assert 0.8 < gap.rms["total"] / gap.noise_rms < 1.05


def test_only_a_record_that_contradicts_itself_is_off_by_a_thousand_times_its_noise(case):
    """Of effects, the largest leaves some 110 times the noise; a tip of the wrong sign leaves 19 000."""
    comparisons, verdict = case
    for found in comparisons.values():
        worst = max(gap.rms["total"] / gap.noise_rms for gap in found.evidence.values())
        assert (worst > 1000) == (verdict == "unusable")
        assert any("moved further" in note and "rotation" in note for note in found.notes) == (worst > 1000)


@pytest.mark.parametrize("number", [3, 4, 5, 6, 12, 17])
def test_with_the_true_effect_of_a_drive_train_the_gap_is_the_independent_simulators(shared_dir, number):
    """Backlash, hysteresis, stiffening, transmission error; backlash with compliance; one joint of two.

    Effects as the answer has them, everything else nominal: the tip of the held-out record is then off by
    `floor_nominal`, that of another simulator's equations, within 1 %.
    """
    folder, name = shared_dir / "cases", f"case_{number:02d}"
    answer = json.loads((folder / "answers" / f"{name}.json").read_text())
    arm = Arm.from_toml(folder / name / "model.toml")
    for effect in answer["effects"]:
        values = {parameter["name"]: parameter["value"] for parameter in effect["parameters"]}
        arm = arm.with_effect(effect_class(effect["name"])(at=effect["at"], **values))
    rms = compare(arm, Record.load(folder / name / "held_out"), bands=[]).signals["tip"].rms
    assert rms["total"] == pytest.approx(answer["held_out"]["floor_nominal"]["total"], rel=0.01)
    assert rms["total"] != pytest.approx(answer["held_out"]["before"]["total"], rel=0.2)
