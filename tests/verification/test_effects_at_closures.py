"""Effects at revolute closures: against virtual work, the minimal equation, and the same pin as a joint."""

from __future__ import annotations

from math import pi

import loops
import numpy as np
import pytest
from arms import drive, smooth_step
from pytest import approx

import flexarm
from flexarm.effects.cable_torque import CableTorque
from flexarm.effects.coulomb_friction import CoulombFriction
from flexarm.effects.joint_compliance import JointCompliance
from flexarm.effects.joint_tilt_compliance import JointTiltCompliance
from flexarm.effects.lugre_friction import LugreFriction
from flexarm.effects.tabulated_law import TabulatedLaw
from flexarm.effects.viscous_friction import ViscousFriction
from flexarm.errors import InvalidParameter

START, END = 0.9, 1.0
FRICTIONS = [
    ViscousFriction(at="C", coefficient=4.0),
    CoulombFriction(at="C", torque=3.0, width=1e-2),
    LugreFriction(at="C", coulomb=2.0, breakaway=3.0, bristle_stiffness=300.0, bristle_damping=5.0),
    TabulatedLaw(at="C", quantity="torque", of="rate", x=(-1.0, 0.0, 1.0), value=(-2.0, 0.0, 4.0)),
]
SIDE = [{"name": "side", "link": "coupler", "position": [0.3, 0, 0]}]


def four_bar(cut: str, *effects: flexarm.Effect, **more) -> flexarm.Arm:
    arm = loops.four_bar(cut, assembly=loops.assembled(cut, START), **more)
    for effect in effects:
        arm = arm.with_effect(effect)
    return arm


PUSH = drive({"A": lambda t: 40 * np.sin(8 * t) * smooth_step(5 * t)}, END, 1001, side="torque")
"""A torque that moves the crank to and fro."""


def crank_angle(arm: flexarm.Arm) -> np.ndarray:
    return flexarm.simulate(arm, PUSH, step=2e-3, alpha=-0.05).joint_angle[:, 0]


def eye_turn(stroke: complex) -> complex:
    """Angle of the boom of `loops.crane` relative to its rod, but for a constant; analytic in the stroke."""
    to_eye, between, rod = np.hypot(1.2, 0.15), np.hypot(0.3, 0.8), 0.9 + stroke
    return np.arccos((rod**2 + to_eye**2 - between**2) / (2 * rod * to_eye))


@pytest.mark.parametrize(
    ("effect", "torque"),
    [
        (ViscousFriction(at="rod_eye", coefficient=300.0), lambda rate: 300.0 * rate),
        (CoulombFriction(at="rod_eye", torque=200.0), lambda rate: 200.0 * np.sign(rate)),
    ],
)
def test_friction_of_the_rod_eye_takes_the_piston_its_virtual_work(effect, torque):
    """F = F_0 + T(psi') dpsi/ds at the stroke s, psi the turn of the eye; Dahl's law has long slipped.

    Bodies are rigid and the stroke is prescribed, so the motion is the same. Of the piston's 28 kN a step
    solves 1e-7.
    """
    lift = drive({"piston": lambda t: 0.3 + 0.3 * smooth_step(t)}, 1.0, 501)
    plain, rubbed = (
        flexarm.simulate(arm, lift, step=2e-3) for arm in (loops.crane(), loops.crane().with_effect(effect))
    )
    moving = (plain.time > 0.2) & (plain.time < 0.8)
    stroke, rate = plain.joint_angle[moving, 2], plain.joint_rate[moving, 2]
    slope = np.imag(eye_turn(stroke + 1e-30j)) / 1e-30
    lost = (rubbed.joint_torque - plain.joint_torque)[moving, 2]
    assert np.abs(lost).min() > 5
    assert lost == approx(torque(slope * rate) * slope, rel=1e-5, abs=3e-3)


