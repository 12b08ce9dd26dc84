"""Claims about expected Bayes factors: closed forms for vectors that one can draw."""

import numpy as np
import pytest
from pytest import approx

from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.design.separation import (
    Responses,
    Shown,
    against_none,
    cliques,
    expected_log_bayes_factor,
    matrix,
    unexplained_gap,
)
from flexarm.diagnosis.nuisance import NuisanceModel, NuisanceParameter
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.screening import RIDGE, Probed
from flexarm.effects.backlash import Backlash
from flexarm.effects.joint_compliance import JointCompliance
from flexarm.effects.time_delay import TimeDelay

N = 40


def candidate(effect):
    return Candidate(effect, (), (effect,), {})


def bench(moves, jacobian=None, nuisance=()):
    """Effects with these gaps, one probe each."""
    effects = [JointCompliance(at="hinge", stiffness=1e5), Backlash(at="hinge", gap=1e-3)]
    probed = tuple(Probed(candidate(e), np.asarray(m)[:, None]) for e, m in zip(effects, moves, strict=False))
    jacobian = np.empty((N, 0)) if jacobian is None else jacobian
    return Responses(NuisanceModel(None, tuple(nuisance)), jacobian, probed)


def unit(k):
    return np.eye(N)[k]


def test_a_gap_at_one_instant_counts_with_half_its_square():
    """One row: N_v = 1, so that (2) is (s^2/2)/(1 + delta^2)."""
    found = against_none(bench([3.0 * unit(0)]), 3.0 * unit(0)[:, None])
    assert found == approx(4.5 / (1 + SelectionPolicy.discrepancy**2))


def test_a_lasting_gap_is_worth_no_more_than_the_discrepancy_allows():
    """A gap v at all N instants: N_v = N, so that ln B tends to v^2/(2 delta^2)."""
    many = np.full((10**6, 1), 0.5)
    assert expected_log_bayes_factor(many, len(many)) == approx(
        0.5**2 / (2 * SelectionPolicy.discrepancy**2), rel=1e-3
    )


def test_evidence_grows_with_the_square_of_a_size_and_falls_with_that_of_the_noise():
    gap = np.random.default_rng(1).standard_normal((N, 1))
    found = bench([gap[:, 0]])
    assert against_none(found, 3 * gap) == approx(9 * against_none(found, gap))


def test_a_rival_of_the_same_shape_leaves_only_what_its_size_costs():
    """min over a of |g + a D|^2 + |a RIDGE|^2 with D = g: s^2 RIDGE^2/(s^2 + RIDGE^2)."""
    gap = 3.0 * unit(0)
    v = unexplained_gap(bench([gap, gap]), gap[:, None], bench([gap, gap]).probed[1])
    assert np.sum(v**2) == approx(9 * RIDGE**2 / (9 + RIDGE**2))


def test_gaps_at_right_angles_are_told_apart_as_well_as_from_none():
    found = bench([3.0 * unit(0), 2.0 * unit(1)])
    factors = matrix(found, [Shown(0, 0), Shown(0, 0)])
    assert factors[0, 1] == approx(against_none(found, 3.0 * unit(0)[:, None])[0])
    assert factors[1, 0] == approx(against_none(found, 2.0 * unit(1)[:, None])[0])
    assert np.diag(factors) == approx(0)


def test_an_unknown_takes_what_its_prior_allows():
    """A gap along a nuisance of slope J and sigma s leaves g^2/(1 + J^2 s^2) of its square."""
    clock = NuisanceParameter("effects.time_delay.tracker.delay", 0.0, 2.0, "s", "clock")
    found = bench([3.0 * unit(0)], 5.0 * unit(0)[:, None], [clock])
    v = unexplained_gap(found, 3.0 * unit(0)[:, None], None)
    assert np.sum(v**2) == approx(9 / (1 + 25 * 4))


def test_a_delay_that_is_named_has_no_prior_of_a_clock():
    clock = NuisanceParameter("effects.time_delay.tracker.delay", 0.0, 1e-3, "s", "clock")
    late = Probed(candidate(TimeDelay(at="tracker", delay=1.0)), 5.0 * unit(0)[:, None])
    found = Responses(NuisanceModel(None, (clock,)), 5.0 * unit(0)[:, None], (late,))
    gap = 5.0 * unit(0)[:, None]
    assert len(unexplained_gap(found, gap, None)) == N + 1
    assert len(unexplained_gap(found, gap, late)) == N + 1  # its own probe instead of the clock
    assert np.sum(unexplained_gap(found, gap, late) ** 2) == approx(25 * RIDGE**2 / (25 + RIDGE**2))


@pytest.mark.parametrize(
    ("pairs", "groups"),
    [
        ([], []),
        ([(0, 1), (1, 2)], [(0, 1), (1, 2)]),
        ([(0, 1), (1, 2), (0, 2), (3, 4)], [(0, 1, 2), (3, 4)]),
    ],
)
def test_groups_hold_only_effects_of_which_all_pairs_are_tied(pairs, groups):
    tied = np.zeros((5, 5), dtype=bool)
    for i, j in pairs:
        tied[i, j] = tied[j, i] = True
    assert cliques(tied) == groups
