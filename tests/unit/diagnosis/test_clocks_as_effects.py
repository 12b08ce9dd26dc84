"""A clock or a frame as an effect: probed as it is eliminated, so that it takes over all that it does."""

import numpy as np
import pytest
from diagnoses import record, with_spring

from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.screening import Linear, probe
from flexarm.effects import FrameRegistration


@pytest.fixture(scope="module")
def setup():
    """A run that the model explains but for a late, displaced tracker."""
    problem = Problem(with_spring(), {"run": record(1)}, step=0.01)
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    places = {u.place for u in estimator.nuisance.parameters if u.kind != "nominal"}
    found = [c for c in candidates(problem, estimator.nuisance.arm) if c.place in places]
    assert {c.name for c in found} == {"time_delay", "frame_registration"}
    return estimator, probe(estimator, found), estimator.fit(())


def test_it_leaves_as_much_and_no_prior_to_pay(setup):
    """It explains what the unknown did, whose row x/sigma is gone: never less, and hardly more than that."""
    estimator, probed, fit = setup
    asked = (fit.projection.solve(fit.residual) / fit.nuisance.sigma) ** 2
    linear = Linear(estimator, probed, fit)
    for k in linear.free:
        own = [u.place == probed[k].candidate.place for u in estimator.nuisance.parameters]
        share, _ = linear._solved((k,))
        assert 0 <= share * fit.cost < 1.1 * asked[own].sum() + 0.1


def test_no_run_is_needed(setup):
    estimator, probed, _ = setup
    made = estimator.problem.simulations.made
    probe(estimator, [each.candidate for each in probed])
    assert estimator.problem.simulations.made == made


def test_a_frame_that_the_model_has_already_is_probed_by_what_changes():
    """Such as one of an earlier diagnosis: a probe is its whole size, and moves by the difference."""
    arm = with_spring().with_effect(FrameRegistration(at="tracker", translation=(5e-3, 0.0, 0.0)))
    problem = Problem(arm, {"run": record(1)}, step=0.01)
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    [frame] = [c for c in candidates(problem, estimator.nuisance.arm) if c.name == "frame_registration"]
    [probed] = probe(estimator, [frame])
    before = problem.residual(estimator.arm)
    for k, effect in enumerate(probed.candidate.probes):
        moved = problem.residual(estimator.arm.with_effect(effect)) - before
        assert probed.moves[:, k] == pytest.approx(moved, rel=0.02, abs=0.02 * np.abs(moved).max())
