"""A gap that was aligned to a few readings says so, in a comparison and in a diagnosis."""

import json

import numpy as np
import pytest
from tests.helpers.example_scripts import EXAMPLES
from tests.helpers.posed import changed, posed, poses

import flexarm
from flexarm.cli.run import run
from flexarm.comparison.align import EffectiveParameters
from flexarm.effects import JointCompliance
from flexarm.record import Frame


def arm() -> flexarm.Arm:
    """The spatial arm of the examples, rigid in its joints."""
    return flexarm.Arm.from_toml(EXAMPLES / "three_joints.toml").replace(effects=())


SOFT = arm().with_effect(JointCompliance(at="shoulder", stiffness=1e5))


def seen(count: int, frame: Frame, seed: int = 2) -> flexarm.Record:
    """Poses of the arm with a soft shoulder."""
    return posed(SOFT, poses(3, count, seed), seed, ("x", "y", "z"), frame)


def place(record: flexarm.Record) -> EffectiveParameters:
    [found] = flexarm.compare(arm(), record).aligned.effective_parameters
    return found


@pytest.mark.parametrize("frame", [Frame(unknown=True), Frame(translation=0.1, rotation=0.1)], ids=str)
@pytest.mark.parametrize(("count", "values"), [(1, 3), (2, 5), (3, 6), (12, 6)])
def test_free_values_are_as_many_as_the_readings_determine(frame, count, values):
    """A point has three coordinates, two have one distance that no frame changes, three are six values."""
    found = place(seen(count, frame))
    assert found.count == pytest.approx(values, abs=1e-3)
    assert (found.name, found.readings, found.signals) == ("tracker", 3 * count, ("tip",))


def test_a_registration_that_is_known_takes_nothing():
    """A hundredth of the noise: 4 sigma^2 N/noise^2 of four readings' worth is 4e-4 each."""
    found = place(seen(4, Frame(translation=5e-7)))
    assert found.count == pytest.approx(3 * 4e-4, rel=0.01)
    assert not found.overfitted


def test_readings_without_a_value_do_not_count():
    record = seen(6, Frame(unknown=True))
    values = record.signals["tip"].values.copy()
    values[2] = np.nan
    assert place(changed(record, "tip", values)).readings == 15


def test_noise_that_is_left_is_what_the_sentence_says():
    """Six values, aligned to nine readings of noise, leave sqrt(1/3) of it: rms over 200 sets."""
    frame = Frame(unknown=True)
    left = [
        flexarm.compare(SOFT, posed(SOFT, poses(3, 3, 5), k, ("x", "y", "z"), frame)).signals["tip"]
        for k in range(200)
    ]
    rms = np.sqrt(np.mean([gap.rms["total"] ** 2 for gap in left])) / left[0].noise_rms
    assert rms == pytest.approx(np.sqrt(1 / 3), rel=0.05)
    assert (
        "9 readings of tip are few for the 6 values of tracker that were aligned to them: of noise 58 %"
        in str(place(seen(3, frame)))
    )


@pytest.mark.parametrize(("count", "said"), [(2, True), (5, True), (6, False), (12, False)])
def test_a_comparison_notes_it(count, said, tmp_path, capsys):
    arm().to_toml(tmp_path / "arm.toml")
    seen(count, Frame(unknown=True)).save(tmp_path / "yard")
    assert run(["compare", str(tmp_path / "arm.toml"), str(tmp_path / "yard"), "--json"]) == 0
    notes = json.loads(capsys.readouterr().out)["notes"]
    assert any(f"{3 * count} readings of tip are few" in note for note in notes) == said
    assert run(["compare", str(tmp_path / "arm.toml"), str(tmp_path / "yard"), "--raw"]) == 0
    assert "are few" not in capsys.readouterr().out


def test_a_diagnosis_says_that_poses_held_back_are_aligned_to_themselves():
    """Two of ten are held back, six readings for five values; eight are fitted, 24 for six."""
    record = seen(10, Frame(unknown=True))
    found = flexarm.diagnose(arm(), {"yard": record}, n_jobs=1)
    said = [remark for remark in found.remarks if "are few" in remark]
    assert [
        remark.startswith("yard, held-back blocks: 6 readings of tip are few for the 5 values")
        for remark in said
    ] == [True]
