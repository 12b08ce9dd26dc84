"""A URDF file and the model beside it give the arm that the same tables give."""

import math
from xml.etree import ElementTree

import numpy as np
import pytest

import flexarm
from flexarm import InvalidFile
from flexarm.arm.weight import weight_statement

URDF = """<?xml version="1.0"?>
<robot name="crane">
  <link name="ground"><inertial><mass value="99"/></inertial></link>
  <link name="mast">
    <inertial>
      <origin xyz="0 0 0.5" rpy="0 0 1.5707963267948966"/>
      <mass value="4"/><inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/>
    </inertial>
  </link>
  <link name="jib"><inertial><mass value="2"/></inertial></link>
  <link name="slide"><inertial><mass value="1"/></inertial></link>
  <link name="flange"/>
  <joint name="slew" type="continuous">
    <parent link="ground"/><child link="mast"/><origin xyz="0 0 0.2"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="luff" type="revolute">
    <parent link="mast"/><child link="jib"/><origin xyz="0.1 0 1" rpy="0 0 0.3"/><axis xyz="0 1 0"/>
  </joint>
  <joint name="reach" type="prismatic">
    <parent link="jib"/><child link="slide"/><origin xyz="0 0 2"/><axis xyz="0 0 1"/>
    <mimic joint="luff" multiplier="0.5" offset="0.25"/>
  </joint>
  <joint name="end" type="fixed"><parent link="slide"/><child link="flange"/><origin xyz="0 0 0.1"/></joint>
</robot>
"""
POINT = '[[points]]\nname = "tip"\nlink = "flange"\nposition = [0, 0, 0]\n'


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "crane.urdf").write_text(URDF)
    (tmp_path / "crane.toml").write_text('format = "flexarm-arm/1"\nurdf = "crane.urdf"\n' + POINT)
    return tmp_path


def test_links_joints_and_inertias_are_those_of_the_file(folder):
    """The mast's inertia turns by 90 degrees about z: Ixx and Iyy change places. The ground has no weight."""
    arm = flexarm.Arm.from_toml(folder / "crane.toml")
    assert arm.name == "crane"
    assert arm.link("mast").inertia == pytest.approx((2, 1, 2.5, 0, 0, 0), abs=1e-12)
    assert weight_statement(arm).whole.mass == pytest.approx(7)
    assert [(j.name, j.type, j.parent) for j in arm.joints][:2] == [
        ("slew", "revolute", "base"),
        ("luff", "revolute", "mast"),
    ]


def test_a_tip_stands_where_the_product_of_the_origins_puts_it(folder):
    """With luff = q the mimic joint slides by 0.25 + q/2 from 2 m; the flange is 0.1 m further."""
    arm = flexarm.Arm.from_toml(folder / "crane.toml").replace(gravity=(0, 0, 0))
    for q in (0.0, 0.4):
        along = 2.35 + 0.5 * q
        out = along * math.sin(q)
        tip = [0.1 + out * math.cos(0.3), out * math.sin(0.3), 1.2 + along * math.cos(q)]
        assert flexarm.static(arm, joints={"luff": q}).position[0] == pytest.approx(tip, abs=1e-9)


def test_entries_of_the_model_take_precedence(folder):
    model = folder / "crane.toml"
    beam = """
[[joints]]
name = "luff"
gear_ratio = 100
[[links]]
name = "jib"
type = "beam"
end = [0, 0, 2]
section = { shape = "tube", outer_diameter = 0.06, thickness = 0.003 }
material = { youngs_modulus = 210e9, poisson_ratio = 0.3, density = 7850 }
"""
    model.write_text(model.read_text() + beam)
    arm = flexarm.Arm.from_toml(model)
    assert arm.link("jib").type == "beam"
    assert arm.joint("luff").gear_ratio == 100
    assert arm.joint("luff").origin.xyz == (0.1, 0, 1)
    assert flexarm.Arm.from_dict(arm.to_dict()) == arm


@pytest.mark.parametrize(
    ("old", "new", "where", "what"),
    [
        ("</robot>", "", "line", "is no XML"),
        ('type="continuous"', 'type="floating"', "joints.slew.type", "'floating'"),
        ('<mass value="4"/>', '<mass value="four"/>', "links.mast.value", "'four'"),
        ('<parent link="ground"/>', "", "joints.slew", "names no parent"),
        ('<link name="flange"/>', '<link name="flange"/><link name="loose"/>', "links", "ground, loose"),
        ('multiplier="0.5"', 'multiplier="0"', "joints.reach.mimic.multiplier", "must not be 0"),
    ],
)
def test_what_is_wrong_is_named_with_its_place(folder, old, new, where, what):
    (folder / "crane.urdf").write_text(URDF.replace(old, new, 1))
    with pytest.raises(InvalidFile) as error:
        flexarm.Arm.from_toml(folder / "crane.urdf")
    assert where in str(error.value)
    assert what in str(error.value)


def test_a_urdf_file_that_is_not_there_is_named(folder):
    (folder / "crane.urdf").unlink()
    with pytest.raises(InvalidFile, match=r"crane\.urdf: file: there is no such file"):
        flexarm.Arm.from_toml(folder / "crane.toml")


def test_a_robot_of_others_loads_whole(shared_dir):
    """The construction robot's mass is that of its inertials, all but the root's."""
    path = shared_dir / "data" / "hilti_trailblazer" / "trailblazer.urdf"
    robot = ElementTree.parse(path).getroot()
    children = {joint.find("child").get("link") for joint in robot.findall("joint")}
    masses = [
        float(link.find("inertial/mass").get("value"))
        for link in robot.findall("link")
        if link.get("name") in children and link.find("inertial") is not None
    ]
    arm = flexarm.Arm.from_toml(path)
    assert weight_statement(arm).whole.mass == pytest.approx(np.sum(masses))
    down = flexarm.static(arm).base_wrench[2]
    assert down == pytest.approx(-9.81 * np.sum(masses), rel=1e-9)


def test_malformed_tables_beside_a_urdf_are_refused_not_raised_through(folder):
    model = folder / "crane.toml"
    model.write_text(model.read_text().replace(POINT, "joints = 5\n"))
    with pytest.raises(InvalidFile, match="joints"):
        flexarm.Arm.from_toml(model)


def test_a_sliding_mimic_joint_without_an_axis_is_refused(folder):
    slide = '<origin xyz="0 0 2"/><axis xyz="0 0 1"/>'
    assert slide in URDF
    (folder / "crane.urdf").write_text(URDF.replace(slide, slide.replace("0 0 1", "0 0 0")))
    with pytest.raises(InvalidFile, match=r"joints\.reach\.axis"):
        flexarm.Arm.from_toml(folder / "crane.urdf")


def test_two_entries_that_replace_the_same_one_are_refused(folder):
    twice = '[[links]]\nname = "mast"\ntype = "rigid"\nmass = 1.0\n'
    model = folder / "crane.toml"
    model.write_text(model.read_text() + twice + twice)
    with pytest.raises(InvalidFile, match="'mast' is used twice"):
        flexarm.Arm.from_toml(model)


def test_an_arm_made_in_python_has_no_urdf_to_read(folder):
    arm = flexarm.Arm.from_toml(folder / "crane.toml")
    with pytest.raises(flexarm.InvalidParameter, match=r"urdf: is read by Arm\.from_toml"):
        arm.replace(urdf="crane.urdf")
