"""Play of pins: at rest, about the contact, and against an integration of three bodies."""

from __future__ import annotations

import loops
import numpy as np
import pytest
from arms import G, arm, drive, rigid, smooth_step
from pytest import approx
from scipy.integrate import solve_ivp
from scipy.optimize import root

import flexarm
from flexarm.arm.parameter import with_value
from flexarm.effects.joint_radial_clearance import JointRadialClearance
from flexarm.effects.joint_radial_compliance import JointRadialCompliance
from flexarm.errors import InvalidParameter

LEFT = 1e-4
"""Part of the stiffness that is left in the play."""


def with_play(
    model: flexarm.Arm, at: str, clearance: float, stiffness: float, damping: float = 0.0
) -> flexarm.Arm:
    model = model.with_effect(JointRadialCompliance(at=at, stiffness=stiffness, damping=damping))
    return model.with_effect(JointRadialClearance(at=at, clearance=clearance))


def bob(clearance: float, stiffness: float, **more) -> flexarm.Arm:
    """A mass of 20 kg at the pin of a joint about y, whose play lets it hang and swing."""
    hinge = {"name": "q", "type": "revolute", "parent": "base", "child": "bob", "axis": [0, 1, 0]}
    point = {"name": "tip", "link": "bob", "position": [0, 0, 0]}
    model = arm(
        joints=[hinge], links=[rigid("bob", 20.0, (0, 0, 0), (0.1, 0.1, 0.1))], points=[point], **more
    )
    return with_play(model, "q", clearance, stiffness)


@pytest.mark.parametrize("tilt", [0.0, 0.6])
def test_a_body_hangs_in_its_clearance(tilt):
    """By c_r + W/k along its weight, less the part of c_r that the rest of stiffness takes."""
    pull = G * np.array([np.sin(tilt), 0, -np.cos(tilt)])
    found = flexarm.static(bob(2e-4, 1e6, gravity=list(pull)))
    assert found.position[0] == approx(((1 - LEFT) * 2e-4 + 20 * G / 1e6) * pull / G, rel=1e-9, abs=1e-15)


def test_a_body_in_its_clearance_swings_as_a_pendulum_of_its_radius_and_bounces_on_its_contact():
    """omega^2 = g/e around the hole, k/m across the contact."""
    clearance, k = 2e-3, 1e6
    e = (1 - LEFT) * clearance + 20 * G / k
    found = flexarm.modes(bob(clearance, k), count=2).frequency_hz
    assert found == approx(np.sqrt([G / e, k / 20]) / (2 * np.pi), rel=1e-9)


def test_without_clearance_the_pin_is_a_compliant_one():
    for model in (bob(0.0, 1e6), bob(0.0, 1e6).without_effect("joint_radial_clearance", "q")):
        assert flexarm.modes(model, count=2).frequency_hz == approx(np.sqrt(1e6 / 20) / (2 * np.pi), rel=1e-9)


def test_the_eye_of_a_crane_lies_in_its_hole_along_the_force_of_the_closure():
    """The pin's place on b is off that on a by c_r + |F|/k against the force on b."""
    clearance, k = 4e-4, 5e7
    eyes = [
        {"name": "on_a", "link": "rod", "position": [0, 0, 0.9]},
        {"name": "on_b", "link": "boom", "position": [1.2, 0, -0.15]},
    ]
    crane = flexarm.Arm.from_dict({**loops.crane().to_dict(), "points": eyes})
    found = flexarm.static(with_play(crane, "rod_eye", clearance, k), {"piston": 0.3})
    F = found.closure_force[0, :3]
    off = -((1 - LEFT) * clearance + np.linalg.norm(F) / k) * F / np.linalg.norm(F)
    assert np.linalg.norm(F) > 1e4
    assert found.position[1] - found.position[0] == approx(off, abs=1e-12)


START, CLEARANCE, CONTACT, LOSS = 0.9, 1e-3, 2e5, 400.0
STEPS = (1e-3, 5e-4)


def torque(t):
    """A torque that tears the crank to and fro [N m]."""
    return 100 * np.sin(15 * t) * smooth_step(5 * t)


