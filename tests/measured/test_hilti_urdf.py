"""The Hilti robot's URDF file read by another program, yourdfpy: places, mimic joints, masses, inertias."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import yourdfpy

import flexarm
from flexarm import Arm

MODEL = Path(__file__).resolve().parents[2] / "examples/hilti_trailblazer/robot.toml"
ARM = [f"dsr_joint{k}" for k in range(1, 7)]


@pytest.fixture(scope="module")
def both(shared_dir, tmp_path_factory):
    """The robot by flexarm, and by yourdfpy."""
    folder = tmp_path_factory.mktemp("urdf")
    urdf = shutil.copy(shared_dir / "data/hilti_trailblazer/trailblazer.urdf", folder)
    shutil.copy(MODEL, folder)
    return Arm.from_toml(folder / "robot.toml"), yourdfpy.URDF.load(urdf, load_meshes=False)


def test_sensors_are_where_yourdfpy_puts_them_at_any_joint_angles(both):
    """Mimic joints of the column included: half of the lift each, less their offsets. To rounding."""
    arm, other = both
    rng = np.random.default_rng(5)
    for lift in (1.5, 2.3, 3.9):
        angles = {"column_prismatic_joint": lift} | dict(zip(ARM, rng.uniform(-2, 2, 6), strict=True))
        other.update_cfg(angles)
        found = flexarm.static(arm, angles)
        for point in arm.points:
            expected = other.get_transform(point.link, "base_link")[:3, 3]
            assert found.position[found.points.index(point.name)] == pytest.approx(expected, abs=1e-9)


def test_masses_centres_and_inertias_are_those_of_yourdfpy(both):
    """Of every link that moves; the tracks, which carry the robot, are the base."""
    arm, other = both
    links = {link.name: link for link in arm.links}
    seen = 0
    for link in other.robot.links:
        if link.inertial is None or link.name not in links:
            continue
        seen += 1
        origin = np.eye(4) if link.inertial.origin is None else link.inertial.origin
        R = origin[:3, :3]
        Ixx, Iyy, Izz, Ixy, Ixz, Iyz = (*links[link.name].inertia, 0.0, 0.0, 0.0)[:6]
        assert links[link.name].mass == pytest.approx(link.inertial.mass)
        assert links[link.name].com == pytest.approx(origin[:3, 3])
        own = [[Ixx, Ixy, Ixz], [Ixy, Iyy, Iyz], [Ixz, Iyz, Izz]]
        assert np.array(own) == pytest.approx(R @ link.inertial.inertia @ R.T, abs=1e-12)
    assert seen > 12


def test_the_column_has_the_mimic_joints_of_the_file(both):
    arm, other = both
    mimics = {joint.name: joint.mimic for joint in other.robot.joints if joint.mimic is not None}
    assert set(mimics) == {"column_middle_joint", "column_top_joint"}
    ratios = {frozenset((gear.input, gear.output)): gear.ratio for gear in arm.gears}
    for name, mimic in mimics.items():
        ratio = ratios[frozenset((name, mimic.joint))]
        assert {ratio, 1 / ratio} == {mimic.multiplier, 1 / mimic.multiplier}
