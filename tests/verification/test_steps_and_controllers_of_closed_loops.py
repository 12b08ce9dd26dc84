"""Closed loops under a `Stepper` and under controllers: as runs, and as the same loop cut elsewhere."""

from __future__ import annotations

import loops
import numpy as np
import pytest
from arms import drive, smooth_step
from pytest import approx

import flexarm
from flexarm import Drive, Stepper
from flexarm.errors import InvalidParameter

START = 0.9
CASCADE = {
    "type": "cascade",
    "joint": "A",
    "position_gain": 5.0,
    "velocity_gain": 60.0,
    "integral_time": 0.3,
    "sample_time": 4e-3,
}


def four_bar(cut: str, make=loops.bar, **more) -> flexarm.Arm:
    return loops.four_bar(cut, make, assembly=loops.assembled(cut, START), **more)


def beam(name: str, length: float, mass: float) -> dict:
    return loops.beam(name, length, 2)


@pytest.mark.parametrize("make", [loops.bar, beam])
def test_steps_under_a_torque_are_those_of_a_run(make):
    """Both iterate accelerations to 1e-5 of the reach; a held torque is that of small steps."""
    arm, push = four_bar("C", make), lambda t: 30 * np.sin(8 * t) * smooth_step(5 * t)
    sim = Stepper(arm, {"A": "torque"}, step=1e-3)
    state = sim.start(joints={"A": START})
    holding = sim.joint(state, "A").motor_torque
    angle = [sim.joint(state, "A").angle]
    for k in range(500):
        state = sim.step(state, {"A": holding + push((k + 1) * 1e-3)})
        angle.append(sim.joint(state, "A").angle)
    moved = drive({"A": lambda t: holding + push(t)}, 0.5, 2001, side="torque")
    run = flexarm.simulate(arm, moved, step=1e-3)
    assert np.ptp(angle) > 0.1
    assert np.array(angle) == approx(run.joint_angle[:, 0], abs=1e-3 * np.ptp(angle))


def test_a_stepped_piston_lifts_the_crane_as_a_run_does():
    """Angles told at steps follow their smooth curve; the boom follows in its loop."""
    arm = loops.crane(loops.beam("boom", 3.0, side=0.15))
    sim = Stepper(arm, {"piston": "motor"}, step=1e-3)
    state = sim.start(joints={"piston": 0.3})
    for k in range(400):
        state = sim.step(state, {"piston": 0.3 + 0.1 * smooth_step((k + 1) * 2.5e-3)})
    run = flexarm.simulate(
        arm, drive({"piston": lambda t: 0.3 + 0.1 * smooth_step(2.5 * t)}, 0.4, 401), step=1e-3
    )
    assert sim.point(state, "tip").position == approx(run.position[-1, 0], abs=1e-4)
    assert sim.joint(state, "boom_pin").angle == approx(run.joint_angle[-1, 0], abs=1e-4)


def test_a_stepper_says_which_joints_follow():
    """A joint that follows stands where its loop puts it."""
    sim = Stepper(loops.crane(), {"piston": "motor"})
    with pytest.raises(InvalidParameter, match=r"boom_pin: follows in its loop, with boom_pin, cylinder_pin"):
        sim.start(joints={"piston": 0.3, "boom_pin": 0.1})


def test_a_controlled_crank_moves_alike_however_its_loop_is_cut():
    """The controller sees the crank alone; the equations are the same: 1e-5 of the move."""
    t = np.arange(0, 1.0001, 4e-3)
    command = Drive.from_samples(t, {"A": START + 0.4 * smooth_step(2 * t)}, side="command")
    runs = [
        flexarm.simulate(four_bar(cut, controllers=[CASCADE]), command, step=1e-3).joint_angle[:, 0]
        for cut in "BCD"
    ]
    assert np.ptp(runs[2]) > 0.2
    for other in runs[:2]:
        assert other == approx(runs[2], abs=1e-5)


def test_a_controlled_piston_holds_the_crane_where_it_stands():
    """The controller starts with the torque of the equilibrium."""
    controller = {**CASCADE, "joint": "piston", "velocity_gain": 1e4}
    arm = flexarm.Arm.from_dict({**loops.crane().to_dict(), "controllers": [controller]})
    t = np.arange(0, 0.2, 4e-3)
    run = flexarm.simulate(arm, Drive.from_samples(t, {"piston": np.full(len(t), 0.4)}, side="command"))
    assert run.position[-1] == approx(flexarm.static(arm, {"piston": 0.4}).position, abs=1e-7)
