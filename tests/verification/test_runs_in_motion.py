"""Runs that begin in motion: a pendulum, a four-bar and a turning beam against first integrals."""

from __future__ import annotations

from dataclasses import replace

import loops
import numpy as np
import pytest
from arms import G, arm, drive, rigid
from pytest import approx
from scipy.special import ellipj

import flexarm
from flexarm.arm.parameter import parameters, with_value
from flexarm.errors import InvalidParameter

HINGE = {"name": "q", "type": "revolute", "parent": "base", "child": "bob", "axis": [0, -1, 0]}


def thrown(
    model: flexarm.Arm, joint: str, angle: float, rate: float, end: float, step: float, **more
) -> flexarm.Simulation:
    """The model let go at an angle of a joint with a rate, without torque."""
    free = drive({joint: np.zeros_like}, end, 11, side="torque")
    told = flexarm.Drive(free.joints, {joint: angle}, 0.0, end, rates={joint: rate})
    return flexarm.simulate(model, told, step=step, alpha=0.0, **more)


@pytest.mark.parametrize("dimension", ["plane", "space"])
def test_a_pendulum_thrown_from_below_swings_as_an_elliptic_function(dimension):
    """sin(q/2) = k sn(w t, k), w = sqrt(g/l), k = rate/(2 w): of second order from the first step on."""
    pendulum = arm(joints=[HINGE], links=[rigid("bob", 1.0, (0, 0, -0.7))])
    rate, w = 5.0, np.sqrt(G / 0.7)
    error = []
    for step in (4e-3, 2e-3):
        run = thrown(pendulum, "q", 0.0, rate, 2.0, step, dimension=dimension)
        k = rate / (2 * w)
        exact = 2 * np.arcsin(k * ellipj(w * run.time, k**2)[0])
        error.append(np.abs(run.joint_angle[:, 0] - exact).max())
    assert run.joint_rate[0, 0] == approx(rate, rel=1e-12)
    assert error[1] < 1e-4
    assert error[0] / error[1] == approx(4, rel=0.05)


RATE, ANGLE = 6.0, 0.9
MASSES = {"crank": 2.0, "coupler": 3.0, "rocker": 4.0}


