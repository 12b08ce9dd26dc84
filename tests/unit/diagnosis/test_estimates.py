"""Intervals of what was fitted, in noise and beside a discrepancy."""

from dataclasses import replace
from types import SimpleNamespace

import diagnoses
import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from flexarm.arm.prior import Prior
from flexarm.diagnosis.candidate import Candidate, TransformedParameter
from flexarm.diagnosis.cross_validation import folds
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import Fit, Projection
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.uncertainty import deviations, estimates, surrogates, whole_turns
from flexarm.effects import PayloadMass, ViscousFriction
from flexarm.named_effects import NORMAL_90

RNG = np.random.default_rng(11)
TIME = np.arange(0.0, 40.0, 0.1)
N = len(TIME)
PRIOR = Prior(10.0, 18.0, 14.0, "linear", "kg", "a test")
SIZE = 4.0 / 1.959963984540054  # one sigma of it


class Recorded(SimpleNamespace):
    """N rows of a record."""

    def __len__(self):
        return N

    def channels(self):
        return [(row, row.where) for row in self.rows]


def problem(discretisation_error=0.0):
    rows = SimpleNamespace(
        record="run",
        signal="tip",
        channel=0,
        where=slice(0, N),
        time=TIME,
        discretisation_error=discretisation_error,
        explained_square=lambda non_smooth: 0.0,
    )
    records = {"run": SimpleNamespace(kind="motion")}
    return Recorded(rows=[rows], records=records, policy=SelectionPolicy(), evidence={})


class Cornered(PayloadMass):
    """A mass whose law has a corner."""

    smooth = False


def fitted(noise, slope, kind=PayloadMass):
    """A model that is linear in one mass, at its optimum: r = slope z + noise, the true z is 0."""
    column = slope[:, None]
    z = np.linalg.lstsq(column, -noise, rcond=None)[0] if slope.any() else np.zeros(1)
    effect = kind(at="load", mass=14.0 + SIZE * float(z[0]))
    member = Candidate(effect, ("mass",), (), {})
    residual = noise + column @ z
    projection = Projection(np.zeros((N, 0)), np.zeros(0))
    nuisance = SimpleNamespace(
        parameters=(),
        keys=[],
        arm=SimpleNamespace(joints=(), closures=(), sensors=(), encoders={}, effects=()),
    )
    return Fit(
        (member,),
        (TransformedParameter(0, "mass", PRIOR),),
        z,
        residual,
        residual,
        column,
        nuisance,
        projection,
    )


def test_a_block_is_a_stretch_of_time():
    found = folds(problem())
    assert len(found) == 24
    assert sorted(np.concatenate(found)) == list(range(N))
    assert all(np.all(np.diff(rows) == 1) for rows in found)


def test_spread_is_that_of_least_squares_in_white_noise():
    """One sigma is 1/|slope|, a little more where noise looks like a discrepancy."""
    slope = 0.5 * np.sin(TIME)
    spread = [deviations(fitted(RNG.normal(size=N), slope), problem(), 0.0)[0] for _ in range(12)]
    assert np.mean(spread) == pytest.approx(1 / np.linalg.norm(slope), rel=0.12)


def test_an_error_of_the_simulation_widens_by_what_moves_like_the_parameter():
    """A slope of one line: d sqrt(2) sin(wt + phase) along sin(wt) is d sqrt(2) cos(phase), d rms."""
    slope = np.sin(3 * 2 * np.pi * np.arange(N) / N)
    noise, known = 1e-9 * RNG.normal(size=N), 1.0 / np.linalg.norm(slope)
    smooth, bouncing = fitted(noise, slope), fitted(noise, slope, Cornered)
    for fit, error, expected in ((smooth, 2.25, 0.2), (bouncing, 0.0, 0.2), (bouncing, 2.25, 1.5)):
        found = deviations(fit, problem(discretisation_error=error))[0]
        assert found == pytest.approx(np.hypot(expected, known), rel=0.1)


def test_input_noise_widens_by_what_its_errors_move_the_estimate():
    """(2) of draws that a parameter of -2 or 1 would make; the prior takes less than 1 % of that."""
    slope = 0.5 * np.sin(TIME)
    fit = fitted(RNG.normal(size=N), slope)
    alone = deviations(fit, problem(), 0.0)[0]
    both = deviations(fit, problem(), 0.0, np.array([2.0 * slope, -slope]))[0]
    assert both == pytest.approx(np.hypot(alone, np.sqrt(2.5)), rel=1e-2)


def test_an_error_of_many_lines_cancels_and_phases_drawn_at_random_show_it():
    """(3) beside 2000 surrogates of a burst of vibration."""
    slope = np.exp(-(((TIME - 15.0) / 4.0) ** 2)) * np.sin(14.0 * TIME)
    lines = np.abs(np.fft.rfft(slope / np.sqrt(np.mean(slope**2))))
    phases = np.exp(2j * np.pi * RNG.random((2000, len(lines))))
    errors = np.fft.irfft(lines * phases, N, axis=1)
    expected = (errors @ slope / (slope @ slope)).std()
    depends = slope[:, None] / (slope @ slope)
    assert surrogates(problem(), slope[:, None], depends, np.ones(N)) == pytest.approx(expected, rel=0.05)
    assert expected < 0.4 / np.sqrt(np.mean(slope**2))


