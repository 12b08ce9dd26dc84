"""What samples are worth, what is above the noise, and how strongly data speak for a model."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from flexarm.arm.prior import Prior
from flexarm.diagnosis.evidence import above_noise, autocovariance, occam, variance_inflation
from flexarm.diagnosis.fit import Projection
from flexarm.diagnosis.parameters import TransformedParameter

RNG = np.random.default_rng(5)
KEY = ("run", "tip", 0)


def nothing(non_smooth):
    """What the right model leaves."""
    return 0.0


def one_channel(n):
    """As much of `Problem` as evidence asks for: one channel."""
    rows = SimpleNamespace(record="run", signal="tip", channel=0, where=slice(0, n), explained_square=nothing)
    records = {"run": SimpleNamespace(kind="motion")}
    return SimpleNamespace(records=records, channels=lambda: [(rows, rows.where)])


def test_autocovariance_is_the_mean_of_lagged_products():
    values = RNG.normal(size=57)
    gamma = autocovariance(values, 4)
    direct = [values[: 57 - lag] @ values[lag:] / 57 for lag in range(5)]
    assert gamma == pytest.approx(direct, abs=1e-13)


def test_white_noise_of_the_stated_size_counts_in_full_and_leaves_nothing():
    values = RNG.normal(size=4000)
    assert variance_inflation(values, one_channel(4000))[KEY] == pytest.approx(1.0, abs=0.35)
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
        found.append(variance_inflation(values, one_channel(n))[KEY])
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


# ---------------------------------------------------------------------------------------------------- poses


def poses(records, each):
    """As much of `Problem` as evidence asks for: one channel of static records, `each` poses in each."""
    rows = [
        SimpleNamespace(
            record=f"day {k}",
            signal="tip",
            channel=0,
            where=slice(each * k, each * (k + 1)),
            explained_square=nothing,
        )
        for k in range(records)
    ]
    named = {row.record: SimpleNamespace(kind="static") for row in rows}
    return SimpleNamespace(records=named, channels=lambda: [(row, row.where) for row in rows])


def test_poses_with_nothing_in_common_count_in_full():
    """The mean product of 400 x 90 pairs scatters by 0.7 %, nine times that at most."""
    found = variance_inflation(RNG.normal(size=4000), poses(400, 10))
    assert max(found.values()) == pytest.approx(1.0, abs=0.15)


def test_what_poses_of_a_record_share_counts_once_a_record():
    """Variance s^2 of each pose and t^2 of each record: T = s^2 + n t^2 [Moulton1986].

    t^2 from 400 records is known to sqrt(2/400) = 7 %.
    """
    n, own, shared = 10, 1.5, 3.0
    common = np.repeat(RNG.normal(size=400), n)
    found = variance_inflation(own * RNG.normal(size=400 * n) + shared * common, poses(400, n))
    assert len(set(found.values())) == 1
    assert found["day 0", "tip", 0] == pytest.approx(own**2 + n * shared**2, rel=0.2)


def test_all_poses_of_records_that_are_off_as_a_whole_are_worth_one_pose_each():
    values = np.repeat([5.0, -5.0, 5.0, -5.0], 8)
    assert variance_inflation(values, poses(4, 8))["day 0", "tip", 0] == pytest.approx(8 * 25.0)


# ------------------------------------------------------------------------------------------------ parsimony


def fit_of(*members):
    """One parameter of which data say nothing, of some effects."""
    parameter = TransformedParameter(0, "size", Prior(-1.0, 1.0, 0.0, "linear", "m", "a test"))
    return SimpleNamespace(
        z=np.zeros(1),
        parameters=(parameter,),
        jacobian=np.zeros((5, 1)),
        projected=np.zeros(5),
        projection=Projection(np.zeros((5, 0)), np.zeros(0)),
        members=members,
        places=tuple((member.name, "hinge") for member in members),
    )


def test_a_law_that_needs_a_spring_that_the_model_lacks_is_half_as_likely():
    spring = SimpleNamespace(name="joint_compliance", at="hinge", needs=None)
    alone = SimpleNamespace(name="cable_torque", at="hinge", needs=None)
    gap = SimpleNamespace(name="backlash", at="hinge", needs=spring)
    plain = occam(fit_of(alone), np.ones(5))
    assert plain - occam(fit_of(gap), np.ones(5)) == pytest.approx(np.log(2))
    assert occam(fit_of(gap, spring), np.ones(5)) == pytest.approx(plain)


def test_a_registration_that_is_an_effect_spares_the_frame_its_own_freedom():
    """An unknown of slope 3 sigmas costs ln sqrt(1 + 5 x 9); without a prior or as an effect, nothing."""
    jacobian, none = np.full((5, 1), 3.0), np.zeros((5, 0))
    known, unknown = Projection(jacobian, np.ones(1)), Projection(jacobian, np.array([np.inf]))
    costs = [
        occam(SimpleNamespace(z=np.zeros(0), projection=p, members=()), np.ones(5))
        for p in (known, unknown, Projection(none, np.zeros(0)))
    ]
    assert costs == pytest.approx([-0.5 * np.log(46.0), 0.0, 0.0])
