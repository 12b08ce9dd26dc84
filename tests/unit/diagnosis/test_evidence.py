"""What is above the noise, and how strongly data speak for a model."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.arm.prior import Prior
from flexarm.diagnosis.candidate import Candidate, TransformedParameter
from flexarm.diagnosis.discrepancy import TimeDiscrepancy
from flexarm.diagnosis.evidence import Evidence, above_noise, autocovariance, explained_share, occam
from flexarm.diagnosis.fit import Projection
from flexarm.effects.backlash import Backlash
from flexarm.effects.cable_torque import CableTorque
from flexarm.effects.joint_compliance import JointCompliance

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


def test_white_noise_of_the_stated_size_leaves_nothing():
    values = RNG.normal(size=4000)
    assert above_noise(values, one_channel(4000))[KEY] < 0.25


@pytest.mark.parametrize("size", [0.7, 3.0])
def test_a_wave_in_noise_is_above_it_by_its_own_rms(size):
    t = np.arange(2000) * 0.1
    values = RNG.normal(size=2000) + size * np.sqrt(2) * np.sin(2 * np.pi * 0.05 * t)
    assert above_noise(values, one_channel(2000))[KEY] == pytest.approx(size, rel=0.15)


def test_noise_that_is_larger_than_stated_is_no_gap():
    """It is too large, but it is not correlated."""
    values = 2.0 * RNG.normal(size=4000)
    assert above_noise(values, one_channel(4000))[KEY] < 0.5


@pytest.mark.parametrize(("left", "share"), [(0.0, 1.0), (1.0, 0.9), (3.0, 0.5)])
def test_the_share_of_an_effect_counts_what_is_left_where_it_acts(left, share):
    """It explains 3 of sqrt(9 + left^2) in one channel; the gap of 20 in the other is none of its own."""
    n = 2000
    wave = np.sqrt(2) * np.sin(np.arange(n))
    rows = [
        SimpleNamespace(where=slice(k * n, (k + 1) * n), explained_square=nothing, record="run")
        for k in range(2)
    ]
    there = SimpleNamespace(channels=lambda: [(row, row.where) for row in rows])
    noise = RNG.normal(size=2 * n)
    noise /= noise.std()
    other = left * np.sqrt(2) * np.cos(np.arange(n))
    fit, fewer = (
        SimpleNamespace(projected=noise + np.concatenate([part, 20 * wave]), non_smooth=False)
        for part in (other, other + 3 * wave)
    )
    assert explained_share(fit, fewer, there) == pytest.approx(share, abs=0.03)


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
        spots={member.place for member in members},
        places=tuple((member.name, "hinge") for member in members),
    )


def cost(fit):
    return occam(fit, np.zeros((5, 1)), fit.z)


def test_a_law_that_needs_a_spring_that_the_model_lacks_is_half_as_likely():
    stiff = JointCompliance(at="hinge", stiffness=1e5)
    spring = Candidate(stiff, ("stiffness",), (), {})
    alone = Candidate(CableTorque(at="hinge", stiffness=1.0), ("stiffness",), (), {})
    gap = Candidate(Backlash(at="hinge", gap=1e-3), ("gap",), (), {}, needs=stiff)
    plain = cost(fit_of(alone))
    assert plain - cost(fit_of(gap)) == pytest.approx(np.log(2))
    assert cost(fit_of(gap, spring)) == pytest.approx(plain)


def test_a_registration_that_is_an_effect_spares_the_frame_its_own_freedom():
    """An unknown of slope 3 sigmas costs ln sqrt(1 + 5 x 9); without a prior or as an effect, nothing."""
    jacobian, none = np.full((5, 1), 3.0), np.zeros((5, 0))
    known, unknown = Projection(jacobian, np.ones(1)), Projection(jacobian, np.array([np.inf]))
    costs = [
        occam(SimpleNamespace(z=np.zeros(0), projection=p, members=()), p.jacobian, np.zeros(0))
        for p in (known, unknown, Projection(none, np.zeros(0)))
    ]
    assert costs == pytest.approx([-0.5 * np.log(46.0), 0.0, 0.0])


# ------------------------------------------------------------------------------------- errors of simulations


def test_an_error_along_the_difference_of_two_models_adds_to_the_covariance():
    """-(r (C + c v v^T)^-1 r + ln|C + c v v^T|)/2, written out."""
    n = 60
    there = one_channel(n)
    discrepancy = TimeDiscrepancy([slice(0, n)], 1.1, 4.0, 7.0)
    apart = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    v, left, c = RNG.normal(size=n), 3 * RNG.normal(size=n), 0.3
    matrix = 1.1 * np.eye(n) + 4.0 * np.exp(-apart / 7.0)

    def likely(matrix):
        return -(left @ np.linalg.solve(matrix, left) + np.linalg.slogdet(matrix)[1]) / 2

    found = Evidence((discrepancy,), left, likely(matrix), 0.0, 0.0).with_error(v, c, there)
    assert found == pytest.approx(likely(matrix + c * np.outer(v, v)), rel=1e-6)
