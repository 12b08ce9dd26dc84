"""Work that obeys a budget of time gives the best that it has, and says what it left out."""

import numpy as np
import pytest
from arms import rod_arm, smooth_step

import flexarm
from flexarm.arm.effect import read_effect
from flexarm.budget import allows, current, limited, until

ARM = rod_arm(
    [
        {"name": "hinge", "quantity": "joint_angle", "joint": "hinge", "rate_hz": 100, "noise_std": 5e-6},
        {"name": "tip", "quantity": "position", "point": "tip", "rate_hz": 10, "noise_std": 5e-5},
    ]
)


def test_what_no_time_is_left_for_is_told_once():
    with limited(1e-9) as budget:
        assert not allows("the first step")
        assert not allows("the second")
        assert not allows("the first step")
        assert current() is budget
    assert budget.remarks == ("the budget of 1e-09 s ended before the first step and the second",)
    assert allows("anything")


def test_a_stage_ends_at_its_part_of_the_whole_time():
    seconds = [0.0]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("flexarm.budget.monotonic", lambda: seconds[0])
        with limited(8.0) as budget:
            seconds[0] = 1.0
            with until(0.5):
                seconds[0] = 3.9
                assert allows("a part of the first stage")
                seconds[0] = 4.1
                assert not allows("the first stage")
            assert allows("anything")
            with until(0.75):
                assert allows("the second stage")
    assert budget.remarks == ("the budget of 8 s ended before the first stage",)


def test_without_a_limit_all_is_allowed():
    with limited(None) as budget:
        assert allows("the first step")
    assert budget.remarks == ()


def test_runs_that_are_stopped_are_left_out():
    drive = flexarm.Drive.from_samples(np.linspace(0, 4, 9), {"hinge": np.zeros(9)})
    assert flexarm.simulate_all([(ARM, drive)] * 3, stop=lambda: True) == []


def test_a_diagnosis_concludes_from_what_it_has_fitted(tmp_path):
    t = np.linspace(0, 4, 201)
    drive = flexarm.Drive.from_samples(t, {"hinge": 0.5 * smooth_step(t / 4)})
    soft = ARM.with_effect(read_effect({"name": "joint_compliance", "at": "hinge", "stiffness": 2e5}))
    run = flexarm.simulate(soft, drive, step=5e-3)
    record = flexarm.measure(run, ARM.sensors, np.random.default_rng(1), drive=["hinge"])
    seconds = [0.0]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("flexarm.budget.monotonic", lambda: seconds[0])

        def tell(done, what):
            seconds[0] = 10.0 * done  # the clock stands but for what is told

        found = flexarm.diagnose(ARM, record, n_jobs=1, max_seconds=2.5, progress=tell)
    assert found.verdict == "unexplained"
    assert found.effects == ()
    [said] = [remark for remark in found.remarks if remark.startswith("the budget of 2.5 s ended")]
    assert "all effects were screened" in said
    assert "all moves of the search were made" in said
    told = found.summary()
    assert "no known effect" not in told
    assert told.startswith("A gap remains, and the time for the search ended")
    found.save(tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text()
    assert "no known effect" not in page
    assert "of what was tried in the time given, nothing leaves only noise" in page


def test_a_budget_must_be_positive():
    with pytest.raises(flexarm.InvalidParameter, match="max_seconds: must be a positive, finite number"):
        flexarm.diagnose(ARM, [], max_seconds=-1.0)


def test_a_calibration_ends_with_the_estimates_that_it_has():
    """No time is left after the first step: it says so, and how far from rest the estimates are."""
    t = np.linspace(0, 4, 201)
    drive = flexarm.Drive.from_samples(t, {"hinge": 0.5 * smooth_step(t / 4)})
    soft = ARM.with_effect(read_effect({"name": "joint_compliance", "at": "hinge", "stiffness": 2e5}))
    run = flexarm.simulate(soft, drive, step=5e-3)
    record = flexarm.measure(run, ARM.sensors, np.random.default_rng(1), drive=["hinge"])
    brief = flexarm.calibrate(ARM, record, ["joint_compliance"], n_jobs=1, step=5e-3, max_seconds=1e-9)
    whole = flexarm.calibrate(ARM, record, ["joint_compliance"], n_jobs=1, step=5e-3)
    assert "the budget of 1e-09 s ended before the estimates came to rest" in brief.remarks
    assert any("not at rest after 1 steps" in remark for remark in brief.remarks)
    assert not any("budget" in remark for remark in whole.remarks)
    (stiffness,) = [p for p in whole.parameters if p.name.endswith("stiffness")]
    assert stiffness.value == pytest.approx(2e5, rel=0.01)
