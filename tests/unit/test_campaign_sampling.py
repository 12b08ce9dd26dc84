"""Samples follow their distributions, and the same seed gives the same samples."""

import numpy as np
import pytest

from flexarm.campaigns.sampling import Distribution, samples
from flexarm.campaigns.study import Sampling

N = 4096
SHAPES = {
    "normal": (Distribution("normal", (3.0, 0.5)), 3.0, 0.5),
    "lognormal": (Distribution("lognormal", (3.0, 0.5)), 3.0, 0.5),
    "uniform": (Distribution("uniform", (1.0, 4.0)), 2.5, 3 / np.sqrt(12)),
    "loguniform": (
        Distribution("loguniform", (1.0, np.e)),
        np.e - 1,
        np.sqrt((np.e**2 - 1) / 2 - (np.e - 1) ** 2),
    ),
    "values": (Distribution("values", (1.0, 2.0, 6.0)), 3.0, np.sqrt(14 / 3)),
}


@pytest.mark.parametrize("method", ["sobol", "latin-hypercube", "random"])
@pytest.mark.parametrize("name", SHAPES)
def test_mean_and_deviation_are_those_that_were_asked_for(method, name):
    """Within 5 standard errors of the mean, 1/sqrt(2 n) of a normal's deviation, for random points."""
    shape, mean, std = SHAPES[name]
    x = samples(Sampling(method=method, n=N, seed=4), [shape, shape], [None, None])
    assert x.shape == (N, 2)
    assert x.mean(axis=0) == pytest.approx(mean, abs=5 * std / np.sqrt(N))
    assert x.std(axis=0) == pytest.approx(std, rel=5 / np.sqrt(2 * N) * 1.5)


def test_a_seed_gives_its_samples_again():
    shape = SHAPES["normal"][0]
    one, again, other = (samples(Sampling(n=32, seed=s), [shape], [None]) for s in (1, 1, 2))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


def test_sobol_points_fill_each_interval_once():
    """The base-2 net property in one dimension: 2^k points, one in each of 2^k equal intervals."""
    x = samples(Sampling(n=64, seed=9), [Distribution("uniform", (0.0, 64.0))], [None])
    assert sorted(np.floor(x[:, 0])) == list(range(64))


def test_a_grid_has_every_combination():
    shapes = [
        Distribution("values", (1.0, 5.0)),
        Distribution("uniform", (0.0, 1.0)),
        Distribution("normal", (0.0, 1.0)),
    ]
    x = samples(Sampling(method="grid"), shapes, [None, 3, 1])
    assert x.tolist() == [[a, b, 0.0] for a in (1.0, 5.0) for b in (0.0, 0.5, 1.0)]


def test_saltellis_rows_swap_one_column_each():
    shape = Distribution("uniform", (0.0, 1.0))
    x = samples(Sampling(n=8, seed=1, saltelli=True), [shape] * 3, [None] * 3).reshape(5, 8, 3)
    a, b = x[:2]
    for k in range(3):
        swapped = a.copy()
        swapped[:, k] = b[:, k]
        assert np.array_equal(x[2 + k], swapped)