def four_bar_angles(crank: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles of coupler and rocker; analytic in that of the crank."""
    x, z = loops.GROUND - loops.CRANK * np.cos(crank), -loops.CRANK * np.sin(crank)
    span = np.sqrt(x**2 + z**2)
    at_b = np.arccos((span**2 + loops.COUPLER**2 - loops.ROCKER**2) / (2 * span * loops.COUPLER))
    coupler = np.arctan(z / x) + at_b
    c_x = loops.CRANK * np.cos(crank) + loops.COUPLER * np.cos(coupler) - loops.GROUND
    rocker = np.arccos(c_x / loops.ROCKER)
    return coupler, rocker


def inertia_and_height(crank: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """J of T = J q'^2/2, and the potential energy."""
    step = 1e-30j
    by_crank = [np.imag(angle) / 1e-30 for angle in four_bar_angles(crank + step)]
    coupler, rocker = (np.real(angle) for angle in four_bar_angles(crank + 0j))
    m1, m2, m3 = MASSES.values()
    a, b, c = loops.CRANK, loops.COUPLER, loops.ROCKER
    J = (m1 * a**2 / 3 + m2 * a**2) + m2 * b**2 / 3 * by_crank[0] ** 2 + m3 * c**2 / 3 * by_crank[1] ** 2
    J = J + m2 * a * b * np.cos(crank - coupler) * by_crank[0]
    V = G * (m1 * a / 2 * np.sin(crank) + m2 * (a * np.sin(crank) + b / 2 * np.sin(coupler)))
    return J, V + G * m3 * c / 2 * np.sin(rocker)


@pytest.mark.parametrize("cut", ["B", "C", "D"])
def test_a_four_bar_turns_at_the_rate_that_its_energy_leaves(cut):
    """q' = sqrt(2 (E - V)/J) over more than a turn, wherever the loop is cut."""
    model = loops.four_bar(cut, assembly=loops.assembled(cut, ANGLE))
    error = []
    for step in (1e-3, 5e-4):
        run = thrown(model, "A", ANGLE, RATE, 1.2, step)
        J, V = inertia_and_height(run.joint_angle[:, 0])
        E = 0.5 * J[0] * RATE**2 + V[0]
        error.append(np.abs(run.joint_rate[:, 0] - np.sqrt(2 * (E - V) / J)).max() / RATE)
    assert np.ptp(run.joint_angle[:, 0]) > 2 * np.pi
    assert error[1] < 6e-4
    assert error[0] / error[1] == approx(4, rel=0.05)


def test_joints_that_follow_begin_with_the_rates_of_the_loop():
    run = thrown(loops.four_bar("C", assembly=loops.assembled("C", ANGLE)), "A", ANGLE, RATE, 0.1, 1e-3)
    coupler, rocker = (np.imag(angle) / 1e-30 * RATE for angle in four_bar_angles(np.array(ANGLE + 1e-30j)))
    assert run.joint_rate[0] == approx([RATE, coupler - RATE, rocker], rel=1e-9)


def test_a_flexible_crank_keeps_its_energy_from_the_start():
    """The crank bends as at rest: its strain energy hardly changes with the first steps."""
    crank = lambda name, length, mass: loops.beam(name, length, 2)  # noqa: E731
    model = loops.four_bar("C", crank, assembly=loops.assembled("C", ANGLE))
    run = thrown(model, "A", ANGLE, RATE, 0.4, 2.5e-4, energies=True)
    total = run.kinetic + run.elastic + run.gravity
    assert np.abs(total - total[0]).max() < 1e-3 * np.ptp(run.kinetic)


def test_a_beam_that_a_drive_turns_steadily_does_not_ring_from_the_start():
    """Begun at rest, the same drive makes its tip ring by a thousand times as much."""
    beam = loops.beam("bob", 1.0)
    model = arm(joints=[HINGE], links=[beam], points=[{"name": "tip", "link": "bob", "position": [1, 0, 0]}])
    model = model.replace(gravity=(0.0, 0.0, 0.0))
    turn = drive({"q": lambda t: 2.0 * t}, 1.0, 11)
    off = []
    for told in (turn, replace(turn, rates={})):
        run = flexarm.simulate(model, told, step=1e-3)
        across = np.stack([-np.sin(2 * run.time), 0 * run.time, np.cos(2 * run.time)], axis=1)
        off.append(np.abs(np.sum(run.position[:, 0] * across, axis=1)).max())
    assert off[1] < 1e-3 * off[0]


def test_derivatives_of_runs_in_motion_are_those_of_differences():
    """By a mass and a length of a four-bar, and in the plane by a mass that bends a beam."""
    loop = loops.four_bar("C", assembly=loops.assembled("C", ANGLE))
    beam = arm(
        joints=[HINGE],
        links=[loops.beam("bob", 1.0, 2)],
        payloads=[{"name": "load", "link": "bob", "position": [1, 0, 0], "mass": 0.5}],
    )
    for model, joint, key in (
        (loop, "A", "links.rocker.mass"),
        (loop, "A", "closures.C.b_origin.xyz.x"),
        (beam, "q", "payloads.load.mass"),
    ):
        value, h = parameters(model, [key])[0].value, 1e-4
        run, plus, minus = (
            thrown(with_value(model, key, value + e), joint, ANGLE, RATE, 0.2, 2e-3, **more)
            for e, more in ((0, {"sensitivities": [key]}), (h, {}), (-h, {}))
        )
        for name in ("joint_angle", "joint_rate"):
            expected = (getattr(plus, name) - getattr(minus, name)) / (2 * h)
            slope = run.sensitivities[name][..., 0]
            assert np.abs(expected).max() > 1e-3
            assert slope == approx(expected, abs=2e-5 * np.abs(expected).max()), (key, name)


def test_a_rate_belongs_to_a_joint_that_a_torque_drives():
    model = arm(joints=[HINGE], links=[rigid("bob", 1.0, (0, 0, -0.7))])
    told = replace(drive({"q": np.zeros_like}, 1.0, 11), rates={"q": 1.0})
    with pytest.raises(InvalidParameter, match="no torque drives 'q', which begins as its drive does"):
        flexarm.simulate(model, told)
    with pytest.raises(InvalidParameter, match="must be finite"):
        thrown(model, "q", 0.0, np.inf, 1.0, 1e-2)
