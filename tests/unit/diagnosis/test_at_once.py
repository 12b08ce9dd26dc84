"""Simulations at once are what they are one after the other."""

import pytest
from planted import run_of

from flexarm.diagnosis.problem import Problem
from flexarm.effects import JointCompliance, PayloadMass
from flexarm.errors import NotConverged
from flexarm.threads import at_once


@pytest.mark.parametrize("jobs", [1, 2, 5])
def test_results_keep_the_order_of_what_was_given(jobs):
    assert at_once(lambda x: x**2, range(7), jobs) == [0, 1, 4, 9, 16, 25, 36]
    assert at_once(str, (), jobs) == []


@pytest.mark.parametrize("jobs", [1, 3])
def test_an_error_is_that_of_the_first_that_failed(jobs):
    with pytest.raises(ZeroDivisionError):
        at_once(lambda x: 1 / x, [2, 0, 1], jobs)


def test_residuals_do_not_depend_on_the_number_of_jobs():
    run = run_of("one joint")
    records = {name: run.showing({}, seed).record for name, seed in (("a", 1), ("b", 2))}
    arm = run.simulation.arm
    one, two = (Problem(arm, records, step=4e-3, jobs=jobs).residual(arm) for jobs in (1, 2))
    assert (one == two).all()


def test_models_prepared_at_once_are_what_they_are_alone():
    """All of them but one that cannot be simulated, which is an error of its own where it is asked for."""
    run = run_of("one joint")
    records = {name: run.showing({}, seed).record for name, seed in (("a", 1), ("b", 2))}
    arm = run.simulation.arm
    [load] = arm.payloads
    masses = [PayloadMass(at=load.name, mass=part * load.mass) for part in (0.9, 1.0, 1.1)]
    soft = JointCompliance(at="hinge", stiffness=1e-3, damping=1e-6)  # hangs far down
    models = [arm.with_effect(each) for each in (*masses, soft)]
    one, two = (Problem(arm, records, step=4e-3, jobs=jobs) for jobs in (1, 2))
    two.prepare(models)
    made = two.simulations.made
    for model in models[:3]:
        assert (two.residual(model) == one.residual(model)).all()
    assert two.simulations.made == made
    with pytest.raises(NotConverged):
        two.residual(models[3])
