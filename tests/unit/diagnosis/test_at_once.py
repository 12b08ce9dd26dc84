"""Simulations at once are what they are one after the other."""

from functools import reduce

import numpy as np
import pytest
from arms import drive, smooth_step
from planted import NOISE, one_joint, run_of

import flexarm
from flexarm import _core
from flexarm.diagnosis.problem import Problem
from flexarm.effects import (
    GearRatio,
    JointCompliance,
    JointTiltCompliance,
    LinkLength,
    LinkStiffness,
    PayloadMass,
    ReflectorOffset,
    TransmissionError,
)
from flexarm.errors import NotConverged
from flexarm.measurement import predict
from flexarm.record import Record, Signal
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
        assert np.abs(two.residual(model) - one.residual(model)).max() < 1e-4  # sigmas: iterations end there
    assert two.simulations.made == made
    with pytest.raises(NotConverged):
        two.residual(models[3])


def moved_to_rest(seconds=4.0):
    """A record of a hinge that turns and stops, seen at the tip."""
    time = np.arange(0.0, seconds, 0.02)
    angle = 0.6 * smooth_step(time / 2.0)
    encoder = Signal(
        name="encoder",
        quantity="joint_angle",
        joint="hinge",
        side="motor",
        time=time,
        values=angle,
        noise_std=0.0,
    )
    run = flexarm.simulate(one_joint(), drive({"hinge": lambda t: 0.6 * smooth_step(t / 2.0)}, seconds))
    values, noise = np.zeros((len(time), 2)), NOISE["position"]
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        axes=("x", "z"),
        time=time,
        values=values,
        noise_std=noise,
    )
    return Record(signals=[encoder, tip.replace(values=predict(run, tip))], drive=("encoder",))


@pytest.mark.skipif(_core.lanes() == 0, reason="this processor takes no arms side by side")
@pytest.mark.parametrize(
    "effects",
    [
        (),
        (LinkLength(at="rod", error=0.006),),
        (TransmissionError(at="hinge", amplitude=2e-4, multiple=2), GearRatio(at="hinge", scale=1.01)),
        (JointTiltCompliance(at="hinge", stiffness=2e5),),
    ],
)
def test_models_side_by_side_move_as_each_does_alone(effects, monkeypatch):
    """Also with a reflector off its place; none of them is simulated alone."""
    arm = reduce(flexarm.Arm.with_effect, effects, one_joint())
    off = ReflectorOffset(at="tip", offset=(0.001, -0.002, -0.003))
    models = [arm, *(arm.with_effect(LinkStiffness(at="rod", scale=part)) for part in (0.9, 1.1))]
    models += [each.with_effect(off) for each in models]
    alone, beside = (Problem(one_joint(), {"run": moved_to_rest()}, step=4e-3) for _ in range(2))
    with monkeypatch.context() as patched:
        patched.setattr(beside.simulations, "_made", lambda *given: pytest.fail("one was simulated alone"))
        beside.prepare(models)
    for model in models:
        wrong = NOISE["position"] * np.abs(beside.residual(model) - alone.residual(model)).max()
        assert wrong < 1e-12
    moves = NOISE["position"] * np.abs(alone.residual(models[3]) - alone.residual(models[0])).max()
    assert moves > 2e-3