class ThreeBodies:
    """Crank and coupler, and a rocker, between which only the contact in the hole of C acts.

    q are angles of crank, coupler and rocker against x; u is the rocker's end in the axes of the coupler.
    """

    lengths = np.array([loops.CRANK, loops.COUPLER, loops.ROCKER])
    masses = np.array([2.0, 3.0, 4.0])

    def mass(self, q):
        (a, b, _), (m1, m2, m3) = self.lengths, self.masses
        c = m2 * a * b / 2 * np.cos(q[0] - q[1])
        turned = [m1 * a**2 / 3 + m2 * a**2, m2 * b**2 / 3, m3 * self.lengths[2] ** 2 / 3]
        return np.diag(turned) + np.array([[0, c, 0], [c, 0, 0], [0, 0, 0]])

    def eccentricity(self, q):
        """u, and its derivative by q."""
        a, b, r = self.lengths[:, None] * np.stack([np.cos(q), np.sin(q)], axis=1)
        off = np.array([loops.GROUND, 0]) + r - a - b
        R = np.array([[np.cos(q[1]), np.sin(q[1])], [-np.sin(q[1]), np.cos(q[1])]])
        by_q = np.stack([-turn(a), -turn(b), turn(r)], axis=1)
        slope = R @ by_q
        slope[:, 1] -= turn(R @ off)
        return R @ off, slope

    def forces(self, q, v, push, clearance=CLEARANCE):
        (a, b, c), (m1, m2, m3) = self.lengths, self.masses
        s = m2 * a * b / 2 * np.sin(q[0] - q[1])
        weights = G * np.array([m1 * a / 2 + m2 * a, m2 * b / 2, m3 * c / 2]) * np.cos(q)
        u, slope = self.eccentricity(q)
        e = np.linalg.norm(u)
        inside = min(max(clearance - e, 0.0) / 2e-5, 1.0)  # 0 in contact, 1 where damping has faded
        fade = 1 - 0.99 * inside**2 * (3 - 2 * inside)
        pressed = CONTACT * (max(e - clearance, 0) + LEFT * min(e, clearance)) * u / e
        contact = pressed + LOSS * fade * (slope @ v)
        return np.array([push - s * v[1] ** 2, s * v[0] ** 2, 0]) - weights - slope.T @ contact

    def at_rest(self):
        """The crank held; the pin first in a hole without clearance, then at its rim."""
        closed = loops.assembled("C", START)
        guess = [closed["A"] + closed["B"] + 1e-6, closed["D"]]

        def solved(function, start):
            found = root(function, start, tol=1e-14)
            assert np.abs(function(found.x)).max() < 1e-8
            return found.x

        at = lambda x: np.array([START, *x])  # noqa: E731
        tight = solved(lambda x: self.forces(at(x), np.zeros(3), 0, 0.0)[1:], guess)
        u = self.eccentricity(at(tight))[0]
        rim = u * (1 + CLEARANCE / np.linalg.norm(u))
        pushed = solved(lambda x: self.eccentricity(at(x))[0] - rim, tight)
        return at(solved(lambda x: self.forces(at(x), np.zeros(3), 0)[1:], pushed))

    def run(self, time):
        """Angles at such times [rad]."""

        def change(t, y):
            q, v = y[:3], y[3:]
            return [*v, *np.linalg.solve(self.mass(q), self.forces(q, v, float(torque(np.array(t)))))]

        start = [*self.at_rest(), 0, 0, 0]
        return solve_ivp(change, (0, time[-1]), start, "Radau", time, rtol=1e-9, atol=1e-11).y[:3].T


def turn(x):
    """A quarter turn from x to z."""
    return np.array([-x[1], x[0]])


def played(step: float, **more) -> flexarm.Simulation:
    """The four-bar with a pin C that hammers in its hole."""
    model = loops.four_bar("C", assembly=loops.assembled("C", START))
    pushed = drive({"A": torque}, 0.5, 1001, side="torque")
    told = flexarm.Drive(pushed.joints, {"A": START}, 0.0, 0.5)
    return flexarm.simulate(
        with_play(model, "C", CLEARANCE, CONTACT, LOSS), told, step=step, alpha=0.0, **more
    )


