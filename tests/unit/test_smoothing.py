"""Claims about smoothing: it keeps what moves the arm and drops what only rings it."""

import numpy as np
import pytest
from arms import smooth_step
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline, PPoly
from scipy.signal import StateSpace, lsim

from flexarm.errors import InvalidParameter
from flexarm.measurement.least_squares_spline import constant_in, fit_spline
from flexarm.measurement.penalised_spline import PASS, with_penalty
from flexarm.measurement.smoothing import _layout, interpolate, smooth

TRACKER_NOISE = 5e-5  # m, the laser tracker of the paper
LENGTH, MODE_HZ, DAMPING = 3.0, 2.5, 0.005


def slow_sine(t):
    return 1.2 * np.sin(2 * np.pi * t / 66.5) * smooth_step(t / 4)


def stop_and_go(t, start=2.0, acceleration=1.0, ramp=0.3, cruise=1.0):
    """Trapezoid of velocity: four jumps of the acceleration."""

    def ramped(s):
        return np.where(s < 0, 0.0, 0.5 * acceleration * s**2)

    return (
        ramped(t - start)
        - ramped(t - start - ramp)
        - ramped(t - start - ramp - cruise)
        + ramped(t - start - 2 * ramp - cruise)
    )


def tip_motion(drive, duration):
    """Tip x of an oscillator on a rigid rod: x'' + 2 zeta w (x' - L q') + w^2 (x - L q) = 0."""
    t = np.arange(0, duration, 1e-3)
    q = drive(t)
    w = 2 * np.pi * MODE_HZ
    rod = LENGTH * np.array([[0, 0], [w**2, 2 * DAMPING * w]])
    spring = np.array([[0, 1], [-(w**2), -2 * DAMPING * w]])
    system = StateSpace(spring, rod, np.array([[1.0, 0]]), np.zeros((1, 2)))
    return lsim(system, np.column_stack([q, np.gradient(q, t, edge_order=2)]), t, X0=[LENGTH * q[0], 0])[1]


def held(pieces):
    """The drive as simulations take it: held before and after."""
    breaks, coefficients = pieces
    polynomial = PPoly(coefficients, breaks)
    return lambda t: polynomial(np.clip(t, breaks[0], breaks[-1]))


def noisy(motion, duration, step, noise_std, seed):
    t = np.arange(0, duration, step)
    return t, motion(t) + noise_std * np.random.default_rng(seed).standard_normal(t.size)


@pytest.mark.parametrize("motion", [slow_sine, stop_and_go])
@pytest.mark.parametrize(("step", "noise_std"), [(0.002, 5e-6), (0.004, 1.5e-6)])
def test_smoothed_drive_moves_the_tip_by_less_than_the_tracker_sees(motion, step, noise_std):
    t, y = noisy(motion, 40.0, step, noise_std, seed=11)
    gap = tip_motion(held(smooth(t, y, noise_std)), 40.0) - tip_motion(motion, 40.0)
    assert np.abs(gap).max() < TRACKER_NOISE
    assert gap.std() < TRACKER_NOISE / 3


def test_raw_samples_would_ring_the_tip_many_times_more():
    """White noise of density 2 sigma^2 h drives the mode to L sqrt(pi f Q sigma^2 h), Q = 1/(2 zeta)."""
    noise_std, step = 5e-6, 0.002
    t, y = noisy(slow_sine, 120.0, step, noise_std, seed=3)
    raw = tip_motion(CubicSpline(t, y), 120.0) - tip_motion(slow_sine, 120.0)
    smoothed = tip_motion(held(smooth(t, y, noise_std)), 120.0) - tip_motion(slow_sine, 120.0)
    expected = LENGTH * np.sqrt(np.pi * MODE_HZ / (2 * DAMPING) * noise_std**2 * step)
    late = slice(40_000, None)  # three time constants after the start: what noise alone keeps up
    assert raw[late].std() == pytest.approx(expected, rel=0.5)  # about ten independent beats
    assert smoothed[late].std() < raw[late].std() / 5


def test_oscillations_of_the_controller_are_kept():
    """Twenty times weaker than the encoder's noise would hide them by eye: 4.1 Hz, 1 sigma."""
    noise_std = 5e-6

    def motion(t):
        return slow_sine(t) + noise_std * np.sin(2 * np.pi * 4.1 * t)

    t, y = noisy(motion, 60.0, 0.002, noise_std, seed=5)
    kept = held(smooth(t, y, noise_std))(t) - slow_sine(t)
    amplitude = 2 * np.mean(kept[5000:] * np.sin(2 * np.pi * 4.1 * t[5000:]))
    assert amplitude == pytest.approx(noise_std, rel=0.05)  # 1 sigma of the estimate is 0.9 %


