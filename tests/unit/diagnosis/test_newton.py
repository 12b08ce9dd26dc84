"""A link's stiffness beside its modulus: what acts alike is found together, with an interval of both."""

from types import SimpleNamespace

import numpy as np
import pytest
from planted import run_of
from scipy.optimize import minimize

import flexarm
from flexarm.arm.prior import Prior
from flexarm.diagnosis.candidate import TransformedParameter
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import Projection
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.policy import FIT
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.refinement import (
    converged,
    gauss_newton_step,
    linearised,
    objective,
    predicted_decrease,
)
from flexarm.diagnosis.uncertainty import estimates
from flexarm.effects import LinkStiffness
from flexarm.measurement import predict

SCALE, MODULUS = 1.09, "links.rod.material.youngs_modulus"


@pytest.fixture(scope="module")
def first():
    """The fit of a stiffness to a rod that is 9 % too stiff, of a modulus that is known to 1 %."""
    run = run_of("one joint")
    nominal = run.simulation.arm.replace(uncertainty={MODULUS: 0.01})
    simulation = flexarm.simulate(
        nominal.with_effect(LinkStiffness(at="rod", scale=SCALE)), run.record, step=1e-3
    )
    rng = np.random.default_rng(3)
    shown = [
        s if s.name in run.record.drive
        else s.replace(values=(exact := predict(simulation, s)) + s.noise_std * rng.normal(size=exact.shape))
        for s in run.record.signals.values()
    ]  # fmt: skip
    problem = Problem(nominal, {"run": run.record.replace(signals=shown)}, step=4e-3)
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    member = [c for c in candidates(problem, estimator.nuisance.arm) if c.name == "link_stiffness"]
    return estimator.fit(member), estimator


def strain_of_the_modulus(fit):
    k = fit.nuisance.keys.index(MODULUS)
    return abs(fit.projection.solve(fit.residual)[k]) / fit.nuisance.sigma[k]


def test_derivatives_by_both_are_one(first):
    """By dE/E as by ds/s: what differs could tell them apart. 3e-4 sigma leave 0.6 %, 0.01 left 4 %."""
    fit, about = linearised(*first)
    k = fit.nuisance.keys.index(MODULUS)
    modulus = about.arm.link("rod").material.youngs_modulus
    by_modulus = modulus * fit.projection.jacobian[:, k]
    [parameter], [z] = fit.parameters, fit.z
    by_scale = parameter.value(z) / parameter.slope(z) * fit.jacobian[:, 0]
    assert np.linalg.norm(by_scale - by_modulus) < 1e-2 * np.linalg.norm(by_modulus)


def test_the_modulus_goes_back_to_where_it_is_likely(first):
    """Only its prior tells it from the stiffness, so that it is nominal where the product fits."""
    fit, _ = converged(*first)
    assert strain_of_the_modulus(fit) < 0.2
    assert fit.members[0].effect.scale == pytest.approx(SCALE, rel=2e-3)


def test_its_interval_is_as_wide_as_the_modulus_is_uncertain(first):
    """1 % of the modulus are 1.64 % of half width at 90 %, to the 5 % that 600 draws know it."""
    fit, about = converged(*first)
    [[found]] = estimates(fit, about.problem).effects
    half = (found.high90 - found.low90) / 2
    assert half == pytest.approx(1.645 * 0.01 * SCALE, rel=0.12)


def test_what_is_evaluated_stays_as_it_is(first):
    here, about = linearised(*first)
    assert linearised(here, about) == (here, about)


def test_a_fit_of_another_fitter_is_evaluated_anew(first):
    """Its effects are those of the fitter about it, but its derivatives by unknowns are not."""
    fit, estimator = first
    about = estimator.about(fit)
    here, there = linearised(fit, about)
    assert there is about
    assert here.projection is about.eliminated(here.members)[1]
    assert here.projection is not fit.projection


@pytest.mark.parametrize("smooth, step", [(True, FIT.smooth_step), (False, FIT.non_smooth_step)])
def test_laws_with_corners_are_stepped_across_them(smooth, step):
    prior = Prior(0.6, 1.25, 1.0, "log", "-", "a test")
    assert TransformedParameter(0, "scale", prior, smooth).step(0.0, 30.0) == step


def test_a_mass_that_was_written_down_wrong_is_within_reach():
    """A factor of thirty, though the prior holds machines to a few tenths; wide ones have eight sigmas."""
    tight = TransformedParameter(0, "scale", Prior(0.85, 1.4, 1.0, "log", "-", "a test"))
    assert tight.value(-tight.bound) < 1 / 29 and tight.value(tight.bound) > 29
    assert TransformedParameter(0, "gap", Prior(3e-5, 5e-3, 4e-4, "log", "rad", "a test")).bound == 8.0


def test_what_a_step_brings_is_foretold():
    """Of a linear problem it is what the objective falls to its least, found by another method."""
    rng = np.random.default_rng(8)
    residual, jacobian, others = rng.normal(size=30) + 5.0, rng.normal(size=(30, 2)), rng.normal(size=(30, 1))
    projection = Projection(others, np.array([0.3]))
    parameters = [
        TransformedParameter(0, name, Prior(-1.96, 1.96, 0.0, "linear", "m", "a test")) for name in "ab"
    ]

    def at(z):
        left = residual + jacobian @ z
        rest = projection.project(left)
        cost = float(rest @ rest)
        return SimpleNamespace(
            z=z, parameters=parameters, residual=left, jacobian=jacobian, projection=projection, cost=cost
        )

    start = at(np.array([2.0, -1.0]))
    least = minimize(lambda z: objective(at(z)), start.z, tol=1e-12).fun
    assert predicted_decrease(start) == pytest.approx(
        objective(start) - least, rel=0.02
    )  # priors bend a little


def test_a_part_of_a_step_moves_all_that_part_of_the_way(first):
    fit, about = linearised(*first)
    k = about.nuisance.keys.index(MODULUS)
    [parameter] = fit.parameters
    whole, part = (gauss_newton_step(fit, about, part=each)[1] for each in (1.0, 0.3))
    moduli = [there.at[k] - about.at[k] for there in (whole, part)]
    scales = [parameter.z(there.members[0].effect.scale) - fit.z[0] for there in (whole, part)]
    assert abs(moduli[0]) > 0.1 * about.nuisance.sigma[k]
    assert moduli[1] == pytest.approx(0.3 * moduli[0], rel=1e-6)
    assert scales[1] == pytest.approx(0.3 * scales[0], rel=1e-6)
