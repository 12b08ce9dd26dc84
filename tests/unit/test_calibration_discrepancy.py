"""Discrepancies of a calibration and the weights of its rows, of processes that are drawn."""

import numpy as np
from pytest import approx
from scipy.signal import lfilter

from flexarm.calibration.discrepancy import SQUARES, Channel
from flexarm.calibration.estimation import Weighting
from flexarm.diagnosis.discrepancy import pose_kernels

NO_INPUT = np.empty((0, 1))


def weighting(channel: Channel, residual, errors=NO_INPUT, spread=None) -> Weighting:
    n = len(residual)
    hidden = np.zeros((n, 1)) if spread is None else spread
    return Weighting.of([slice(0, n)], [channel], residual, errors, hidden)


def motion(n: int, errors=None) -> Channel:
    return Channel.of_motion(n, 1.0, np.empty((0, n)) if errors is None else errors)


def process(n: int, size: float, length: float, rng) -> np.ndarray:
    """Draw an Ornstein-Uhlenbeck process of variance `size` at rest."""
    phi = np.exp(-1 / length)
    start = int(10 * length)
    steps = np.sqrt(size * (1 - phi**2)) * rng.normal(size=n + start)
    return lfilter([1.0], [1.0, -phi], steps)[start:]


def test_weights_of_poses_are_one_over_the_variance_of_their_mean():
    rng = np.random.default_rng(2)
    kernels = pose_kernels(rng.uniform(-1, 1, size=(60, 2)))
    residual, ones = 6 * kernels[2][1][:, -1] + rng.normal(size=60), np.ones(60)
    found = weighting(Channel.of_poses(kernels, 1.0), residual)
    level = ones @ found.times(ones) / 60
    assert level > 1.2
    assert found.root(residual) == approx(residual / np.sqrt(level))


def test_noise_alone_leaves_what_it_would_not_show():
    """0.2 of the noise, lasting, would show in 4000 samples at many sigmas, in each length that is tried."""
    residual = np.random.default_rng(3).normal(size=4000)
    ones = np.ones(4000)
    assert 1.0 < ones @ weighting(motion(4000), residual).times(ones) / 4000 < 1.4


def test_the_variance_of_the_mean_of_a_process_is_found():
    """r + 2 L s^2; 200 correlation lengths know it to some fifth."""
    rng, n = np.random.default_rng(4), 8000
    residual, ones = process(n, 9.0, 40.0, rng) + rng.normal(size=n), np.ones(n)
    found = ones @ weighting(motion(n), residual).times(ones) / n
    assert found == approx(1 + 2 * 40 * 9, rel=0.5)


def test_an_error_that_estimates_hide_counts_by_its_expectation():
    """Ten slow waves are fitted to 160 values: what is left of them excludes no long error."""
    rng, n = np.random.default_rng(5), 160
    waves = np.array([np.cos(np.pi * k * (np.arange(n) + 0.5) / n) for k in range(10)]).T
    basis = np.linalg.qr(waves)[0]
    white = rng.normal(size=n)
    residual, ones = white - basis @ (basis.T @ white), np.ones(n)
    unaware = ones @ weighting(motion(n), residual).times(ones) / n
    aware = ones @ weighting(motion(n), residual, spread=basis).times(ones) / n
    assert aware > unaware


def ringing(draws: int, n: int) -> np.ndarray:
    """Input noise that a mode at a tenth of the sampling rate amplifies to five times the noise."""
    pole = 0.97 * np.exp(2j * np.pi * 0.1)
    noise = np.random.default_rng(6).normal(size=(draws, n + 400))
    found = lfilter([1.0], np.poly([pole, pole.conjugate()]).real, noise)[:, 400:]
    return 5.0 * found / found.std()


def test_input_noise_that_rings_is_no_discrepancy():
    n = 4000
    *draws, own = ringing(9, n)
    residual, ones = own + np.random.default_rng(7).normal(size=n), np.ones(n)
    found = weighting(motion(n, np.array(draws)), residual, np.array(draws))
    assert ones @ found.times(ones) / n < 3.0  # of 26, noise and input noise
    white = found.root(residual)
    assert white.std() == approx(1.0, abs=0.2)
    assert abs(np.corrcoef(white[2:], white[:-2])[0, 1]) < 0.3


def test_the_prior_of_a_size_is_half_cauchy():
    """p(s < 1) = 1/2 at the scale of the noise, whatever the grid."""
    channel = motion(50)
    share = np.exp(channel.log_prior)
    assert share.sum() == approx(1.0)
    squares = np.tile(SQUARES, len(share) // len(SQUARES))
    assert share[squares < 1.0].sum() == approx(0.5, abs=0.05)
