"""Derivatives by the lengths and places of closed loops: against differences and the triangle of a crane."""

from __future__ import annotations

import loops
import numpy as np
import pytest
from arms import drive
from loops import flexible_crane as crane
from pytest import approx

import flexarm
from flexarm import Arm
from flexarm.arm.parameter import parameters, with_value
from flexarm.errors import InvalidParameter

STROKE = {"piston": 0.42}
EYE = "closures.rod_eye.b_origin.xyz"
KEYS = (
    f"{EYE}.x",
    f"{EYE}.z",
    "closures.rod_eye.a_origin.xyz.z",
    "joints.boom_pin.origin.xyz.x",
    "links.boom.end.x",
)
COMPLIANCE = {"name": "joint_compliance", "at": "piston", "stiffness": 4e6, "damping": 2e4}


def lift(end: float = 1.0) -> flexarm.Drive:
    return drive({"piston": lambda t: 0.4 + 0.1 * np.sin(np.pi * t / end) ** 2}, end, 201)


def differences(arm: Arm, key: str, names: tuple[str, ...], compute) -> dict[str, np.ndarray]:
    """Central differences of 1e-4 of a metre or radian, which err by 1e-7."""
    value, h = parameters(arm, [key])[0].value, 1e-4
    up, down = (compute(with_value(arm, key, value + e)) for e in (h, -h))
    return {name: (getattr(up, name) - getattr(down, name)) / (2 * h) for name in names}


@pytest.mark.parametrize(
    "arm", [crane(effects=[COMPLIANCE]), loops.crane()], ids=["beam", "rigid, redundant"]
)
def test_derivatives_of_an_equilibrium_are_those_of_differences(arm):
    keys = [key for key in KEYS if "end" not in key or arm.links[0].type == "beam"]
    names = ("position", "joint_torque", "link_angle", "base_wrench")
    found = flexarm.static(arm, STROKE, sensitivities=keys)
    for k, key in enumerate(keys):
        expected = differences(arm, key, names, lambda other: flexarm.static(other, STROKE))
        for name in names:
            slope = found.sensitivities[name][..., k]
            assert slope == approx(expected[name], rel=1e-5, abs=1e-6 * np.abs(expected[name]).max()), (
                key,
                name,
            )


def boom_angle(x: complex, stroke: float) -> complex:
    """Angle of the boom of `loops.crane` whose eye is at (x, -0.15): two triangles."""
    to_eye, rod = np.sqrt(x**2 + 0.15**2), 0.9 + stroke
    to_pin = np.hypot(0.3, 0.8)
    at_pin = np.arccos((to_eye**2 + to_pin**2 - rod**2) / (2 * to_eye * to_pin))
    return at_pin + np.arctan(0.15 / x)


def test_the_boom_turns_with_the_place_of_its_bracket_as_the_triangle_says():
    found = flexarm.static(loops.crane(), STROKE, sensitivities=[f"{EYE}.x"])
    slope = np.imag(boom_angle(1.2 + 1e-30j, 0.42)) / 1e-30
    assert abs(slope) > 0.3
    assert found.sensitivities["link_angle"][0, 0] == approx(slope, rel=1e-8)


def test_derivatives_of_a_motion_are_those_of_differences():
    arm = crane(effects=[COMPLIANCE])
    names = ("position", "joint_torque", "joint_angle")
    found = flexarm.simulate(arm, lift(), step=5e-3, sensitivities=KEYS)
    for k, key in enumerate(KEYS):
        expected = differences(arm, key, names, lambda other: flexarm.simulate(other, lift(), step=5e-3))
        for name in names:
            slope = found.sensitivities[name][..., k]
            assert np.abs(slope - expected[name]).max() < 2e-3 * np.abs(expected[name]).max(), (key, name)


def test_derivatives_of_frequencies_are_those_of_differences():
    arm = crane(effects=[COMPLIANCE])
    found = flexarm.modes(arm, STROKE, count=3, sensitivities=KEYS)
    for k, key in enumerate(KEYS):
        expected = differences(
            arm, key, ("frequency_hz",), lambda other: flexarm.modes(other, STROKE, count=3)
        )["frequency_hz"]
        slope = found.sensitivities["frequency"][..., k]
        assert slope == approx(expected, rel=1e-4, abs=1e-4 * np.abs(expected).max()), key


def test_a_longer_boom_has_a_derivative_as_an_effect_too():
    """`link_length` moves the eye with its boom."""
    key = "effects.link_length.boom.error"
    arm = crane(effects=[{"name": "link_length", "at": "boom", "error": 0.0}])
    slope = flexarm.static(arm, STROKE, sensitivities=[key]).sensitivities["position"][..., 0]
    expected = differences(arm, key, ("position",), lambda other: flexarm.static(other, STROKE))["position"]
    assert slope == approx(expected, rel=1e-5, abs=1e-6)


@pytest.mark.parametrize(
    ("key", "said"),
    [
        (f"{EYE}.y", "has no derivative here: closure 'rod_eye' cannot be closed"),
        (f"{EYE}.x", "it moves 'piston', which is held where its loop was closed first"),
    ],
)
def test_a_place_that_opens_the_loop_or_moves_what_is_held_has_no_derivative(key, said):
    with pytest.raises(InvalidParameter, match=said):
        flexarm.static(loops.crane(), STROKE if key.endswith("y") else {}, sensitivities=[key])


def test_the_bracket_of_a_cylinder_is_calibrated():
    """From 8 mm off to within three sigmas of where it is, which are less than 0.3 mm."""
    truth = crane()
    record = loops.crane_record(truth, lift(), 1e-3, 4)
    start = with_value(truth, f"{EYE}.x", 1.208).replace(uncertainty={f"{EYE}_m": 0.01})
    found = flexarm.calibrate(start, {"lift": record})
    place = found.parameter(f"{EYE}.x")
    assert abs(place.value - 1.2) < 3 * place.std
    assert place.std < 1e-4
    assert found.updated.closures[0].b_origin.xyz[0] == approx(place.value)