def test_a_four_bar_with_a_loose_pin_moves_as_three_bodies_in_contact():
    """The pin leaves the wall of its hole and meets it again; of second order in the step."""
    bodies = ThreeBodies()
    expected = bodies.run(np.arange(1001) * 5e-4)
    off = np.array([np.linalg.norm(bodies.eccentricity(q)[0]) for q in expected])
    assert np.count_nonzero(np.diff((off < CLEARANCE).astype(int))) >= 4
    error = []
    for step in STEPS:
        angles = played(step).joint_angle[:, [0, 1, 2]]
        angles[:, 1] += angles[:, 0]
        error.append(np.abs(angles - expected[:: round(step / 5e-4)]).max())
    assert error[1] < 1.2e-5
    assert error[0] / error[1] == approx(4, rel=0.1)


def test_a_loose_pin_loses_energy_in_its_damping_only():
    run = played(5e-4, energies=True)
    assert run.damped[-1] > 0.05
    balance = run.kinetic + run.elastic + run.gravity + run.damped - run.work
    assert np.abs(balance - balance[0]).max() < 1e-3 * np.ptp(run.kinetic)


def test_a_loose_pin_of_an_arm_in_a_plane_moves_as_in_space():
    turned = drive({"q": lambda t: 0.5 * np.sin(9 * t)}, 0.5, 501)
    model = with_play(
        arm(
            joints=[{"name": "q", "type": "revolute", "parent": "base", "child": "rod", "axis": [0, 1, 0]}],
            links=[rigid("rod", 8.0, (0.4, 0, 0), (0.1, 0.4, 0.4))],
            points=[{"name": "tip", "link": "rod", "position": [0.8, 0, 0]}],
        ),
        "q",
        1e-3,
        2e5,
        300.0,
    )
    flat, full = (flexarm.simulate(model, turned, dimension=name) for name in ("plane", "space"))
    assert np.ptp(flat.position[:, 0, 1]) == 0
    assert flat.position == approx(full.position, abs=1e-9)


KEY = "effects.joint_radial_clearance.C.clearance"


def test_derivatives_by_a_clearance_are_those_of_differences():
    """At rest, and over the first contact of a motion; differences of 1 % err by 1e-4."""
    model = with_play(
        loops.four_bar("C", assembly=loops.assembled("C", START)), "C", CLEARANCE, CONTACT, LOSS
    )
    pushed = drive({"A": lambda t: START + 0.2 * smooth_step(4 * t)}, 0.3, 601)

    def found(clearance: float, **more) -> list:
        there = with_value(model, KEY, clearance)
        return [
            flexarm.static(there, {"A": START}, **more),
            flexarm.simulate(there, pushed, step=5e-4, **more),
        ]

    for at, plus, minus in zip(
        found(CLEARANCE, sensitivities=[KEY]), found(1.01 * CLEARANCE), found(0.99 * CLEARANCE), strict=True
    ):
        for name in ("position", "joint_torque"):
            expected = (getattr(plus, name) - getattr(minus, name)) / (0.02 * CLEARANCE)
            slope = at.sensitivities[name][..., 0]
            assert np.abs(expected).max() > 0
            assert slope == approx(expected, abs=2e-3 * np.abs(expected).max()), name


@pytest.mark.parametrize(
    ("effects", "said"),
    [
        ([], "needs a joint_radial_compliance with a stiffness at the same joint, and 'q' is rigid"),
        (
            [JointRadialCompliance(at="q", stiffness=(1e6, 2e6))],
            "one stiffness below 1e.12 N/m and one damping",
        ),
    ],
)
def test_a_clearance_needs_a_contact_that_is_alike_all_around(effects, said):
    model = bob(1e-4, 1e6).without_effect("joint_radial_clearance", "q")
    model = model.without_effect("joint_radial_compliance", "q")
    with pytest.raises(InvalidParameter, match=said):
        model.replace(effects=(*effects, JointRadialClearance(at="q", clearance=1e-4)))