def holds(fit):
    """Return True if the 90 % interval holds the truth, z = 0."""
    return abs(fit.z[0]) <= NORMAL_90 * deviations(fit, problem(), 0.0)[0]


def test_nine_of_ten_intervals_hold_the_truth_in_correlated_noise():
    """Naive covariance would hold it in two thirds; 150 trials know 90 % to 2.5 %."""
    slope, inside = 0.5 * np.sin(0.8 * TIME), 0
    for seed in range(150):
        white = np.random.default_rng(seed).normal(size=N + 8)
        noise = np.convolve(white, np.full(8, 8**-0.5), mode="valid")[:N]  # means of eight: 0.8 s
        inside += holds(fitted(noise, slope))
    assert 0.82 <= inside / 150 <= 0.97


def test_what_the_data_leave_open_keeps_the_width_of_its_prior():
    """Priors count a ninth in a fit: three of their sigmas."""
    (effect,) = estimates(fitted(RNG.normal(size=N), np.zeros(N)), problem()).effects
    assert effect[0].std == pytest.approx(3 * SIZE, rel=0.15)


def bursts(noise):
    """A ringing after three stops tells the mass; a load, an offset and slow motions are fitted along."""
    after = [np.maximum(TIME - stop, 0.0) for stop in (5.0, 17.0, 29.0)]
    ringing = sum(np.exp(-t) * np.sin(9.0 * t) for t in after)
    slow = [np.sin(k * 0.3 * TIME + k) for k in (1, 2, 3, 5, 7)]
    others = np.column_stack([np.ones(N), TIME / 40.0, *slow])
    every = np.column_stack([ringing, others])
    found = np.linalg.lstsq(every, -noise, rcond=None)[0]
    fit = fitted(np.zeros(N), ringing)
    nuisance = SimpleNamespace(
        parameters=(),
        keys=[],
        arm=SimpleNamespace(joints=(), closures=(), sensors=(), encoders={}, effects=()),
    )
    projection = Projection(others, np.full(others.shape[1], 1e6))
    residual = noise + ringing * found[0]
    return replace(
        fit,
        z=found[:1],
        residual=residual,
        projected=projection.project(residual),
        nuisance=nuisance,
        projection=projection,
    )


def test_nine_of_ten_intervals_hold_the_truth_where_little_of_the_record_tells_it():
    """Three ringings; 300 trials know 90 % to 1.7 %."""
    inside = sum(holds(bursts(np.random.default_rng(seed).normal(size=N))) for seed in range(300))
    assert 0.85 <= inside / 300 <= 0.95


@pytest.mark.parametrize(("phase", "shown"), [(3.1, 3.1), (3.2, 3.2 - 2 * np.pi), (-9.5, -9.5 + 4 * np.pi)])
def test_phases_are_told_within_half_a_turn_of_zero(phase, shown):
    assert phase - whole_turns(phase) == pytest.approx(shown)


def test_what_a_planar_swing_does_not_show_of_a_frame_is_told_as_undetermined():
    motions = Problem(diagnoses.with_spring(), {"slow": diagnoses.record(1)}, step=0.01)
    fit = Estimator.nominal(motions, nuisance_model(motions)).fit([])
    found = {each.name: each.undetermined for each in estimates(fit, motions).nuisances}
    assert found == {
        "time_delay": (),
        "frame_registration": ("translation.y", "rotation.x", "rotation.z"),
    }


def test_a_size_that_may_be_none_has_the_upper_end_that_data_leave():
    """Friction c v of c = 0: residuals tell c to 1/|v|, whatever the range of its logarithm."""
    prior = Prior(0.2, 300.0, 8.0, "log", "N m s/rad", "a test")
    rate = 3.0 * np.sin(TIME)
    noise = RNG.normal(size=N)
    parameter = TransformedParameter(0, "coefficient", prior)

    def cost(z):
        return float(np.sum((noise + rate * parameter.value(z)) ** 2) + z**2)

    z = minimize_scalar(cost, bounds=(-6.0, 0.0), method="bounded").x
    c = parameter.value(z)
    member = Candidate(ViscousFriction(at="hinge", coefficient=c), ("coefficient",), (), {"coefficient": 0.0})
    fit = replace(
        fitted(noise, rate),
        members=(member,),
        parameters=(parameter,),
        z=np.array([z]),
        residual=noise + rate * c,
        projected=noise + rate * c,
        jacobian=(parameter.slope(z) * rate)[:, None],
    )
    [[found]] = estimates(fit, problem()).effects
    assert c < found.high90 < c + 1.3 * NORMAL_90 / np.linalg.norm(rate)
    assert parameter.value(z + NORMAL_90) > 2 * found.high90
