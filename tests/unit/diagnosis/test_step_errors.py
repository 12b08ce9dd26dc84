"""Teeth that bounce part the motions of two time steps, and what that leaves of the right model is no gap."""

import numpy as np
import pytest
from arms import LENGTH, PAYLOAD, TUBE, beam, crane, hinge, point, smooth_step, tracker

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.diagnosis.evidence import above_noise, simulation_errors
from flexarm.diagnosis.noise_model import allow_for_discretisation_error, discretisation_remarks
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.residual_rows import is_non_smooth
from flexarm.effects import Backlash, JointCompliance

TRACKER = 1e-4
T = np.arange(0, 20, 0.01)
ANGLE = 0.1 * (np.sin(0.942 * T) + 0.5 * np.sin(2.23 * T)) * smooth_step(T / 3)


@pytest.fixture(scope="module")
def arm():
    """A beam that turns about the vertical: no weight holds teeth on a flank, and hardly a damper does."""
    return crane(
        effects=[],
        joints=[hinge("hinge", "rod", axis=[0, 0, 1], gear_ratio=120)],
        links=[beam("rod", [LENGTH, 0, 0], TUBE, elements=2, damping_ratio=0.002)],
        payloads=[{"name": "load", "link": "rod", "position": [LENGTH, 0, 0], "mass": PAYLOAD}],
        points=[point("tip", "rod", [LENGTH, 0, 0])],
    ).with_effect(JointCompliance(at="hinge", stiffness=2e5, damping=5.0))


def problem(arm):
    """The tip in a run of a sixteenth of the steps that it is compared with."""
    run = flexarm.simulate(arm, flexarm.Drive.from_samples(T, {"hinge": ANGLE}), step=2.5e-4)
    encoder = Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=100)
    sensors = [encoder, tracker("tip", noise=TRACKER)]
    record = flexarm.measure(run, sensors, np.random.default_rng(5), drive=["hinge"])
    return Problem(arm, {"run": record}, step=4e-3)


def most(there, arm):
    """Above the noise, in the channel where that is most."""
    left = there.residual(arm) + there.correction(arm)
    return max(above_noise(left, there, is_non_smooth(arm)).values())


def test_what_no_step_is_fine_enough_for_is_no_gap(arm):
    bouncing = arm.with_effect(Backlash(at="hinge", gap=1e-3))
    there = problem(bouncing)
    assert most(there, bouncing) > 1.0
    allow_for_discretisation_error(there, bouncing)
    assert most(there, bouncing) < 1.0
    [said] = discretisation_remarks(there)
    assert said.startswith("no time step is fine enough for what bounces: half of it moves tip by ")
    assert simulation_errors(there, non_smooth=True).max() > 1.0


def test_a_gap_stays_a_gap_beside_what_bounces(arm):
    """A joint ten times as soft misses by more than the motion of the teeth depends on the step."""
    bouncing = arm.with_effect(Backlash(at="hinge", gap=1e-3))
    there = problem(bouncing)
    allow_for_discretisation_error(there, bouncing)
    softer = arm.with_effect(JointCompliance(at="hinge", stiffness=2e4, damping=5.0))
    assert most(there, softer) > 1.0


def test_what_bounces_says_nothing_of_a_model_without_corners(arm):
    """However much a wrong backlash bounces, a gap that is half as large stays one beside springs alone."""
    bouncing = arm.with_effect(Backlash(at="hinge", gap=1e-3))
    there = problem(bouncing)
    before = above_noise(there.residual(arm), there)
    allow_for_discretisation_error(there, bouncing)
    assert above_noise(there.residual(arm), there) == before
    assert above_noise(there.residual(arm), there, non_smooth=True) != before
    assert set(simulation_errors(there, non_smooth=False)) == {SelectionPolicy.discrepancy}


def test_laws_without_corners_and_those_that_lie_on_a_flank_are_as_exact_as_ever(arm):
    """A hinge whose teeth weight holds hits nothing; a gap of a nanometre moves nothing."""
    for model in (arm, arm.with_effect(Backlash(at="hinge", gap=1e-9))):
        there = problem(model)
        allow_for_discretisation_error(there, model)
        assert all(each.discretisation_error == 0.0 for each in there.rows)
        assert discretisation_remarks(there) == []
        assert set(simulation_errors(there, non_smooth=True)) == {SelectionPolicy.discrepancy}


def test_more_noise_makes_less_of_it(arm):
    bouncing = arm.with_effect(Backlash(at="hinge", gap=1e-3))
    there = problem(bouncing)
    allow_for_discretisation_error(there, bouncing)
    noisier = there.with_noise(np.full(len(there.rows), 2.0))
    assert [row.discretisation_error for row in noisier.rows] == pytest.approx(
        [row.discretisation_error / 4 for row in there.rows]
    )
