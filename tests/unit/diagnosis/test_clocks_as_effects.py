"""A clock or a frame as an effect: probed as it is eliminated, so that it takes over all that it does."""

import numpy as np
import pytest
from diagnoses import record, with_spring

from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.estimator import Fitter
from flexarm.diagnosis.nuisance import unknowns
from flexarm.diagnosis.problem import Observed
from flexarm.diagnosis.screening import Linear, probe
from flexarm.effects import FrameRegistration


@pytest.fixture(scope="module")
def problem():
    """A run that the model explains but for a late, displaced tracker."""
    observed = Observed(with_spring(), {"run": record(1)}, step=0.01)
    fitter = Fitter.nominal(observed, unknowns(observed))
    places = {u.place for u in fitter.unknowns.each if u.kind != "nominal"}
    found = [c for c in candidates(observed, fitter.unknowns.arm) if c.place in places]
    assert {c.name for c in found} == {"time_delay", "frame_registration"}
    return fitter, probe(fitter, found), fitter.fit(())


def test_it_leaves_as_much_and_no_prior_to_pay(problem):
    """It explains what the unknown did, whose row x/sigma is gone: never less, and hardly more than that."""
    fitter, probed, fit = problem
    asked = (fit.projection.best(fit.residual) / fit.unknowns.sigma) ** 2
    linear = Linear(fitter, probed, fit)
    for k in linear.free:
        own = [u.place == probed[k].candidate.place for u in fitter.unknowns.each]
        share, _ = linear._solved((k,))
        assert 0 <= share * fit.cost < 1.1 * asked[own].sum() + 0.1


def test_no_run_is_needed(problem):
    fitter, probed, _ = problem
    made = fitter.observed.runs.made
    probe(fitter, [each.candidate for each in probed])
    assert fitter.observed.runs.made == made


def test_a_frame_that_the_model_has_already_is_probed_by_what_changes():
    """Such as one of an earlier diagnosis: a probe is its whole size, and moves by the difference."""
    arm = with_spring().with_effect(FrameRegistration(at="tracker", translation=(5e-3, 0.0, 0.0)))
    observed = Observed(arm, {"run": record(1)}, step=0.01)
    fitter = Fitter.nominal(observed, unknowns(observed))
    [frame] = [c for c in candidates(observed, fitter.unknowns.arm) if c.name == "frame_registration"]
    [probed] = probe(fitter, [frame])
    before = observed.residual(fitter.start)
    for k, effect in enumerate(probed.candidate.probes):
        moved = observed.residual(fitter.start.with_effect(effect)) - before
        assert probed.moves[:, k] == pytest.approx(moved, rel=0.02, abs=0.02 * np.abs(moved).max())
