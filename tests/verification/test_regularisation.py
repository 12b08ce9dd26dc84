"""Small widths that make laws solvable move no tip that a tracker could see, and cost no time step."""

from functools import partial

import numpy as np
import pytest
from arms import drive, paper_arm, smooth_step

import flexarm
from flexarm import _core
from flexarm.effects import Backlash, CoulombFriction, JointCompliance, JointHysteresis, MotorFriction

TRACKER = 5e-5
"""Accuracy of the tracker [m]."""
SPRING = _core.ReducerSpring


def rough(**shape: float) -> flexarm.Arm:
    """The paper's arm with backlash, friction on both sides and hysteresis in its reducer."""
    model = paper_arm(2, damping_ratio=0.01)
    return model.replace(
        effects=(
            JointCompliance(at="hinge", stiffness=1.5e5, damping=300.0),
            JointHysteresis(at="hinge", torque=30.0, width=3e-4),
            Backlash(at="hinge", gap=4e-4),
            CoulombFriction(at="hinge", torque=15.0, **shape),
            MotorFriction(at="hinge", coulomb=20.0, viscous=5.0, **shape),
        )
    )


def swung(period: float = 5.0, **shape: float) -> flexarm.Simulation:
    """Three times through the vertical, where the torque changes sign."""
    turn = drive(
        {"hinge": lambda t: 0.6 * np.sin(2 * np.pi * t / period) * smooth_step(t / 2)}, 2 * period, 2001
    )
    return flexarm.simulate(rough(**shape), turn, step=2e-3)


@pytest.fixture(scope="module")
def usual():
    return swung()


def test_backlash_friction_and_hysteresis_cost_no_smaller_steps(usual):
    """At 2 ms: no halving, and on average fewer than five iterations a step."""
    assert usual.solver["halvings"] == 0
    assert usual.solver["iterations"] / usual.solver["steps"] < 5


@pytest.mark.parametrize("width", [3e-4, 2e-5, 1e-6, 1e-7])
@pytest.mark.parametrize("torque", [30.0, 300.0, 2000.0])
def test_however_sharply_hysteresis_turns_no_step_is_halved(torque, width):
    """Corrections of a step follow the law itself: corners far narrower than a step take no iterations."""
    model = paper_arm(2, damping_ratio=0.01).replace(
        effects=(
            JointCompliance(at="hinge", stiffness=1.5e5, damping=300.0),
            JointHysteresis(at="hinge", torque=torque, width=width),
        )
    )
    swing = drive({"hinge": lambda t: 0.6 * np.sin(2 * np.pi * t / 5) * smooth_step(t / 2)}, 10.0, 2001)
    counts = flexarm.simulate(model, swing, step=4e-3).solver
    assert counts["halvings"] == 0
    assert counts["iterations"] < 2.2 * counts["steps"]
    assert counts["factorisations"] <= 5


@pytest.mark.parametrize("factor", [0.5, 2.0])
@pytest.mark.parametrize(
    ("width", "value"), [("fade_width", 2e-5), ("loose_stiffness", 1e-4), ("loose_damping", 1e-2)]
)
def test_what_is_left_in_the_gap_does_not_matter(usual, monkeypatch, width, value, factor):
    """Half or twice of it moves the tip by less than a quarter of what the tracker sees."""
    monkeypatch.setattr(_core, "ReducerSpring", partial(SPRING, **{width: value * factor}))
    moved = np.abs(swung().position - usual.position).max()
    assert 0 < moved < 0.25 * TRACKER


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_the_width_of_stiction_does_not_matter(usual, factor):
    """Twice of 2e-5 rad moves the tip by what a tracker sees at instants, and by half of it in the mean."""
    moved = np.linalg.norm(swung(width=2e-5 * factor).position - usual.position, axis=-1)
    assert 0 < moved.max() < 1.2 * TRACKER
    assert np.sqrt(np.mean(moved**2)) < 0.5 * TRACKER


def test_a_tooth_that_knocks_about_in_its_gap_gains_no_energy():
    """A plumb arm is set swinging within its gap and knocks at both flanks; its energy only falls.

    Steps of 2 ms, and a hundredth of the push for what a step gains or loses where the stiffness jumps.
    """
    model = paper_arm(2, damping_ratio=0.01).replace(
        effects=(
            JointCompliance(at="hinge", stiffness=1.5e5, damping=300.0),
            Backlash(at="hinge", gap=4e-4),
        )
    )
    push = {"hinge": lambda t: np.pi + 5e-3 * smooth_step(t / 0.3) * smooth_step((0.9 - t) / 0.3)}
    run = flexarm.simulate(model, drive(push, 20.0, 8001), step=2e-3)
    free = run.time > 0.95
    energy = (run.kinetic + run.elastic + run.gravity)[free]
    energy -= flexarm.simulate(model, drive({"hinge": lambda t: np.pi + 0 * t}, 0.1), step=0.05).gravity[0]
    d = (run.drive_angle - run.joint_angle)[free, 0]
    assert np.count_nonzero(np.diff(np.sign(d))) > 10
    assert np.max(np.maximum.accumulate(energy[::-1])[::-1] - energy) < 0.01 * energy[0]
    assert energy[-1] < 0.3 * energy[0]
    assert run.solver["halvings"] < 0.01 * run.solver["steps"]
