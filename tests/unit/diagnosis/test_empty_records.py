"""Records of which nothing can be compared, in whole or in part, and such as are too short to be parted."""

import numpy as np
import pytest
from arms import compliance, crane
from diagnoses import lean

import flexarm
from flexarm import Record, Signal
from flexarm.comparison.aligned_record import simulate_record
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.naming import transient_remarks
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.problem import Problem
from flexarm.errors import InvalidParameter
from flexarm.report.sentences import hold_out_sentence
from flexarm.validation.sensor_check import check, clean_records

NOISE = 5e-5


def poses(count: int, seed: int = 0) -> Record:
    """The tip of an arm with a soft hinge, in as many poses."""
    soft = crane(effects=[compliance("hinge", 5e4)])
    of_all = {"pose": np.array([f"p{k}" for k in range(count)])}
    angle = Signal(
        name="hinge", quantity="joint_angle", joint="hinge", values=np.linspace(-1.0, 1.2, count), **of_all
    )
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        axes=("x", "z"),
        values=np.zeros((count, 2)),
        noise_std=NOISE,
        **of_all,
    )
    record = Record(kind="static", drive=("hinge",), signals=[angle, tip])
    pair = simulate_record(soft, record, align=False)
    seen = pair.simulated.predicted(tip, pair.aligned.placement)
    return shown(record, seen + NOISE * np.random.default_rng(seed).standard_normal(seen.shape))


def shown(record: Record, values: np.ndarray, **changes: object) -> Record:
    """The record with other readings of its tip."""
    tip = record.signals["tip"].replace(values=values, **changes)
    return record.replace(signals={**record.signals, "tip": tip})


def without_axes(record: Record, *lost: int) -> Record:
    """The record with axes of its tip that hold no value."""
    values = record.signals["tip"].values.copy()
    values[:, lost] = np.nan
    return shown(record, values)


def test_a_record_without_a_value_is_left_out_and_told():
    found = flexarm.diagnose(crane(), {"one": poses(8), "none": without_axes(poses(8), 0, 1)}, n_jobs=1)
    assert [(effect.name, effect.at) for effect in found.effects] == [("joint_compliance", "hinge")]
    assert (found.training, found.held_out) == (("one",), ("one, held-back blocks",))
    assert any(
        remark.startswith("none holds nothing to compare with a simulation")
        and remark.endswith("a diagnosis leaves it out")
        for remark in found.remarks
    )


def test_if_no_record_holds_a_value_that_is_an_error():
    with pytest.raises(InvalidParameter, match="records: hold nothing to compare with a simulation"):
        flexarm.diagnose(crane(), {"none": without_axes(poses(8), 0, 1)}, n_jobs=1)
    with pytest.raises(InvalidParameter, match="other day: signals: holds nothing to compare"):
        clean_records(crane(), {"other day": without_axes(poses(8), 0, 1)})


def test_of_four_poses_none_is_held_back():
    """The fifth would be: the repair is then told by its gap in the training."""
    found = flexarm.diagnose(crane(), {"few": poses(4)}, n_jobs=1)
    assert [(effect.name, effect.at) for effect in found.effects] == [("joint_compliance", "hinge")]
    assert (found.training, found.held_out) == (("few",), ())
    assert "few is too short to hold a part of it back" in found.remarks
    assert found.to_json_dict()["gap"]["held_out"]["before_rms"] is None


def test_where_nothing_was_held_back_that_is_said():
    assert hold_out_sentence(lean()) == "Fitted on 'other'; nothing was held back."


def test_an_axis_without_a_value_leaves_the_other_one():
    """A row counts if all its channels hold a value: with the empty one none would."""
    found = check(crane(), {"half": without_axes(poses(8), 1)})
    tip = found.records["half"].signals["tip"]
    assert (tip.axes, tip.values.shape) == (("x",), (8, 1))
    assert found.compared == {"half": ("tip",)}
    assert found.remarks == ("half: tip holds no value along z; the rest of it is compared",)


def test_a_record_of_which_no_row_is_evidence_swings_with_nothing():
    """As where its noise is not known; what is left of it is a record without residuals."""
    problem = Problem(crane(), {"one": poses(8), "other": poses(6, seed=1)})
    problem.rows = tuple(rows for rows in problem.rows if rows.record == "one")
    fit = Estimator.nominal(problem, nuisance_model(problem)).fit(())
    assert list(transient_remarks(fit, problem)) == []


def test_a_signal_that_no_model_predicts_is_told_once_by_a_diagnosis_and_its_report():
    volts = Signal(
        name="volts",
        quantity="motor_voltage",
        joint="hinge",
        values=np.ones(8),
        noise_std=0.1,
        pose=np.array([f"p{k}" for k in range(8)]),
    )
    measured = poses(8)
    measured = measured.replace(signals={**measured.signals, "volts": volts})
    found = flexarm.diagnose(crane(), {"one": measured}, n_jobs=1)
    for told in (found.remarks, found.to_json_dict()["details"]["remarks"]):
        assert [remark for remark in told if "volts" in remark] == [
            "one: volts is not compared: (motor_voltage) needs motor voltage, which this simulation does not "
            "hold"
        ]


def test_what_is_doubted_in_a_model_is_told_by_its_diagnosis():
    """A tip that may be 30 m off: 1 sigma in mm was meant."""
    found = flexarm.diagnose(crane(uncertainty={"points.tip.position_m": 30.0}), {"one": poses(8)}, n_jobs=1)
    [told] = [remark for remark in found.remarks if remark.startswith("model: ")]
    assert "uncertainty.points.tip.position_m: is 30 m (1 sigma), further than the arm reaches" in told


def test_a_comparison_without_an_axis_says_which_one_and_what_to_do():
    record = without_axes(poses(8), 1)
    with pytest.raises(InvalidParameter, match="z holds none; leave it out of axes and channels"):
        flexarm.compare(crane(), record)
    assert "holds no value along z in 8 rows" in [problem.what for problem in record.check()]


def test_no_sensor_is_judged_where_nothing_is_compared():
    found = check(crane(), {"none": without_axes(poses(8), 0, 1)})
    assert found.usable and not found.judged
    assert found.summary().startswith("1 record checked: no sensor can be judged: nothing is compared")


def test_a_drive_without_a_value_is_told_without_a_warning_of_numpy(recwarn):
    time = np.arange(0, 2, 0.01)
    hinge = Signal(name="hinge", quantity="joint_angle", joint="hinge", time=time, values=np.nan * time)
    tip = Signal(name="tip", quantity="position", point="tip", time=time, values=np.ones((len(time), 3)))
    [doubt] = check(crane(), {"run": Record(signals=[hinge, tip], drive=("hinge",))}).doubts
    assert "drop-outs leave no value of it" in doubt
    assert not recwarn.list
