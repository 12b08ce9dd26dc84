"""Claims about priors: a two-piece normal distribution whose range holds 95 %."""

import numpy as np
import pytest
from arms import paper_arm
from scipy.integrate import quad

from flexarm.arm import Prior
from flexarm.effects import LugreFriction
from flexarm.errors import InvalidParameter

PRIORS = [
    Prior(3e3, 4e6, 1e5, "log", "N m/rad", "catalogue"),
    Prior(-0.01, 0.03, 0.0, "linear", "m", "tolerance"),
    Prior(-np.pi, np.pi, 0.0, "uniform", "rad", "any angle"),
]


@pytest.mark.parametrize("prior", PRIORS, ids=lambda prior: prior.scale)
def test_the_density_integrates_to_one_and_the_range_holds_its_share(prior):
    """Integrated over u = ln x where the scale is logarithmic: p(x) dx = p(x) x du."""
    change = (np.log, np.exp) if prior.scale == "log" else (lambda x: x, lambda u: u)
    low, mode, high = (change[0](x) for x in (prior.low, prior.typical, prior.high))

    def density(u):
        x = change[1](u)
        return np.exp(prior.log_density(x)) * (x if prior.scale == "log" else 1.0)

    def share(a, b):
        return quad(density, a, mode, limit=200)[0] + quad(density, mode, b, limit=200)[0]

    far = 4 * (high - low)
    whole = share(low, high) if prior.scale == "uniform" else share(low - far, high + far)
    assert whole == pytest.approx(1.0, abs=1e-7)
    assert share(low, high) == pytest.approx(1.0 if prior.scale == "uniform" else 0.95, abs=1e-7)


@pytest.mark.parametrize("prior", PRIORS, ids=lambda prior: prior.scale)
def test_samples_follow_the_density(prior):
    """Shares below low, the mode and high within 4 sigma of a binomial count of 20000."""
    rng = np.random.default_rng(5)
    found = np.array([prior.sample(rng) for _ in range(20000)])
    u = np.log if prior.scale == "log" else np.asarray
    low, mode, high = (float(u(x)) for x in (prior.low, prior.typical, prior.high))
    below = (mode - low) / (high - low)  # share of (1) below its mode
    tail = 0.0 if prior.scale == "uniform" else 0.05
    for limit, share in ((low, tail * below), (mode, below), (high, 1 - tail * (1 - below))):
        spread = 4 * np.sqrt(share * (1 - share) / len(found))
        assert np.mean(u(found) < limit) == pytest.approx(share, abs=spread + 1e-12)


def test_impossible_values_have_no_density():
    assert PRIORS[0].log_density(-1.0) == -np.inf
    assert PRIORS[2].log_density(4.0) == -np.inf


def test_wrong_ranges_are_refused():
    with pytest.raises(InvalidParameter, match="low < typical < high, got 2, 1, 3 m"):
        Prior(2.0, 3.0, 1.0, "linear", "m", "")
    with pytest.raises(InvalidParameter, match="logarithmic scale needs low > 0, got 0"):
        Prior(0.0, 3.0, 1.0, "log", "m", "")


def test_friction_starts_no_lower_than_it_slips() -> None:
    """Breakaway torques of the prior go with the torque while it slips, whose law refuses smaller ones."""
    rng = np.random.default_rng(7)
    arm = paper_arm(1)
    for coulomb in (0.2, 20.0, 200.0):
        friction = LugreFriction(at="hinge", coulomb=coulomb, breakaway=coulomb, bristle_stiffness=1e5)
        prior = friction.priors(arm)["breakaway"]
        found = np.array([prior.sample(rng) for _ in range(2000)])
        assert np.mean(found < coulomb) < 0.01
        assert np.mean(found > 3 * coulomb) < 0.01
