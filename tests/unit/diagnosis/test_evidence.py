"""What samples are worth, what is above the noise, and how strongly data speak for a model."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from flexarm.diagnosis.evidence import above_noise, autocovariance, worth

RNG = np.random.default_rng(5)
KEY = ("run", "tip", 0)


def one_channel(n):
    """As much of `Observed` as evidence asks for: one channel."""
    rows = SimpleNamespace(record="run", signal="tip", channel=0, where=slice(0, n))
    records = {"run": SimpleNamespace(kind="motion")}
    return SimpleNamespace(records=records, channels=lambda: [(rows, rows.where)])


def test_autocovariance_is_the_mean_of_lagged_products():
    values = RNG.normal(size=57)
    gamma = autocovariance(values, 4)
    direct = [values[: 57 - lag] @ values[lag:] / 57 for lag in range(5)]
    assert gamma == pytest.approx(direct, abs=1e-13)


def test_white_noise_of_the_stated_size_counts_in_full_and_leaves_nothing():
    values = RNG.normal(size=4000)
    assert worth(values, one_channel(4000))[KEY] == pytest.approx(1.0, abs=0.35)
    assert above_noise(values, one_channel(4000))[KEY] < 0.25


def test_correlated_noise_counts_as_its_effective_sample_size():
    """AR(1) of unit variance with coefficient a: n_eff = n (1 - a)/(1 + a) [Bayley1946].

    One estimate scatters by sqrt(4/3 of the window) = 37 %; the mean of forty by 6 %, less what the window
    takes away, about 2 %.
    """
    a, n = 0.8, 3000
    found = []
    for _ in range(40):
        values = lfilter([np.sqrt(1 - a**2)], [1, -a], RNG.normal(size=n + 100))[100:]
        found.append(worth(values, one_channel(n))[KEY])
    assert np.mean(found) == pytest.approx((1 + a) / (1 - a), rel=0.2)


@pytest.mark.parametrize("size", [0.7, 3.0])
def test_a_wave_in_noise_is_above_it_by_its_own_rms(size):
    t = np.arange(2000) * 0.1
    values = RNG.normal(size=2000) + size * np.sqrt(2) * np.sin(2 * np.pi * 0.05 * t)
    assert above_noise(values, one_channel(2000))[KEY] == pytest.approx(size, rel=0.15)


def test_noise_that_is_larger_than_stated_is_no_gap():
    """It is too large, but it is not correlated."""
    values = 2.0 * RNG.normal(size=4000)
    assert above_noise(values, one_channel(4000))[KEY] < 0.5
