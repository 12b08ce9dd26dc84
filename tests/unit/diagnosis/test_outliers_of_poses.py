"""Gross outliers among poses are found, removed and said; a model that misses smoothly has none."""

import numpy as np
import pytest
from arms import compliance, crane
from planted import two_joints
from posed import NOISE, changed, moved, posed, poses, spoilt
from tests.helpers.example_scripts import EXAMPLES

import flexarm
from flexarm.comparison.aligned_record import simulate_record
from flexarm.comparison.pose_outliers import LEAST_POSES, pose_outliers
from flexarm.effects import Backlash, BaseTilt, JointCompliance, LinkBow, LinkStiffness
from flexarm.record import Frame
from flexarm.validation.sensor_check import check, clean_records

SOFT = two_joints().with_effect(JointCompliance(at="elbow", stiffness=1e5))


def three_joints() -> flexarm.Arm:
    """The spatial arm of the examples, rigid in its joints."""
    return flexarm.Arm.from_toml(EXAMPLES / "three_joints.toml").replace(effects=())


MISSING = {
    "soft elbow": (two_joints, JointCompliance(at="elbow", stiffness=2e4)),
    "soft forearm": (two_joints, LinkStiffness(at="fore", scale=0.4)),
    "tilted base": (two_joints, BaseTilt(at="base", angle=(0.0, 0.03))),
    "bowed forearm": (two_joints, LinkBow(at="fore", tip_offset=(0.03, 0.0, 0.0))),
    "very soft hinge": (crane, JointCompliance(at="hinge", stiffness=2e4)),
    "soft shoulder in space": (three_joints, JointCompliance(at="shoulder", stiffness=2e4)),
    "soft forearm in space": (three_joints, LinkStiffness(at="forearm", scale=0.5)),
}
"""Nominal model and what it lacks; it then misses by up to decimetres."""


def found(model: flexarm.Arm, record: flexarm.Record) -> dict[str, list[int]]:
    """Rows by signal."""
    pair = simulate_record(model, record, align=False)
    far = pose_outliers(pair.simulated, pair.aligned.placement)
    return {name: np.flatnonzero(each.rows).tolist() for name, each in far.items()}


@pytest.mark.parametrize("count", [LEAST_POSES, 8, 20])
@pytest.mark.parametrize("missing", MISSING)
def test_a_model_that_misses_smoothly_has_no_outliers(missing, count):
    """Four sets of poses in a wide range; in half of them the load weighs what it likes, from 0 to 20 kg."""
    nominal, effect = MISSING[missing][0](), MISSING[missing][1]
    machine = nominal.with_effect(effect)
    joints, axes = (
        len(nominal.moving_joints),
        ("x", "y", "z") if nominal.name == "three joints" else ("x", "z"),
    )
    for seed in range(4):
        loads = np.random.default_rng(seed).uniform(0, 20, count) if seed % 2 else None
        record = posed(machine, poses(joints, count, seed), seed, axes, loads=loads)
        assert found(nominal, record) == {}


@pytest.mark.parametrize("seed", range(4))
def test_the_flank_of_a_worn_reducer_is_no_outlier(seed):
    """Two of twelve poses lie on the other flank of a play of 5 mrad, 6 mm off, 120 times the noise."""
    worn = two_joints().with_effect(JointCompliance(at="elbow", stiffness=1e5))
    worn = worn.with_effect(Backlash(at="elbow", gap=5e-3))
    angles = np.abs(poses(2, 12, seed)) + 0.1
    angles[[3, 8]] *= -1
    assert found(two_joints(), posed(worn, angles, seed)) == {}


@pytest.mark.parametrize("seed", range(4))
def test_the_only_pose_with_a_load_is_no_outlier(seed):
    """Of a shoulder that gives way by up to a decimetre under it the other poses tell little."""
    machine = three_joints().with_effect(JointCompliance(at="shoulder", stiffness=2e4))
    loads = np.where(np.arange(10) == 4, 20.0, 0.0)
    assert found(three_joints(), posed(machine, poses(3, 10, seed), seed, ("x", "y", "z"), loads=loads)) == {}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("wrong", [{"factor": 10.0}, {"factor": 0.1}, {"by": 0.3}, {"by": -0.09}], ids=str)
