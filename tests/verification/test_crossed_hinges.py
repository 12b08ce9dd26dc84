"""Universal and spherical joints in the tree: against a closed form and against closures of the same kind."""

from __future__ import annotations

import numpy as np
import pytest
from arms import G, arm, rigid
from pytest import approx
from scipy.spatial.transform import Rotation

import flexarm
from flexarm.errors import InvalidParameter

BOB = rigid("bob", 2.0, (0, 0, -0.5), (0.05, 0.05, 0.02))
TIP = [{"name": "tip", "link": "bob", "position": [0.1, 0.2, -1.0]}]


def hung(kind: str, **more: object) -> flexarm.Arm:
    joint = {"name": "hook", "type": kind, "parent": "base", "child": "bob", **more}
    return arm(joints=[joint], links=[BOB], points=TIP)


def test_a_universal_joint_turns_about_one_axis_after_the_other():
    """R = R(u, q_1) R(v, q_2); the second axis turns with the first hinge."""
    cross = hung("universal", axis=[1, 0, 0], second_axis=[0, 1, 0])
    assert [joint.name for joint in cross.joints] == ["hook_1", "hook_2"]
    a, b = 0.4, -0.7
    about_x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    found = flexarm.static(cross, {"hook_1": a, "hook_2": b})
    assert found.position[0] == approx(about_x @ about_y @ [0.1, 0.2, -1.0], abs=1e-12)


def pushed(model: flexarm.Arm, angles: dict[str, float], rates: dict[str, float]) -> flexarm.Simulation:
    free = flexarm.Drive.from_samples([0, 1], dict.fromkeys(angles, (0, 0)), side="torque")
    told = flexarm.Drive(free.joints, angles, 0.0, 1.0, rates=rates)
    return flexarm.simulate(model, told, step=5e-4, alpha=0.0)


def test_a_point_mass_on_a_cross_goes_round_as_a_conical_pendulum():
    """At w^2 = g/(l cos a) its height stays; beside +x, turning about x moves it along y."""
    length, a = 0.8, 0.5
    cross = {"name": "c", "type": "universal", "parent": "base", "child": "bob"}
    point = [{"name": "bob", "link": "bob", "position": [0, 0, -length]}]
    axes = {"axis": [1, 0, 0], "second_axis": [0, 1, 0]}
    model = arm(joints=[{**cross, **axes}], links=[rigid("bob", 1.0, (0, 0, -length))], points=point)
    w = np.sqrt(G / (length * np.cos(a)))
    run = pushed(model, {"c_1": 0.0, "c_2": -a}, {"c_1": w * np.tan(a), "c_2": 0.0})
    exact = length * np.stack([np.sin(a) * np.cos(w * run.time), np.sin(a) * np.sin(w * run.time)], axis=1)
    assert run.position[:, 0, :2] == approx(exact, abs=1e-4)


def test_a_ball_on_a_ball_joint_turns_about_one_axis():
    """Alike about all axes and without weight it keeps its angular velocity: R = exp(w t)."""
    names = ("hook_1", "hook_2", "hook_3")
    joint = {"name": "hook", "type": "spherical", "parent": "base", "child": "bob"}
    model = arm(joints=[joint], links=[rigid("bob", 2.0, (0, 0, 0), (0.1, 0.1, 0.1))], points=TIP)
    model = model.replace(gravity=(0.0, 0.0, 0.0))
    w = np.array([0.6, 0.3, -0.9])
    run = pushed(model, dict.fromkeys(names, 0.0), dict(zip(names, w, strict=True)))
    exact = Rotation.from_rotvec(np.outer(run.time, w)).apply(TIP[0]["position"])
    assert np.abs(run.position[:, 0] - exact).max() < 1e-5


def test_a_model_with_such_joints_is_written_and_read(tmp_path):
    model = hung("spherical")
    model.to_toml(tmp_path / "arm.toml")
    assert flexarm.Arm.from_toml(tmp_path / "arm.toml") == model


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"type": "universal", "axis": [1, 0, 0]}, "is universal, and needs axis and second_axis"),
        ({"type": "spherical", "axis": [1, 0, 0]}, "is spherical, and needs no axis"),
        ({"type": "spherical", "gear_ratio": 3.0}, "gears, rotors and drives belong to its hinges"),
        ({"type": "ball"}, "revolute, prismatic, fixed, universal or spherical|ball"),
    ],
)
def test_what_such_a_joint_needs_is_said(more, said):
    kind = more.pop("type")
    with pytest.raises(InvalidParameter, match=said):
        hung(kind, **more)
