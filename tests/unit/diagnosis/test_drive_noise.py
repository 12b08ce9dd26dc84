"""Noise of an encoder that drives a lightly damped arm moves its tip, and is no gap."""

import numpy as np
import pytest
from arms import crane, hinge, smooth_step, tracker

import flexarm
from flexarm import Drive
from flexarm.arm.sensor import Sensor
from flexarm.diagnosis.evidence import above_noise
from flexarm.diagnosis.noise_model import (
    allow_for_input_noise,
    input_noise_by_signal,
    input_noise_errors,
    input_noise_reading,
    input_noise_remarks,
    weighted_by_input_noise,
)
from flexarm.diagnosis.policy import NOISE_MODEL
from flexarm.diagnosis.problem import Problem
from flexarm.effects import JointCompliance
from flexarm.record import Clock, Frame

TRACKER = 5e-5


@pytest.fixture(scope="module")
def arm():
    """A first mode at 2.6 Hz that answers 1 % damped."""
    return crane(effects=[]).with_effect(JointCompliance(at="hinge", stiffness=1.4e5, damping=180.0))


def problem(arm, noise, step=0.0, amplitude=0.4):
    """The tip beside the model along what an encoder showed of quick moves, all else exact."""
    t = np.arange(0, 20, 0.01)
    angle = amplitude * np.sin(2 * np.pi * 0.4 * t) * smooth_step(t / 3)
    run = flexarm.simulate(arm, flexarm.Drive.from_samples(t, {"hinge": angle}), step=4e-3)
    encoder = {"quantity": "joint_angle", "joint": "hinge", "rate_hz": 100, "clock": "plc"}
    record = flexarm.measure(
        run,
        [Sensor(name="hinge", noise_std=noise, step=step, **encoder), tracker("tip", noise=TRACKER)],
        np.random.default_rng(5),
        drive=["hinge"],
        clocks={"plc": Clock(), "tracker": Clock()},
        frames={"tracker": Frame()},
    )
    return Problem(arm, {"run": record}, step=4e-3)


def left(there, residual):
    """Above the noise, in each channel."""
    return np.array(list(above_noise(residual, there).values()))


def test_the_right_model_leaves_no_gap_but_the_noise_that_is_foretold(arm):
    """A tenth of a milliradian: what is left of it moves the tip by more than the tracker sees."""
    there = problem(arm, 1e-4)
    residual = there.residual(arm)
    assert left(there, residual).max() > 1.0
    allow_for_input_noise(there, arm)
    assert left(there, residual).max() < 1.0  # a mode is shaken by a few independent values
    [said] = input_noise_remarks(input_noise_by_signal(there), there)
    assert said.startswith("noise of hinge, as stated, moves tip by ")
    assert said.endswith(" times its noise, which is no gap")


def test_of_counts_that_repeat_the_greatest_error_counts_twice(arm):
    """Counts of 0.3 mrad in a motion of 3 mrad: most readings equal the one before."""
    there = problem(arm, 0.0, 3e-4, 3e-3)
    residual = there.residual(arm)
    drawn = input_noise_errors(there, arm)[: NOISE_MODEL.draws]
    greatest = [4 * max(float(np.mean(error[row.where] ** 2)) for error in drawn) for row in there.rows]
    allow_for_input_noise(there, arm)
    assert [row.input_noise for row in there.rows] == pytest.approx(greatest)
    assert left(there, residual).max() < 1.0


def test_a_gap_stays_a_gap(arm):
    """A softer spring moves the tip by more than the drive's noise does."""
    there = problem(arm, 1e-4)
    softer = arm.with_effect(JointCompliance(at="hinge", stiffness=1.2e5, damping=180.0))
    allow_for_input_noise(there, arm)
    assert left(there, there.residual(softer)).max() > 2.0


def test_a_good_encoder_changes_nothing(arm):
    there = problem(arm, 1e-7)
    rows = there.rows
    allow_for_input_noise(there, arm)
    assert there.rows is rows
    assert input_noise_by_signal(there) == {}
    assert input_noise_remarks({}, there) == []


def test_the_same_model_is_allowed_the_same_and_never_less(arm):
    one, other = (problem(arm, 1e-4) for _ in range(2))
    for there in (one, other):
        allow_for_input_noise(there, arm)
    first = [row.input_noise for row in one.rows]
    assert first == [row.input_noise for row in other.rows]
    rigid = arm.without_effect("joint_compliance", "hinge")  # follows its drive, and rings far less
    allow_for_input_noise(one, rigid)
    assert all(row.input_noise >= before for row, before in zip(one.rows, first, strict=True))


def test_models_share_the_draws_of_the_drives(arm, monkeypatch):
    """Smoothing is most of the work, and does not depend on springs."""
    there = problem(arm, 1e-4)
    first = input_noise_errors(there, arm)
    monkeypatch.setattr(Drive, "from_record", None)
    softer = arm.with_effect(JointCompliance(at="hinge", stiffness=1.2e5, damping=180.0))
    assert input_noise_errors(there, arm) == pytest.approx(first)
    assert input_noise_errors(there, softer).shape == first.shape
    monkeypatch.undo()
    assert input_noise_errors(problem(arm, 1e-4), arm) == pytest.approx(first)


