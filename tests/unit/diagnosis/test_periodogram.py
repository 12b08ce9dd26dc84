"""The periodogram beside SciPy's, which sums over all samples for each frequency, and its cost."""

import tracemalloc

import numpy as np
import pytest
from scipy.signal import lombscargle

from flexarm.residual_analysis.spectrum import periodogram


def signal(time):
    rng = np.random.default_rng(3)
    return 2 + np.sin(2 * np.pi * 1.23 * time + 0.7) + 0.1 * rng.standard_normal(len(time))


def sampled(jitter):
    """60 s at 10 Hz, a tenth of it dropped out."""
    rng = np.random.default_rng(0)
    time = 0.1 * (np.arange(600) + jitter * rng.uniform(-0.5, 0.5, 600))
    return np.delete(time, rng.integers(0, 600, 60))


@pytest.mark.parametrize(
    ("jitter", "highest", "tolerance"),
    [
        (0.0, None, 1e-4),  # on the grid; near half the rate cosine and sine are almost one
        (0.6, None, 4e-3),  # a stamp is off by a 32nd of the fastest wave at most
        (0.6, 15.0, 1e-2),  # above half the rate, where aliases are
    ],
)
def test_what_sines_take_is_what_scipy_finds(jitter, highest, tolerance):
    time = sampled(jitter)
    y = signal(time)
    frequency, taken = periodogram(time, y, 4, highest)
    wanted = lombscargle(time, y, 2 * np.pi * frequency, normalize=True, floating_mean=True) * np.var(y)
    regular = np.abs(frequency / 5 - np.round(frequency / 5)) > 1e-2  # elsewhere both are singular
    assert taken[regular] == pytest.approx(wanted[regular], abs=tolerance * np.var(y))
    assert frequency[1] - frequency[0] == pytest.approx(0.25 / np.ptp(time), rel=0.05)


def test_a_sine_takes_all_of_itself_whatever_the_samples():
    rng = np.random.default_rng(0)
    time = np.sort(rng.uniform(0, 40, 400))
    y = np.sin(2 * np.pi * 1.23 * time + 0.7)
    frequency, taken = periodogram(time, y, 4)
    assert frequency[np.argmax(taken)] == pytest.approx(1.23, abs=1 / 160)
    assert taken.max() > 0.94 * np.mean(y**2)  # at most an eighth of a peak's width beside it: sinc^2(1/8)


def test_a_minute_at_a_kilohertz_takes_little_memory():
    """All sums at once would be 60 000 times 120 000 numbers, 58 GB."""
    time = np.arange(60000) / 1e3
    tracemalloc.start()
    periodogram(time, np.sin(7 * time), 4)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 500e6
