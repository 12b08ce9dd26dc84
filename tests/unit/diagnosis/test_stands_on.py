"""A law on a spring that the model lacks comes with that spring, which is fitted and named too."""

import numpy as np
import pytest
from diagnoses import nominal, record, with_spring

from flexarm.diagnosis import selection as choose
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.alternatives import alternatives_of
from flexarm.diagnosis.candidate import is_required
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.moves.search_state import newly_soft_joints, probed_through_springs
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.screening import probe, screen, screen_sets

SPRING = ("joint_compliance", "hinge")
LAWS = ("backlash", "joint_hysteresis", "joint_stiffening")


def setup(arm):
    problem = Problem(arm, {"run": record(1)}, step=0.01)
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    wanted = {SPRING, ("coulomb_friction", "hinge"), *((law, "hinge") for law in LAWS)}
    found = [c for c in candidates(problem, estimator.nuisance.arm) if c.place in wanted]
    return estimator, probe(estimator, found)


@pytest.fixture(scope="module")
def rigid():
    """A model whose hinge is rigid, beside a machine with a spring."""
    return setup(nominal())


def test_no_law_is_looked_at_without_its_spring(rigid):
    """It would bring a spring that nobody fitted, softer than the machine's or stiffer."""
    estimator, probed = rigid
    start = estimator.fit(())
    assert not {share.places[0][0] for share in screen(estimator, probed, start)} & set(LAWS)
    pairs = [share.places for share in screen_sets(estimator, probed, start, 2)]
    with_law = [places for places in pairs if {name for name, _ in places} & set(LAWS)]
    assert with_law
    assert all(SPRING in places for places in with_law)


def test_beside_its_spring_it_is_one_effect_more(rigid):
    estimator, probed = rigid
    spring = next(p.candidate for p in probed if p.candidate.place == SPRING)
    fit = estimator.fit((spring,))
    assert {share.places[0][0] for share in screen(estimator, probed, fit)} & set(LAWS)


def test_a_model_with_the_spring_takes_the_law_alone():
    estimator, probed = setup(with_spring(1.2e5))
    assert {share.places[0][0] for share in screen(estimator, probed, estimator.fit(()))} & set(LAWS)


def test_a_spring_that_a_law_stands_on_is_not_dropped_and_has_no_rivals(rigid, monkeypatch):
    estimator, probed = rigid
    spring = next(p.candidate for p in probed if p.candidate.place == SPRING)
    law = next(p.candidate for p in probed if p.candidate.name == "backlash")
    assert is_required((law,), spring) and not is_required((spring,), law)
    best = estimator.linearised((spring, law))
    assert (
        alternatives_of(0, best, Criteria(estimator.problem, estimator.fit(())), estimator, probed, ()) == []
    )
    asked = []
    monkeypatch.setattr(Criteria, "accepts", lambda self, new, old: asked.append(old.places) or True)
    choose.backward(Criteria(estimator.problem, None), best, estimator)
    assert asked == [(SPRING,)]


def test_friction_shows_beside_a_spring_and_not_in_a_rigid_joint(rigid):
    """A motor turns a rigid hinge whatever rubs there."""
    estimator, probed = rigid
    [k] = [k for k, p in enumerate(probed) if p.candidate.name == "coulomb_friction"]
    spring = next(p.candidate for p in probed if p.candidate.place == SPRING)
    assert np.abs(probed[k].moves).max() < 1e-3
    beside = estimator.linearised((spring,))
    assert newly_soft_joints(beside) == {"hinge"}
    awake = probed_through_springs(estimator, probed, beside)
    assert np.abs(awake[k].moves).max() > 1.0
    others = [i for i, p in enumerate(probed) if not p.candidate.effect.acts_through_spring()]
    assert all(awake[i] is probed[i] for i in others)


def test_nothing_is_probed_anew_where_the_model_has_the_spring():
    estimator, probed = setup(with_spring(1.2e5))
    spring = next(p.candidate for p in probed if p.candidate.place == SPRING)
    beside = estimator.linearised((spring,))
    made = estimator.problem.simulations.made
    assert probed_through_springs(estimator, probed, beside) == list(probed)
    assert estimator.problem.simulations.made == made