def test_a_drive_at_rest_stays_at_rest():
    t, y = noisy(lambda t: np.full_like(t, 0.3), 60.0, 0.002, 5e-6, seed=7)
    breaks, coefficients = smooth(t, y, 5e-6)
    drive = PPoly(coefficients, breaks)
    assert np.abs(drive(t) - 0.3).max() < 5e-6 / 5
    assert np.abs(tip_motion(held((breaks, coefficients)), 60.0) - LENGTH * 0.3).max() < 5e-6
    assert drive.derivative()(0.0) == pytest.approx(0.0, abs=1e-15)


def test_nothing_moves_before_a_sharp_start():
    """A jump of the acceleration by 1 rad/s2 at 2 s; before it the drive strays by a few sigma at most."""
    for seed in range(5):
        t, y = noisy(stop_and_go, 8.0, 0.002, 5e-6, seed)
        drive = held(smooth(t, y, 5e-6))
        assert np.abs(drive(t[t < 2.0])).max() < 3 * 5e-6


def test_residual_is_the_stated_noise():
    """Chi-square per sample: one, less the few degrees of freedom that the breaks take up."""
    for motion, step, noise_std in [(slow_sine, 0.002, 5e-6), (stop_and_go, 0.004, 1.5e-6)]:
        t, y = noisy(motion, 60.0, step, noise_std, seed=9)
        pieces = smooth(t, y, noise_std)
        chi_square = np.mean((y - held(pieces)(t)) ** 2) / noise_std**2
        expected = 1 - (len(pieces[0]) + 2) / len(t)
        assert chi_square == pytest.approx(expected, abs=5 * np.sqrt(2 / len(t)))


def test_drive_and_two_derivatives_are_continuous():
    t, y = noisy(stop_and_go, 8.0, 0.002, 5e-6, seed=1)
    breaks, coefficients = smooth(t, y, 5e-6)
    drive = PPoly(coefficients, breaks)
    for order in range(3):
        derivative = drive.derivative(order) if order else drive
        scale = np.abs(derivative(t)).max()
        lengths = np.diff(breaks)[:-1]
        before = np.array([np.polyval(c, h) for c, h in zip(derivative.c.T[:-1], lengths, strict=True)])
        assert np.abs(before - derivative(breaks[1:-1])).max() < 1e-8 * scale


def test_breaks_do_not_ring_a_mode_at_their_own_spacing():
    """The error of a plain spline through exact samples rings such a mode by more than the noise.

    The amplitude at a frequency w is w |integral of e exp(i w t)|, here within a window that ends softly.
    """
    t, noise_std = np.linspace(0, 2, 201), 1e-6
    fine = np.linspace(0, 2, 4001)
    motion, exact = (0.1 * np.sin(np.pi * x / 2) ** 2 * np.cos(1.5 * x) for x in (t, fine))
    sparse, at_rest, _ = _layout(t.tobytes(), motion.tobytes(), noise_std)
    mode = 2 * np.pi / np.median(np.diff(t[sparse]))

    def ringing(spline):
        error = (spline(fine) - exact) * np.hanning(fine.size)
        return mode * abs(np.sum(error * np.exp(1j * mode * fine))) * fine[1]

    plain = ringing(fit_spline(t, motion, sparse, at_rest)[0])
    assert plain > noise_std
    assert ringing(held(smooth(t, motion, noise_std))) < plain / 10


def test_a_penalised_spline_is_a_filter_of_the_stated_passband():
    """H = 1 / (1 + (omega / omega_c)^8) in the middle, where ends are far: 1 % for dense breaks."""
    t = np.arange(0, 20, 0.005)
    breaks = np.append(np.arange(0, len(t) - 1, 40), len(t) - 1)  # 0.2 s
    dense, equal, weights = with_penalty(t, breaks, ())
    for part in (0.4, 0.8, 1.0, 1.3):
        omega = part * PASS / 0.2
        fitted = fit_spline(t, np.sin(omega * t), dense, equal=equal, penalty=weights)[1]
        middle = slice(1000, 3000)
        passed = np.sum(fitted[middle] * np.sin(omega * t[middle])) / np.sum(np.sin(omega * t[middle]) ** 2)
        assert passed == pytest.approx(1 / (1 + part**8), abs=0.01)


def test_dense_breaks_keep_the_constant_intervals_of_dwells():
    """Coefficients that a dwell makes equal stay those of its interval, whose length does not change."""
    t = np.linspace(0, 1, 101)
    breaks = np.array([0, 20, 40, 60, 80, 100])
    dense, equal, weights = with_penalty(t, breaks, constant_in([2]))
    spline, _ = fit_spline(t, np.sin(3 * t), dense, equal=equal, penalty=weights)
    within = spline(np.linspace(0.4, 0.6, 20))
    np.testing.assert_allclose(within, within[0], atol=1e-14)
    assert np.ptp(spline(np.linspace(0.0, 0.4, 20))) > 0.1