@pytest.mark.parametrize("effect", FRICTIONS, ids=lambda effect: effect.name)
def test_friction_of_a_closure_is_that_of_the_same_pin_as_a_joint(effect):
    """The equations are the same; accelerations are iterated to 1e-5 of the reach: 1e-6 after 1 s."""
    free = crank_angle(four_bar("C"))
    as_closure, as_joint = (crank_angle(four_bar(cut, effect)) for cut in "CD")
    assert np.abs(as_joint - free).max() > 1e-2
    assert as_closure == approx(as_joint, abs=3e-6)


def test_a_spring_of_a_closure_counts_the_turn_of_b_in_a():
    """The pin as a joint has the rocker's frame at its other end, half a turn away."""
    angle, torque = 1.2, {}
    for cut, rest in (("C", 0.4 - pi), ("D", 0.4)):
        arm = four_bar(cut, CableTorque(at="C", stiffness=50.0, rest_angle=rest))
        found = flexarm.static(arm, {"A": angle})
        torque[cut] = found.joint_torque[0]
    plain = flexarm.static(four_bar("C"), {"A": angle}).joint_torque[0]
    assert abs(torque["C"] - plain) > 1.0
    assert torque["C"] == approx(torque["D"], rel=1e-9)


def test_a_closure_tilts_as_the_same_pin_as_a_joint():
    """A force out of the plane bends the loop in its soft pin, and its modes leave the plane."""
    soft = JointTiltCompliance(at="C", stiffness=(2e3, 3e3))
    found = [four_bar(cut, soft, points=SIDE) for cut in "CD"]
    moved = [flexarm.static(arm, {"A": START}, {"side": [0, 50, 0]}).position[0] for arm in found]
    assert moved[0] == approx(moved[1], abs=1e-10)
    frequencies = [flexarm.modes(arm, {"A": START}, count=2).frequency_hz for arm in found]
    assert frequencies[0] == approx(frequencies[1], rel=1e-8)


def test_the_pin_adds_no_condition_that_its_loop_repeats():
    """A flat rigid loop repeats three conditions, with a law at its pin and without."""
    for arm in (four_bar("C"), four_bar("C", FRICTIONS[0])):
        assert flexarm.static(arm, {"A": START}).solver["redundant_conditions"] == 3


def test_friction_takes_its_energy():
    """Work of the torque is kinetic energy, height and loss of the pin, to second order in the step."""
    left = []
    for step in (2e-3, 1e-3):
        run = flexarm.simulate(four_bar("C", FRICTIONS[0]), PUSH, step=step, alpha=0.0, energies=True)
        assert run.damped[-1] > 0.1 * np.ptp(run.kinetic)
        balance = run.kinetic + run.elastic + run.gravity + run.damped - run.work
        left.append(np.abs(balance - balance[0]).max() / np.ptp(run.kinetic))
    assert left[1] < 1e-3
    assert left[0] / left[1] > 3.5


@pytest.mark.parametrize(
    ("effect", "kind", "said"),
    [
        (
            JointCompliance(at="rod_eye", stiffness=1e5),
            "revolute",
            "a closure, where joint_compliance does not act",
        ),
        (
            ViscousFriction(at="rod_eye", coefficient=1.0),
            "spherical",
            "is a spherical closure; viscous_friction acts",
        ),
        (
            TabulatedLaw(at="rod_eye", quantity="windup", of="angle", x=(0.0, 1.0), value=(0.0, 1e-3)),
            "revolute",
            'must be "torque" at a closure',
        ),
    ],
)
def test_effects_that_do_not_act_at_a_closure_are_refused(effect, kind, said):
    """The message says why, and where to act instead."""
    tree = loops.crane().to_dict()
    tree["closures"][0]["type"] = kind
    if kind == "spherical":
        del tree["closures"][0]["axis"]
    with pytest.raises(InvalidParameter, match=said):
        flexarm.Arm.from_dict(tree).with_effect(effect)
