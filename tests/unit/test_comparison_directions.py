"""Claims about directions: tangential is d(tip)/dq, radial is outward, normal is the axis."""

import numpy as np
import pytest

from flexarm.arm import Arm
from flexarm.arm.kinematics import link_pose
from flexarm.comparison.gap import base_directions, joint_directions, project
from flexarm.measurement import Registration

SECTION = {"shape": "tube", "outer_diameter": 0.06, "thickness": 0.003}
STEEL = {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 7850}


def beam(name, length):
    return {"name": name, "type": "beam", "end": [0, 0, length], "section": SECTION, "material": STEEL}


@pytest.fixture
def arm():
    """A waist about z, a shoulder about y with a tilted origin, an elbow at the end of the first beam."""
    return Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "joints": [
                {"name": "waist", "type": "revolute", "parent": "base", "child": "column", "axis": [0, 0, 2]},
                {
                    "name": "shoulder",
                    "type": "revolute",
                    "parent": "column",
                    "child": "upper",
                    "axis": [0, 1, 0],
                    "origin": {"xyz": [0.1, 0.2, 0.5], "rpy": [0.3, -0.2, 0.1]},
                },
                {
                    "name": "elbow",
                    "type": "revolute",
                    "parent": "upper",
                    "child": "fore",
                    "at": "end",
                    "axis": [0, 1, 0],
                },
                {
                    "name": "slide",
                    "type": "prismatic",
                    "parent": "fore",
                    "child": "hand",
                    "at": "end",
                    "axis": [0, 0, 1],
                },
            ],
            "links": [
                {"name": "column", "type": "rigid", "mass": 1.0, "com": [0, 0, 0], "inertia": [1, 1, 1]},
                beam("upper", 1.8),
                beam("fore", 1.2),
                beam("hand", 0.2),
            ],
            "points": [
                {"name": "tip", "link": "fore", "position": [0.05, 0.02, 1.2]},
                {"name": "grip", "link": "hand", "position": [0, 0, 0.2]},
                {"name": "hub", "link": "column", "position": [0, 0, 0.4]},
            ],
        }
    )


def place(arm, point, **values):
    where = arm.point(point)
    pose = link_pose(arm, where.link, {name: np.atleast_1d(value) for name, value in values.items()})
    return pose.of_point(np.array(where.position))


@pytest.mark.parametrize("joint", ["waist", "shoulder", "elbow"])
def test_tangential_is_the_derivative_of_the_position(arm, joint):
    values = {"waist": 0.4, "shoulder": 0.7, "elbow": -0.5}
    found = joint_directions(arm, joint, "tip", {name: np.array([value]) for name, value in values.items()})
    h = 1e-6
    rate = (
        place(arm, "tip", **{**values, joint: values[joint] + h})
        - place(arm, "tip", **{**values, joint: values[joint] - h})
    ) / (2 * h)
    np.testing.assert_allclose(found["tangential"], rate / np.linalg.norm(rate), atol=1e-8)
    basis = np.concatenate([found["tangential"], found["radial"], found["normal"]])
    np.testing.assert_allclose(basis @ basis.T, np.eye(3), atol=1e-12)


def test_upright_arm_leans_towards_x_and_reaches_upward(arm):
    """The arm of the contract: at q = 0 tangential is +x, radial +z, normal +y."""
    upright = arm.replace(joints=(arm.joints[0], arm.joints[1].replace(origin={}), *arm.joints[2:]))
    upright = upright.replace(points=(upright.points[0].replace(position=(0, 0, 1.2)),))
    found = joint_directions(upright, "shoulder", "tip", {})
    for name, axis in (("tangential", 0), ("normal", 1), ("radial", 2)):
        np.testing.assert_allclose(found[name], np.eye(3)[[axis]], atol=1e-15)


def test_no_directions_for_a_sliding_joint_a_point_on_the_axis_or_one_it_does_not_carry(arm):
    assert joint_directions(arm, "slide", "grip", {}) is None
    assert joint_directions(arm, "waist", "hub", {}) is None
    assert joint_directions(arm, "elbow", "hub", {}) is None


def test_sliding_joint_moves_its_link_along_the_axis(arm):
    out, home = place(arm, "grip", slide=0.3), place(arm, "grip")
    assert np.linalg.norm(out - home) == pytest.approx(0.3)


def test_directions_outside_the_measured_plane_are_not_reported():
    residual = np.array([[1.0, 2.0], [3.0, 4.0]])
    found = project(residual, ("x", "z"), Registration(), base_directions(2))
    np.testing.assert_allclose(found["x"], [1, 3])
    np.testing.assert_allclose(found["z"], [2, 4])
    assert found["y"] is None


def test_directions_are_found_through_a_turned_frame():
    """A frame turned by 0.7 rad about z: a shift along base x has parts along its x and y."""
    frame = Registration(rpy=(0, 0, 0.7))
    shift = np.array([[1e-3, 0, 0]]) @ frame.frame_axes
    found = project(shift, ("x", "y", "z"), frame, base_directions(1))
    np.testing.assert_allclose([found[axis][0] for axis in "xyz"], [1e-3, 0, 0], atol=1e-15)
