"""Claims about the next experiment: it parts what mechanics parts, and is silent where nothing is left."""

from functools import cache

import pytest
from arms import crane, there_and_back, tracker

from flexarm.diagnosis.alternatives import AlternativeModel
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.design.experiment import from_drive
from flexarm.diagnosis.design.next_experiment import next_experiment
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.evidence import log_bayes_factor, log_likelihood_ratio
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.policy import DESIGN, SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.selection import Choice
from flexarm.effects.joint_compliance import JointCompliance
from flexarm.record import Clock, Frame

STEP = 4e-3


def model():
    """A tube with a load on a rigid hinge, seen at its tip."""
    return crane(sensors=(tracker(rate_hz=5),))


@cache
def choice(*alternatives):
    """A slow record of an arm with a spring, the spring named, some rivals fitted in its place."""
    clocks = {"controller": Clock(), "tracker": Clock(sigma=2e-3)}
    run = from_drive("slow", there_and_back(40.0), model(), clocks, {"tracker": Frame(translation=1e-3)})
    real = model().with_effect(JointCompliance(at="hinge", stiffness=4e5, damping=800.0))
    problem = Problem(model(), {"slow": run.record(real, STEP, -0.05)}, step=STEP)
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    known = {c.place: c for c in candidates(problem, estimator.nuisance.arm)}
    best = estimator.fit([known["joint_compliance", "hinge"]])
    fits = [estimator.fit([known[place]]) for place in alternatives]
    others = [
        AlternativeModel(
            f.members[0],
            f,
            log_bayes_factor(best, f, problem),
            log_likelihood_ratio(best, f, problem),
        )
        for f in fits
    ]
    return Choice(estimator.fit(()), best, estimator, [others])


def test_a_spring_is_parted_from_a_soft_link_by_the_shape_of_the_link():
    """Both are fitted and within reach; torque cannot part them, as it is the same whatever bends."""
    made = choice(("link_stiffness", "rod"))
    assert made.alternatives[0][0].behind < SelectionPolicy.reach
    found = next_experiment(made, made.estimator.problem)
    assert found.gain >= DESIGN.enough
    assert "torque" not in found.sentence
    assert found.sentence.startswith("Repeat 'slow' ")
    assert "joint compliance at hinge from link stiffness at rod" in found.sentence
    assert f"{found.gain:.0f}"[:2] in found.sentence


def test_a_spring_is_parted_from_a_heavier_load_by_the_torque_the_cheapest_way():
    made = choice(("payload_mass", "load"))
    found = next_experiment(made, made.estimator.problem)
    assert found.gain >= DESIGN.enough
    assert "with the motor torque of hinge logged" in found.sentence
    assert found.minutes == pytest.approx(15.0)


def test_against_several_rivals_the_gain_is_that_against_the_nearest():
    made = choice(("link_stiffness", "rod"), ("payload_mass", "load"))
    found = next_experiment(made, made.estimator.problem)
    assert "torque" not in found.sentence
    assert "at least" in found.sentence
    assert "link stiffness at rod" in found.sentence
    assert "payload mass at load" in found.sentence


def test_where_nothing_is_left_to_separate_nothing_is_proposed():
    made = choice()
    assert next_experiment(made, made.estimator.problem).sentence == ""


def test_what_no_effect_explains_is_to_be_described():
    """One load, one record and no torque: these are what a remainder may follow."""
    made = choice()
    said = next_experiment(made, made.estimator.problem, unexplained=True).sentence
    for words in ("'slow'", "half the speed", "another payload", "motor torque"):
        assert words in said
