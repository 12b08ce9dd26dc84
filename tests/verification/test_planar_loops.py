"""Closed loops that lie in a plane are stepped in it, and move as they do in space.

Newton's method ends each in its own coordinates, so that forces differ by what stiffness makes of its rest.
"""

from __future__ import annotations

from pathlib import Path

import loops
import numpy as np
import pytest
import telescopes
from arms import smooth_step

import flexarm
from flexarm.errors import InvalidParameter
from flexarm.simulation.prepared import coordinates, prepared
from flexarm.simulation.solve import solved

CRANE = Path(__file__).resolve().parents[2] / "examples" / "crane.toml"


def turning(arm: flexarm.Arm, joint: str, start: float, by: float, end: float = 1.0) -> flexarm.Drive:
    """Return a drive of one joint by a smooth step."""
    time = np.linspace(0.0, end, 201)
    return flexarm.Drive.from_samples(time, {joint: start + by * smooth_step(time / end)})


def flexible(name: str, length: float, mass: float) -> dict:
    """Return a beam in place of a rigid bar."""
    return loops.beam(name, length)


def case(name: str) -> tuple[flexarm.Arm, flexarm.Drive]:
    """Return an arm with loops and what drives it."""
    if name == "rigid four-bar":
        arm = loops.four_bar("C", assembly=loops.assembled("C", 0.6))
        return arm, turning(arm, "A", 0.6, 5.0)
    if name == "four-bar with a beam":
        arm = loops.four_bar("D", flexible, assembly=loops.assembled("D", 0.6))
        return arm, turning(arm, "A", 0.6, 2.0)
    if name == "crane":
        arm = flexarm.Arm.from_toml(CRANE)
        return arm, turning(arm, "piston", 0.0, 0.4)
    arm = telescopes.telescope(loops.beam("outer", 3.0, 6, 0.1), loops.beam("inner", 2.4, 6, 0.06), 1.5)
    return arm, turning(arm, "extension", 1.5, 0.3)


def converged(arm: flexarm.Arm, motion: flexarm.Drive, where: str, consistent: bool) -> flexarm.Simulation:
    """Return a run whose Newton iterations end near rounding."""
    run = prepared(arm, motion, 4e-3, -0.05, None, True, False)
    run.options.tolerance = 1e-13
    run.options.dimension = coordinates(where)
    run.options.consistent_forces = consistent
    return solved(run, None)


@pytest.mark.parametrize("name", ["rigid four-bar", "four-bar with a beam", "crane", "telescope"])
@pytest.mark.parametrize("consistent", [False, True])
def test_a_loop_moves_in_its_plane_as_in_space(name, consistent):
    plane, space = (converged(*case(name), dimension, consistent) for dimension in ("auto", "space"))
    assert [run.solver["dimension"] for run in (plane, space)] == [2, 3]
    for what in ("position", "velocity", "joint_angle", "joint_torque", "motor_torque", "base_wrench"):
        found, expected = getattr(plane, what), getattr(space, what)
        assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max(), what


def test_derivatives_of_a_loop_in_its_plane_are_those_in_space():
    arm, motion = case("four-bar with a beam")
    keys = ["links.coupler.mass", "closures.D.a_origin.xyz.x", "links.crank.material.youngs_modulus"]
    plane, space = (
        flexarm.simulate(arm, motion, step=4e-3, dimension=dimension, sensitivities=keys)
        for dimension in ("plane", "space")
    )
    for what in ("position", "joint_torque", "joint_angle"):
        for key in keys:
            found, expected = (run.sensitivities.by(key)[what] for run in (plane, space))
            assert np.abs(found - expected).max() < 1e-5 * np.abs(expected).max(), (what, key)


def test_a_plane_is_refused_where_a_closure_leaves_it():
    arm = loops.crane()
    eye = {**arm.closures[0].to_plain(), "type": "point_on_line", "axis": [0, 1, 1]}
    leaning = flexarm.Arm.from_dict({**arm.to_dict(), "closures": [eye]})
    with pytest.raises(InvalidParameter, match="closure 'rod_eye' ties what lies across the plane"):
        flexarm.simulate(leaning, turning(leaning, "piston", 0.0, 0.3), dimension="plane")
