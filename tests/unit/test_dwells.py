"""Drives that stand: found in noise, kept still, and nothing else taken for one."""

import numpy as np
import pytest
from scipy.interpolate import BSpline, PPoly

from flexarm.measurement.dwells import BLOCK, find_dwells
from flexarm.measurement.least_squares_spline import constant_in, fit_spline
from flexarm.measurement.smoothing import smooth

NOISE = 2e-6
TIME = np.arange(0, 12, 0.004)


def moves_and_stands(time):
    """Half a radian up from 2 to 3 s, back from 7 to 8 s; rate and acceleration start at zero."""

    def rise(x):
        x = np.clip(x, 0.0, 1.0)
        return x**3 * (10 - 15 * x + 6 * x**2)

    return 0.5 * (rise(time - 2) - rise(time - 7))


def noisy(values, seed, noise=NOISE):
    return values + noise * np.random.default_rng(seed).standard_normal(len(values))


@pytest.mark.parametrize("seed", range(5))
def test_a_motor_that_stands_does_not_creep(seed):
    """Noise alone would turn it to and fro by hundreds of its sigmas in four seconds."""
    breaks, coefficients = smooth(TIME, noisy(moves_and_stands(TIME), seed), NOISE)
    drive = PPoly(coefficients, breaks)
    rate = drive(np.arange(3.2, 6.8, 1e-3), 1)
    assert np.abs(rate).max() < 1e-12


@pytest.mark.parametrize("seed", range(5))
def test_stands_end_where_motions_begin(seed):
    """Within the blocks in which the motion is below the noise: 0.1 s of a move that starts smoothly."""
    found = find_dwells(TIME, noisy(moves_and_stands(TIME), seed) / NOISE)
    times = [(TIME[first], TIME[last]) for first, last in found]
    assert len(times) == 3
    for seen, true in zip(np.ravel(times), [0, 2, 3, 7, 8, 12], strict=True):
        assert seen == pytest.approx(true, abs=0.1)


def test_what_moves_is_not_held():
    """A wave, a ramp and a creep by one sigma a second, of which no part stands longer than some blocks."""
    for motion in (0.1 * np.sin(TIME), 1e-3 * TIME, 2 * NOISE * TIME):
        assert find_dwells(TIME, noisy(motion, 3) / NOISE) == []


def test_an_encoder_of_coarse_steps_does_not_stand_between_them():
    """A slow motion read in steps: constant for 0.4 s each, though nothing stands."""
    step = 1e-5
    reading = step * np.round(2.5e-5 * TIME / step)
    assert find_dwells(TIME, reading / (step / np.sqrt(12))) == []


def test_a_slow_top_of_a_wave_is_met_within_the_noise():
    """Where it is held for a moment, for want of motion above the noise, nothing is lost by it."""
    time = np.arange(0, 60, 1e-3)
    motion = 0.1 * np.sin(0.2 * time)
    drive = PPoly(*smooth(time, noisy(motion, 4, 1e-5), 1e-5)[::-1])
    assert np.abs(drive(time) - motion).max() < 1e-5


def test_two_stands_with_a_short_move_between_them():
    """Ten samples apart, each with close breaks beside it: they do not run into each other."""
    step = 1e-3 * np.clip((TIME - 5) / 0.04, 0, 1)
    drive = PPoly(*smooth(TIME, noisy(step, 7), NOISE)[::-1])
    assert np.abs(drive(np.arange(0.1, 4.8, 0.01), 1)).max() < 1e-12
    assert np.abs(drive(np.arange(5.3, 11.9, 0.01), 1)).max() < 1e-12
    assert drive(11.0) - drive(1.0) == pytest.approx(1e-3, abs=NOISE)
    assert np.abs(drive(TIME) - step).max() < 0.1e-3


def smooth_start(x):
    return x**3 * (10 - 15 * x + 6 * x**2)


def cosine(x):
    return 0.5 - 0.5 * np.cos(np.pi * x)


def constant_acceleration(x):
    return np.where(x < 0.5, 2 * x**2, 1 - 2 * (1 - x) ** 2)


def dry_friction(angle, width=2e-5):
    """Dahl's law along an angle, over the Coulomb torque."""
    z = np.zeros(len(angle))
    for i, way in enumerate(np.diff(angle), 1):
        z[i] = np.sign(way) + (z[i - 1] - np.sign(way)) * np.exp(-abs(way) / width)
    return z