def test_gaps_and_jitter_do_no_harm():
    """Three samples in ten lost, stamps jittered by a fifth of the step, a gap of half a second."""
    rng = np.random.default_rng(2)
    t, _ = noisy(slow_sine, 40.0, 0.002, 0.0, seed=0)
    t = np.sort(t + 0.0004 * rng.standard_normal(t.size).clip(-2, 2))
    t = t[(rng.random(t.size) > 0.3) & ~((t > 20) & (t < 20.5))]
    y = slow_sine(t) + 5e-6 * rng.standard_normal(t.size)
    drive = held(smooth(t, y, 5e-6))
    everywhere = np.linspace(t[0], t[-1], 50_000)
    assert np.abs(drive(everywhere) - slow_sine(everywhere)).max() < 3 * 5e-6


def test_drop_outs_are_left_out():
    t, y = noisy(slow_sine, 20.0, 0.002, 5e-6, seed=4)
    y[1000:1100] = np.nan
    kept = np.isfinite(y)
    for full, short in zip(smooth(t, y, 5e-6), smooth(t[kept], y[kept], 5e-6), strict=True):
        np.testing.assert_array_equal(full, short)


def test_a_drive_that_starts_with_a_jump_of_velocity_keeps_it():
    t, y = noisy(lambda t: 0.5 * t, 10.0, 0.002, 5e-6, seed=6)
    breaks, coefficients = smooth(t, y, 5e-6)
    assert PPoly(coefficients, breaks).derivative()(0.0) == pytest.approx(0.5, rel=1e-4)


@pytest.mark.parametrize("noise_std", [0.0, 1e-13])
def test_without_noise_every_sample_is_met(noise_std):
    t, y = noisy(lambda t: np.sin(40 * t), 2.0, 0.002, 1e-3, seed=8)
    np.testing.assert_allclose(held(smooth(t, y, noise_std))(t), y, atol=1e-13)


def test_interpolation_is_the_not_a_knot_spline():
    """Exact for a cubic, whose third derivative is one number."""
    t = np.array([0.0, 0.3, 0.5, 1.1, 1.6])
    drive = PPoly(*interpolate(t, t**3 - 2 * t)[::-1])
    fine = np.linspace(0, 1.6, 50)
    np.testing.assert_allclose(drive(fine), fine**3 - 2 * fine, atol=1e-14)


@pytest.mark.parametrize("count", [2, 3, 4, 5, 1000])
def test_interpolation_is_that_of_scipy_to_rounding(count):
    """Terms of the polynomials over one step, which are of the size of the samples."""
    rng = np.random.default_rng(count)
    t = np.cumsum(rng.uniform(1e-3, 3e-3, count))
    y = rng.standard_normal(count)
    breaks, coefficients = interpolate(t, y)
    known = CubicSpline(t, y, bc_type="not-a-knot")
    powers = np.diff(t) ** np.arange(3, -1, -1)[:, None]
    np.testing.assert_array_equal(breaks, known.x)
    np.testing.assert_allclose(coefficients * powers, known.c * powers, rtol=0, atol=1e-13)


@given(
    count=st.integers(2, 200),
    noise_std=st.floats(1e-6, 1.0),
    scale=st.floats(1e-6, 1e3),
    seed=st.integers(0, 1000),
)
@settings(max_examples=60, deadline=None)
def test_smoothing_does_not_depend_on_units(count, noise_std, scale, seed):
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(1e-3, 1.0, count))
    y = rng.standard_normal(count)
    fine = np.linspace(t[0], t[-1], 300)
    drive = held(smooth(t, y, noise_std))(fine)
    other = held(smooth(t, scale * y, scale * noise_std))(fine)
    np.testing.assert_allclose(other, scale * drive, atol=1e-6 * scale * np.abs(drive).max())


@pytest.mark.parametrize(
    ("time", "values", "noise_std", "words"),
    [
        ([0, 1, 1, 2], [0, 1, 2, 3], 0.1, "must rise, got 1 s after 1 s in sample 3"),
        ([0, 1, 2], [0, 1], 0.1, "one value for each time"),
        ([0, 1, 2], [np.nan, 1, np.nan], 0.1, "at least two finite samples, got 1"),
        ([0, 1, 2], [0, 1, 2], -1.0, "noise_std of a drive"),
        ([0, 1, 2], [0, 1, 2], np.nan, "noise_std of a drive"),
    ],
)
def test_bad_input_is_named(time, values, noise_std, words):
    with pytest.raises(InvalidParameter, match=words):
        smooth(time, values, noise_std)