def test_noise_that_is_larger_is_shaken_by_less_of_it(arm):
    there = problem(arm, 1e-4)
    allow_for_input_noise(there, arm)
    noisier = there.with_noise(np.full(len(there.rows), 2.0))
    assert [row.input_noise for row in noisier.rows] == pytest.approx(
        [row.input_noise / 4 for row in there.rows]
    )


def test_a_signal_that_reads_little_but_the_drive_weighs_by_what_it_scatters():
    """A milliradian moves the tip of a rod of 2 m by 20 times its noise; across the plane it stays."""
    rod, there = posed(1e-3, 4)
    allow_for_input_noise(there, rod)
    weighed = weighted_by_input_noise(there)
    assert weighed is not there
    residual = there.residual(rod)
    for before, after in zip(there.rows, weighed.rows, strict=True):
        loud = before.input_noise > 25.0
        expected = before.sigma * np.sqrt(1.0 + before.input_noise) if loud else before.sigma
        assert after.sigma == pytest.approx(expected)
        assert (after.input_noise == 0.0) == loud or before.input_noise == 0.0
        scatter = np.std(residual[before.where]) * before.sigma / after.sigma
        assert scatter < 2.0  # of its new size
    calm = posed(1e-5, 4)[1]
    assert weighted_by_input_noise(calm) is calm


def posed(angle_noise, seed, count=12):
    """A rigid rod of 2 m at angles that its encoder reads with noise; its tip to 0.1 mm."""
    rod = flexarm.Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [{"name": "rod", "type": "rigid", "mass": 5.0, "com": [1.0, 0.0, 0.0]}],
            "points": [{"name": "tip", "link": "rod", "position": [2.0, 0.0, 0.0]}],
        }
    )
    rng = np.random.default_rng(seed)
    poses = np.array([f"{k}" for k in range(count)])
    angles = np.linspace(-1.0, 1.0, count)
    places = 2.0 * np.stack([np.cos(angles), 0 * angles, -np.sin(angles)], axis=1)
    signals = [
        flexarm.Signal(
            name="hinge",
            quantity="joint_angle",
            joint="hinge",
            values=(angles + angle_noise * rng.standard_normal(count))[:, None],
            pose=poses,
            noise_std=angle_noise,
        ),
        flexarm.Signal(
            name="tip",
            quantity="position",
            point="tip",
            values=places + 1e-4 * rng.standard_normal(places.shape),
            pose=poses,
            noise_std=1e-4,
        ),
    ]
    record = flexarm.Record(signals=signals, drive=("hinge",), kind="static")
    return rod, Problem(rod, {"poses": record})


def test_angles_of_poses_are_no_better_known_than_their_encoder_reads_them():
    """0.2 mrad move the tip of a rod of 2 m by 0.4 mm along its way, four times what is stated of it."""
    rod, there = posed(2e-4, 3)
    residual = there.residual(rod)
    assert left(there, residual).max() > 2.0
    allow_for_input_noise(there, rod)
    assert left(there, residual).max() < 1.0
    input_noise = sum(each.input_noise for each in there.rows)
    assert input_noise == pytest.approx((2 * 2e-4 / 1e-4) ** 2, rel=0.5)  # 48 draws of n: within some 20 %


def test_counts_of_a_joint_at_rest_err_alike():
    """Rounded to counts a joint at rest errs by one value, any within half a count; noise averages out."""
    step, time = 1e-3, np.arange(0, 4, 0.01)
    moved = 0.3 * smooth_step((time - 2) / 2)
    values = step * np.round(moved / step)
    rod, _ = posed(1e-5, 4)
    encoder = flexarm.Signal(
        name="hinge",
        quantity="joint_angle",
        joint="hinge",
        values=values[:, None],
        time=time,
        noise_std=step / np.sqrt(12),
    )
    record = flexarm.Record(signals=[encoder], drive=("hinge",))
    rng = np.random.default_rng(1)
    at_rest = [input_noise_reading(record, "hinge", rod, rng)[:150, 0].mean() for _ in range(200)]
    assert np.std(at_rest) == pytest.approx(step / np.sqrt(12), rel=0.15)


def test_few_poses_scatter_by_chance_and_that_is_no_gap():
    """Of 300 tens of poses with nothing but noise, one channel in a thousand stands above it."""
    above = sum(
        left(there, there.residual(rod)).max() > 0 for rod, there in (posed(0, k, 10) for k in range(100))
    )
    assert above <= 2


def test_a_calibration_says_what_noise_of_the_drives_does(arm):
    there = problem(arm, 1e-4)
    uncertain = arm.replace(uncertainty={"payloads.load.mass": 0.05})
    found = flexarm.calibrate(uncertain, there.records, n_jobs=1, step=4e-3)
    assert any(said.startswith("noise of hinge, as stated, moves tip by ") for said in found.remarks)
