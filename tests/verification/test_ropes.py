"""Ropes whose length a drive changes, against the equations of a load on an elastic rope."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest
from arms import G, arm, drive, rigid, smooth_step
from pytest import approx
from scipy.integrate import solve_ivp

import flexarm
from flexarm.effects import OilColumn

MASS, OVER_DRUM, MODULUS, AREA, LOSS, SWING = 400.0, 1.5, 1e11, 2e-5, 3e3, 0.25
"""Load [kg], rope at a drive of 0 [m], its modulus [Pa], section [m2] and damping [N s/m], angle [rad]."""


def hoist() -> flexarm.Arm:
    """A load on a rope from a sheave: it swings about y, and `hoist` pays out rope."""
    swing = {"name": "swing", "type": "revolute", "parent": "base", "child": "rope", "axis": [0, -1, 0]}
    slide = {"name": "hoist", "type": "prismatic", "parent": "rope", "child": "hook", "axis": [0, 0, -1]}
    rope = OilColumn(
        at="hoist",
        bulk_modulus=MODULUS,
        piston_area=AREA,
        dead_volume=AREA * OVER_DRUM,
        stroke=20.0,
        damping=LOSS,
    )
    return arm(
        joints=[swing, {**slide, "origin": {"xyz": [0, 0, -OVER_DRUM]}}],
        links=[rigid("rope", 0.0, inertia=(0, 0, 0)), rigid("hook", MASS, inertia=(0, 0, 0))],
        points=[{"name": "hook", "link": "hook", "position": [0, 0, 0]}],
    ).with_effect(rope)


@pytest.mark.parametrize("paid_out", [0.0, 2.5, 10.0])
def test_a_rope_stretches_by_its_load_and_length_over_its_axial_stiffness(paid_out):
    """m g l/(E A), and the load bounces with E A/l."""
    length = OVER_DRUM + paid_out
    found = flexarm.static(hoist(), {"hoist": paid_out})
    assert -found.position[0, 2] - length == approx(MASS * G * length / (MODULUS * AREA), rel=1e-9)
    bounce = flexarm.modes(hoist(), {"hoist": paid_out}, count=1).frequency_hz[0]
    assert bounce == approx(sqrt(MODULUS * AREA / length / MASS) / (2 * pi), rel=1e-9)


def paid(t):
    """Rope paid out at a time [m]; hoisted from 4 to 1 m."""
    return 4.0 - 3.0 * smooth_step(t / 2.0)


def loaded(time: np.ndarray) -> np.ndarray:
    """Angle and rope beyond OVER_DRUM by m r'' = m r q'^2 + m g cos q - T, r q'' = -2 r' q' - g sin q."""

    def change(t, y):
        q, x, q_rate, x_rate = y
        h = 1e-5
        rate = float(paid(np.array(t + h)) - paid(np.array(t - h))) / (2 * h)
        r, out = OVER_DRUM + x, float(paid(np.array(t)))
        pull = MODULUS * AREA * (x - out) / (OVER_DRUM + out) + LOSS * (x_rate - rate)
        turn = -(2 * x_rate * q_rate + G * np.sin(q)) / r
        return [q_rate, x_rate, turn, r * q_rate**2 + G * np.cos(q) - pull / MASS]

    stretch = MASS * G * np.cos(SWING) * (OVER_DRUM + 4.0) / (MODULUS * AREA)
    start = [SWING, 4.0 + stretch, 0, 0]
    return (
        solve_ivp(change, (0, time[-1]), start, "DOP853", time, rtol=1e-9, atol=1e-11, max_step=5e-3).y[:2].T
    )


def test_a_load_that_is_hoisted_swings_and_bounces_as_its_equations_say():
    """Swings grow as the rope shortens; of second order in the step."""
    told = flexarm.Drive(
        {
            **drive({"hoist": paid}, 3.0, 1201).joints,
            **drive({"swing": np.zeros_like}, 3.0, 11, side="torque").joints,
        },
        {"swing": SWING, "hoist": 4.0},
        0.0,
        3.0,
    )
    expected = loaded(np.linspace(0, 3, 31))
    error = []
    for step in (4e-3, 2e-3):
        run = flexarm.simulate(hoist(), told, step=step, alpha=0.0)
        error.append(np.abs(run.joint_angle[:: round(0.1 / step)] - expected).max(axis=0))
    assert np.abs(expected[20:, 0]).max() > 1.2 * SWING
    assert np.all(error[1] < [5e-6, 1e-6])
    assert error[0] / error[1] == approx(4, rel=0.1)