@pytest.mark.parametrize("profile", [smooth_start, cosine, constant_acceleration])
def test_a_motor_that_stops_keeps_its_friction(profile):
    """Two moves with a stand after each, in five noises: turning back by half a sigma would lose 5 %."""

    def angle(time):
        rises = [profile(np.clip((time - begin) / 1.3, 0, 1)) for begin in (2.03, 7.21)]
        return 0.5 * rises[0] - 0.3 * rises[1]

    fine = np.arange(0, 12, 0.001)
    true = dry_friction(angle(fine))
    squares = []
    for seed in range(5):
        breaks, coefficients = smooth(TIME, noisy(angle(TIME), seed), NOISE)
        squares.append(np.mean((dry_friction(PPoly(coefficients, breaks)(fine)) - true) ** 2))
    assert np.sqrt(np.mean(squares)) < 0.02


def test_a_gentle_start_below_the_noise_makes_no_jerk():
    """The move is hidden by 50 urad for 50 ms; a spline that stands until then would have to catch up."""
    time = np.arange(0, 12, 1e-3)
    rises = [smooth_start(np.clip((time - begin) / 2, 0, 1)) for begin in (3, 8)]
    true = rises[0] - 0.6 * rises[1]
    drive = PPoly(*smooth(time, noisy(true, 1, 5e-5), 5e-5)[::-1])
    acceleration = np.gradient(np.gradient(true, 1e-3), 1e-3)
    assert np.abs(drive(time, 2) - acceleration)[5:-5].max() < 1.0


def test_an_overshoot_above_the_noise_stays():
    """Ten sigmas beyond the stand, for 40 ms, and back."""
    bump = np.where(abs(TIME - 3.03) < 0.02, np.cos(np.pi * (TIME - 3.03) / 0.04) ** 2, 0)
    overshoot = moves_and_stands(TIME) + 10 * NOISE * bump
    drive = PPoly(*smooth(TIME, noisy(overshoot, 2), NOISE)[::-1])
    assert drive(3.03) - drive(5.0) == pytest.approx(10 * NOISE, abs=4 * NOISE)


def test_equal_coefficients_are_those_of_least_squares():
    """Against dense algebra: B E d = y with the columns of equal coefficients added up."""
    rng = np.random.default_rng(6)
    time, values = np.linspace(0, 1, 80), rng.standard_normal(80)
    breaks = np.array([0, 8, 20, 31, 50, 64, 79])
    spline, fitted = fit_spline(time, values, breaks, at_rest=True, equal=constant_in((2, 4)))
    knots = np.concatenate([np.repeat(time[0], 3), time[breaks], np.repeat(time[-1], 3)])
    B = BSpline.design_matrix(time, knots, 3).toarray()
    E = np.zeros((9, 3))
    for column, members in enumerate(([0, 1], [2, 3, 4, 5, 6, 7], [8])):
        E[members, column] = 1
    d = np.linalg.lstsq(B @ E, values, rcond=None)[0]
    np.testing.assert_allclose(spline.c, E @ d, atol=1e-12)
    np.testing.assert_allclose(fitted, B @ E @ d, atol=1e-12)
    inside = np.linspace(time[20], time[31], 7)
    np.testing.assert_allclose(spline(inside), spline.c[2], atol=1e-12)


def test_a_stand_needs_some_blocks():
    assert find_dwells(np.arange(3.0 * BLOCK), np.zeros(3 * BLOCK)) == []
    assert find_dwells(np.arange(5.0 * BLOCK), np.zeros(5 * BLOCK)) == [(0, 5 * BLOCK - 1)]


def test_dwells_far_from_the_first_sample_are_found():
    """Sums over a long record cancelled there: of 60 stands at 2.4 rad 22 were found."""
    time = np.arange(0, 300, 2e-3)
    moves = sum((-1) ** k * np.clip((time - 10 * k - 3) / 4, 0, 1) for k in range(30))
    noise = 1e-6
    found = find_dwells(time, noisy(2.4 * moves, 0, noise) / noise)
    assert sum(moves[(first + last) // 2] > 0.5 for first, last in found) == 15