@pytest.mark.parametrize("count", [8, 25])
def test_a_slipped_decimal_point_and_a_swapped_digit_are_found(count, wrong, seed):
    """Beside a soft elbow, in a row and along an axis at random where that changes more than a decimetre."""
    machine = two_joints().with_effect(JointCompliance(at="elbow", stiffness=3e4))
    record = posed(machine, poses(2, count, seed), seed)
    rows, axes = np.nonzero(np.abs(record.signals["tip"].values) > 0.12)
    k = int(np.random.default_rng(seed).integers(len(rows)))
    assert found(two_joints(), spoilt(record, rows[k], axes[k], **wrong)) == {"tip": [rows[k]]}


def test_several_outliers_do_not_hide_one_another():
    record = posed(SOFT, poses(2, 20, 6), 6)
    for row in (2, 9, 17):
        record = spoilt(record, row, 1, factor=10.0)
    assert found(two_joints(), record) == {"tip": [2, 9, 17]}


def test_many_poses_that_are_off_are_no_outliers():
    """Four of twenty poses stand elsewhere: that is what the signal shows."""
    record = posed(SOFT, poses(2, 20, 6), 6)
    for row in (2, 9, 13, 17):
        record = spoilt(record, row, 1, by=0.5)
    assert found(two_joints(), record) == {}


@pytest.mark.parametrize("by", [0.3, 10.0])
def test_an_outlier_does_not_carry_a_frame_away_of_which_nothing_is_stated(by):
    """A station somewhere near the arm is placed by the other poses."""
    machine = three_joints().with_effect(JointCompliance(at="shoulder", stiffness=1e5))
    record = posed(machine, poses(3, 12, 2), 2, ("x", "y", "z"), Frame(unknown=True))
    record = moved(record, (0.3, -0.2, 2.0), (4.0, -1.0, 0.5))
    assert found(three_joints(), record) == {}
    assert found(three_joints(), spoilt(record, 5, 1, by=by)) == {"tip": [5]}


SEEN = {
    "torque": {"quantity": "motor_torque", "joint": "elbow", "side": "output", "noise_std": 0.5},
    "encoder": {"quantity": "joint_angle", "joint": "elbow", "side": "output", "noise_std": 1e-5},
    "level": {"quantity": "inclination", "point": "tip", "axes": ("z",), "noise_std": 1e-4},
    "imu": {"quantity": "acceleration", "point": "tip", "axes": ("x", "z"), "noise_std": 1e-2},
    "gauge": {
        "quantity": "strain",
        "link": "upper_arm",
        "position": 0.3,
        "fibre": (0, 0.04),
        "noise_std": 1e-6,
    },
}
"""Other sensors of the arm in space."""


@pytest.mark.parametrize("seed", range(3))
def test_what_slipped_by_a_decimal_point_is_found_whatever_it_measures(seed):
    """The greatest reading of each sensor, tenfold; a soft shoulder alone leaves no outlier in any."""
    machine = three_joints().with_effect(JointCompliance(at="shoulder", stiffness=2e4))
    record = posed(machine, poses(3, 20, seed), seed, ("x", "y", "z"), seen=SEEN)
    assert found(three_joints(), record) == {}
    for name in SEEN:
        values = record.signals[name].values.copy()
        row = int(np.argmax(np.abs(values[:, 0])))
        values[row, 0] *= 10
        assert found(three_joints(), changed(record, name, values)) == {name: [row]}


