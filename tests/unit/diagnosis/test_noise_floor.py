"""Claims about the floor: noise from samples, independent samples, and the error of a simulation."""

import numpy as np
import pytest
from planted import run_of
from tests.helpers.arms import beam, fixed, general, point

import flexarm
from flexarm import Record, Signal
from flexarm.comparison.aligned_record import simulate_record
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.measurement.drive_noise import drive_noise
from flexarm.record import DrawnLink
from flexarm.residual_analysis.noise_floor import (
    effective_samples,
    noise_floor,
    quiet_band_noise,
    refined,
    repeated_noise,
)


def test_noise_is_seen_beside_a_slow_gap_and_a_vibration():
    """A drift of 25 sigma and a sine of 20 are taken away; the quartile of 16 bands errs by 4 % then."""
    rng = np.random.default_rng(3)
    time = np.arange(600) / 10.0
    time = time[rng.random(600) > 0.02]
    gap = 1e-3 * np.cos(0.3 * time) + 8e-4 * np.sin(2 * np.pi * 2.4 * time)
    values = gap[:, None] + 4e-5 * rng.standard_normal((len(time), 2))
    assert quiet_band_noise(time, values) == pytest.approx(4e-5, rel=0.15)


def test_noise_of_white_samples_is_theirs():
    """The quartile of 16 bands with 50 freedoms each: sigma within 5 %, three of its standard deviations."""
    values = 0.2 * np.random.default_rng(5).standard_normal((800, 1))
    assert quiet_band_noise(np.arange(800.0), values) == pytest.approx(0.2, rel=0.1)


def test_too_few_samples_tell_no_noise():
    assert quiet_band_noise(np.arange(20.0), np.ones((20, 1))) is None
    assert drive_noise(np.arange(20.0), np.ones(20)) is None
    assert repeated_noise(np.array(["a", "b"]), np.ones((2, 1))) is None


def test_noise_of_a_drive_is_seen_beside_its_motion():
    time = np.arange(0, 30, 0.004)
    samples = np.sin(2 * np.pi * 0.3 * time) + 2e-6 * np.random.default_rng(1).standard_normal(len(time))
    assert drive_noise(time, samples) == pytest.approx(2e-6, rel=0.05)


def test_uneven_stamps_are_no_noise_of_a_drive():
    rng = np.random.default_rng(2)
    time = np.cumsum(rng.uniform(0.008, 0.012, 1000))
    assert drive_noise(time, np.sin(2 * np.pi * time)) < 1e-6
    noisy = np.sin(2 * np.pi * time) + 1e-4 * rng.standard_normal(1000)
    assert drive_noise(time, noisy) == pytest.approx(1e-4, rel=0.1)


def test_repeats_of_poses_show_their_scatter():
    rng = np.random.default_rng(2)
    pose = np.repeat([f"p{i}" for i in range(50)], 4)
    values = np.repeat(rng.standard_normal((50, 2)), 4, axis=0) + 0.01 * rng.standard_normal((200, 2))
    assert repeated_noise(pose, values) == pytest.approx(0.01, rel=0.2)  # 300 freedoms: 4 % a sigma


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.9])
def test_independent_samples_of_an_autoregressive_gap(rho):
    """n (1 - rho)/(1 + rho) for y_i = rho y_{i-1} + e_i."""
    rng, n = np.random.default_rng(8), 20000
    noise, gap = rng.standard_normal(n), np.zeros(n)
    for i in range(1, n):
        gap[i] = rho * gap[i - 1] + noise[i]
    assert effective_samples(gap[:, None]) == pytest.approx(n * (1 - rho) / (1 + rho), rel=0.15)


def test_halving_the_step_changes_a_prediction_by_a_quarter_as_much_each_time():
    """The method is of order two in the step."""
    run = run_of("one joint")
    changes = []
    for step in (8e-3, 4e-3):
        pair = simulate_record(run.simulation.arm, run.record, align=False, step=step)
        rows = {each.signal: each for each in noise_floor(pair, step=step).signals}
        changes.append(rows["tip"].errors["step"])
    assert changes[0] / changes[1] == pytest.approx(4.0, rel=0.2)


def test_a_floor_says_what_is_below_the_noise_and_what_is_not():
    run = run_of("one joint")
    found = noise_floor(run.showing({}, 4), step=4e-3)
    rows = {each.signal: each for each in found.signals}
    tip = rows["tip"]
    assert tip.estimated == pytest.approx(tip.stated, rel=0.15)
    assert tip.total == pytest.approx(np.sqrt(2) * 4e-5)
    assert set(tip.errors) == {"step", "mesh", "alpha"}
    assert not tip.contradicts
    assert tip.independent == pytest.approx(tip.samples, rel=0.5)
    assert rows["hinge encoder"].is_drive
    assert rows["hinge encoder"].errors == {}
    assert "estimated" in str(found)
    coarse = noise_floor(simulate_record(run.simulation.arm, run.record, align=False, step=0.1), step=0.1)
    assert not coarse.is_below_noise
    assert any("half the time step of 100 ms moves the prediction by" in note for note in coarse.notes)


def test_steps_are_halved_for_every_record_and_the_rest_is_tried_on_the_liveliest():
    run = run_of("one joint")
    pairs = {"a": run.showing({}, 1), "b": run.showing({}, 2)}
    found = [set(each.errors) for each in noise_floor(pairs, step=4e-3).signals if each.signal == "tip"]
    assert found == [{"step", "mesh", "alpha"}, {"step"}]
    assert all(
        len(each.errors) == 3
        for each in noise_floor(pairs, thorough=True, step=4e-3).signals
        if not each.is_drive
    )


def test_a_finer_mesh_has_twice_the_elements():
    assert [link.elements for link in refined(run_of("two joints").simulation.arm).links] == [4, 4]


def test_a_boom_that_a_record_draws_out_is_drawn_out_once():
    """Nodes of a uniform beam are where they are for any mesh; the boom is twice as long as the model's."""
    arm = flexarm.Arm.from_dict(
        {
            "joints": [fixed("clamp", "boom")],
            "links": [beam("boom", [1.0, 0, 0], general(1e-4, 1e-9), elements=2)],
            "points": [point("tip", "boom", [1.0, 0, 0])],
        }
    )
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        axes=("z",),
        values=np.zeros((1, 1)),
        pose=np.array(["a"]),
    )
    record = Record(kind="static", signals=[tip], links={"boom": DrawnLink(length=2.0)})
    (row,) = noise_floor(simulate_record(arm, record)).signals
    assert row.errors["mesh"] < 1e-6


def test_a_simulation_that_comes_to_no_end_is_said_and_stops_nothing(monkeypatch):
    def fails(*_, **__):
        raise NotConverged("stuck")

    pair = run_of("one joint").showing({}, 1)
    monkeypatch.setattr("flexarm.residual_analysis.noise_floor.simulate_record", fails)
    found = noise_floor(pair)
    assert not found.is_below_noise
    assert any("tip of record: no convergence with another step" in note for note in found.notes)
    found.plot()


def test_nothing_to_look_at_is_an_error():
    with pytest.raises(InvalidParameter, match="at least one record"):
        noise_floor({})
