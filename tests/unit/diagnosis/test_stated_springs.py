"""A spring that the model states may be far off, and rather near it than where catalogues have most."""

from pathlib import Path

import numpy as np
import pytest
from arms import crane, smooth_step
from planted import run_of

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.problem import Problem
from flexarm.effects import JointCompliance

EXAMPLE = Path(__file__).parents[3] / "examples" / "three_joints.toml"


STATED = JointCompliance(at="hinge", stiffness=3e5, damping=600.0)
"""Stiffer than what is typical where a model states nothing."""


def springs_at_the_hinge():
    """Candidates of a model with `STATED`, and the model."""
    run = run_of("one joint")
    arm = run.simulation.arm.with_effect(STATED)
    problem = Problem(arm, {"run": run.showing({}, 1).record})
    return [c for c in candidates(problem, arm, softer=STATED.softer) if c.name == STATED.name], arm


def test_it_is_probed_a_little_softer_and_so_soft_that_it_moves_a_mode():
    found = [probe for each in springs_at_the_hinge()[0] for probe in each.probes]
    times = np.array(STATED.softer)
    assert [each.stiffness for each in found] == pytest.approx(3e5 / STATED.least_softer / times)
    assert [each.damping for each in found] == pytest.approx(600.0 / times)


def test_what_it_may_be_is_about_what_is_stated():
    found, arm = springs_at_the_hinge()
    for each in found:
        prior = each.priors_in(arm)["stiffness"]
        assert (prior.low, prior.typical, prior.high) == (6e4, 3e5, 1.5e6)
        assert prior.unit == "N m/rad"


def test_a_joint_that_is_rigid_in_the_model_has_what_machines_have():
    assert JointCompliance(at="hinge", damping=1.0).stated_priors(crane()) == {}


def test_a_shoulder_a_thirtieth_as_stiff_as_stated_is_found_in_three_joints():
    """The tip hangs 0.3 m low. By small steps alone an eccentric encoder of 0.1 rad was named, at 0.98."""
    stated = flexarm.Arm.from_toml(EXAMPLE)
    soft = stated.with_effect(JointCompliance(at="shoulder", stiffness=6e3, damping=60.0))
    t = np.arange(0, 8, 0.02)
    angles = {
        "waist": 0.8 * smooth_step((t - 0.5) / 4),
        "shoulder": 0.5 + 0.6 * smooth_step((t - 1) / 3),
        "elbow": 0.9 - 0.7 * smooth_step((t - 2) / 4),
    }
    run = flexarm.simulate(soft, flexarm.Drive.from_samples(t, angles), step=0.004, rotations=True)
    seen = [
        *(Sensor(name=n, quantity="joint_angle", joint=n, rate_hz=50, noise_std=1e-5) for n in angles),
        Sensor(name="tip", quantity="position", point="tip", rate_hz=10, noise_std=5e-5),
        Sensor(name="level", quantity="inclination", point="tip", axes=["z"], rate_hz=50, noise_std=1e-4),
        Sensor(
            name="torque", quantity="motor_torque", joint="elbow", side="output", rate_hz=200, noise_std=0.5
        ),
    ]
    record = flexarm.measure(run, seen, np.random.default_rng(7), drive=list(angles))
    found = flexarm.diagnose(stated, {"run": record}, n_jobs=1, step=0.004)
    [spring] = found.effects
    assert (found.verdict, spring.name, spring.at) == ("effects", "joint_compliance", "shoulder")
    assert spring.parameters[0].value == pytest.approx(6e3, rel=2e-3)