@pytest.mark.parametrize("noise", [0.0, NOISE])
def test_a_channel_that_is_cut_off_has_no_outliers(noise):
    """Six of fifty poses stop at the end of the range of x, exactly or to the noise: that is a fault."""
    record = posed(SOFT, poses(2, 50, 1), 1)
    values = record.signals["tip"].values.copy()
    values[:, 0] = np.minimum(values[:, 0], np.sort(values[:, 0])[-7])
    values += noise * np.random.default_rng(1).standard_normal(values.shape)
    cut = changed(record, "tip", values)
    assert found(two_joints(), cut) == {}
    if noise == 0:
        [fault] = check(two_joints(), {"yard": cut}).faults
        assert (fault.name, fault.at, fault.channels) == ("saturation", "tip", ("x",))


def test_a_check_removes_them_and_says_pose_and_size():
    record = spoilt(posed(SOFT, poses(2, 20, 1), 1), 7, 0, by=1.5)
    seen = check(two_joints(), {"yard": record})
    assert seen.usable
    assert not seen.records["yard"].signals["tip"].valid[7]
    assert list(map(str, seen.outliers)) == ["1 outlier of tip in yard, row 7 (pose p7), 1.50 m off, removed"]
    held_out = clean_records(two_joints(), {"yard": record})
    assert held_out.outliers == seen.outliers


def test_rows_of_a_pose_do_not_scatter_by_what_was_removed():
    """A pose that was measured twice, once with a slipped decimal point, repeats."""
    once = posed(SOFT, poses(2, 10, 4), 4)
    tip = once.signals["tip"]
    twice = changed(once, "tip", np.tile(tip.values, (2, 1)), pose=np.tile(tip.pose, 2))
    seen = check(two_joints(), {"yard": spoilt(twice, 13, 1, factor=10.0)})
    assert [each.rows for each in seen.outliers] == [(13,)]
    assert seen.remarks == ()


def test_among_few_poses_none_is_looked_for_and_that_is_said():
    few = spoilt(posed(SOFT, poses(2, LEAST_POSES - 1, 1), 1), 2, 0, by=0.5)
    seen = check(two_joints(), {"yard": few})
    assert seen.outliers == ()
    assert "yard: tip holds 4 poses; outliers are looked for among 5 or more" in seen.remarks


def test_a_comparison_counts_them_in_nothing_unless_it_takes_all_as_it_is():
    """With the machine's own model the noise of two axes is left."""
    record = spoilt(posed(SOFT, poses(2, 20, 1), 1), 7, 0, factor=10.0)
    seen = flexarm.compare(SOFT, record)
    assert seen.signals["tip"].rms["total"] == pytest.approx(NOISE * np.sqrt(2), rel=0.3)
    assert any(note.startswith("1 outlier of tip, row 7, counts neither") for note in seen.notes)
    assert flexarm.compare(SOFT, record, align=False).signals["tip"].rms["total"] > 0.1


def test_a_diagnosis_finds_the_spring_beside_a_slipped_decimal_point():
    """In one of twenty poses, tenfold: the spring is found as without it, and the pose is said."""
    record = spoilt(posed(SOFT, poses(2, 20, 1), 1), 7, 0, factor=10.0)
    seen = flexarm.diagnose(two_joints(), {"yard": record}, n_jobs=1)
    assert seen.verdict == "effects"
    assert [(effect.name, effect.at) for effect in seen.effects] == [("joint_compliance", "elbow")]
    assert seen.effects[0].parameters[0].value == pytest.approx(1e5, rel=0.03)
    assert any(remark.startswith("1 outlier of tip in yard, row 7 (pose p7)") for remark in seen.remarks)


def test_a_soft_arm_in_few_poses_is_diagnosed_as_ever():
    """Five poses of one joint, of which the fifth is held back."""
    machine = crane(effects=[compliance("hinge", 5e4)])
    record = posed(machine, np.linspace(-1.0, 1.2, 5)[:, None])
    seen = flexarm.diagnose(crane(), {"yard": record}, n_jobs=1)
    assert [(effect.name, effect.at) for effect in seen.effects] == [("joint_compliance", "hinge")]
    assert not any("outlier" in remark for remark in seen.remarks)
