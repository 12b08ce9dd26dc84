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


BEAM = """
[[links]]
name = "jib"
type = "beam"
end = [0, 0, {length}]
section = {{ shape = "tube", outer_diameter = 0.06, thickness = 0.003 }}
material = {{ youngs_modulus = 210e9, poisson_ratio = 0.3, density = 7850 }}
"""
PLAIN = """
format = "flexarm-arm/1"
[[joints]]
name = "luff"
type = "revolute"
parent = "base"
child = "jib"
axis = [0, 1, 0]
[[joints]]
name = "wrist"
type = "revolute"
parent = "jib"
child = "hand"
PLACE
axis = [0, 1, 0]
[[links]]
name = "hand"
type = "rigid"
mass = 20.0
com = [0, 0, 0.2]
[[points]]
name = "tip"
link = "hand"
position = [0, 0, 0]
""" + BEAM.format(length=2)
SHORT = """<robot name="short">
  <link name="base_link"/>
  <link name="base"/>
  <link name="jib"><inertial><mass value="2"/></inertial></link>
  <link name="hand"><inertial><origin xyz="0 0 0.2"/><mass value="20"/></inertial></link>
  <joint name="plate" type="fixed"><parent link="base_link"/><child link="base"/></joint>
  <joint name="luff" type="revolute">
    <parent link="base_link"/><child link="jib"/><axis xyz="0 1 0"/>
  </joint>
  <joint name="wrist" type="revolute">
    <parent link="jib"/><child link="hand"/><origin xyz="{xyz}"/><axis xyz="0 1 0"/>
  </joint>
</robot>
"""
HAND = 'format = "flexarm-arm/1"\nurdf = "short.urdf"\n' + POINT.replace("flange", "hand")


def short(folder, beam, xyz="0 0 2", more=""):
    """The arm of `SHORT` with a beam for its jib."""
    (folder / "short.urdf").write_text(SHORT.format(xyz=xyz))
    (folder / "short.toml").write_text(HAND + beam + more)
    return flexarm.Arm.from_toml(folder / "short.toml")


def sag(arm):
    return flexarm.static(arm, joints={"luff": math.pi / 2}).displacement[0]


def test_a_beam_in_place_of_a_link_carries_its_child_joints_at_its_far_end(tmp_path):
    """The arm sags as the plain model does, and has its length: not 0, and not twice as long."""
    (tmp_path / "plain.toml").write_text(PLAIN.replace("PLACE", 'at = "end"'))
    plain = flexarm.Arm.from_toml(tmp_path / "plain.toml")
    arm = short(tmp_path, BEAM.format(length=2))
    assert arm.warnings == ()
    assert sag(plain)[2] < -1e-3
    assert sag(arm) == pytest.approx(sag(plain), rel=1e-12)
    at_end = short(tmp_path, BEAM.format(length=2), more='[[joints]]\nname = "wrist"\nat = "end"\n')
    assert sag(at_end) == pytest.approx(sag(plain), rel=1e-12)


def test_a_joint_beside_or_beyond_the_end_of_a_beam_is_rigid_with_the_section_there(tmp_path):
    joint = short(tmp_path, BEAM.format(length=2), "0 0.1 2.3").joint("wrist")
    assert (joint.at, joint.origin.xyz) == ("end", pytest.approx((0, 0.1, 0.3)))


def test_a_joint_at_the_start_of_a_beam_stays_there(tmp_path):
    joint = short(tmp_path, BEAM.format(length=2), "0 0.1 0").joint("wrist")
    assert (joint.at, joint.origin.xyz) == ("start", (0, 0.1, 0))


def test_a_joint_between_the_ends_of_a_beam_is_refused_unless_the_model_says_where(tmp_path):
    beam = BEAM.format(length=4)
    with pytest.raises(
        InvalidFile, match=r"joints\.wrist\.origin: stands at 0\.5 of the length of beam 'jib'"
    ):
        short(tmp_path, beam)
    arm = short(tmp_path, beam, more='[[joints]]\nname = "wrist"\nat = "start"\n')
    assert (arm.joint("wrist").at, arm.joint("wrist").origin.xyz) == ("start", (0, 0, 2))


def test_an_origin_of_the_model_counts_from_where_the_model_says(tmp_path):
    own = '[[joints]]\nname = "wrist"\nat = "end"\norigin = { xyz = [0, 0, 0.1] }\n'
    assert short(tmp_path, BEAM.format(length=2), more=own).joint("wrist").origin.xyz == (0, 0, 0.1)


def test_a_joint_that_hangs_on_the_start_of_a_beam_beside_its_end_is_doubted(tmp_path):
    """The same slip without URDF: the arm would not sag."""
    told = {}
    for place in ("origin = { xyz = [0, 0.1, 2] }", 'at = "start"\norigin = { xyz = [0, 0.1, 2] }'):
        (tmp_path / "plain.toml").write_text(PLAIN.replace("PLACE", place))
        told[place] = [str(problem) for problem in flexarm.Arm.from_toml(tmp_path / "plain.toml").warnings]
    (doubt,), stated = told.values()
    assert doubt.startswith("joints.wrist.at: is left out")
    assert 'write at = "end" and origin xyz = [0.0, 0.1, 0.0]' in doubt
    assert stated == []


@pytest.mark.parametrize(("along", "doubted"), [(0.0, False), (-0.2, False), (0.3, True), (1.9, True)])
def test_a_joint_along_a_beam_hangs_on_its_start_and_is_doubted(tmp_path, along, doubted):
    place = f"origin = {{ xyz = [0, 0.1, {along}] }}"
    (tmp_path / "plain.toml").write_text(PLAIN.replace("PLACE", place))
    told = [str(problem) for problem in flexarm.Arm.from_toml(tmp_path / "plain.toml").warnings]
    assert len(told) == doubted
    assert all(f"stands {along:g} m along it, which it does not follow; write two beams" in t for t in told)


def test_links_named_base_are_read_as_ros_industrial_writes_them(tmp_path):
    """A root of that name is the base; below another root it is a frame of its own."""
    (tmp_path / "short.urdf").write_text(SHORT.format(xyz="0 0 2"))
    arm = flexarm.Arm.from_toml(tmp_path / "short.urdf")
    assert [link.name for link in arm.links] == ["base_frame", "jib", "hand"]
    swapped = SHORT.replace("base_link", "other").replace('"base"', '"pad"').replace('"other"', '"base"')
    (tmp_path / "short.urdf").write_text(swapped.format(xyz="0 0 2"))
    arm = flexarm.Arm.from_toml(tmp_path / "short.urdf")
    assert [joint.parent for joint in arm.joints] == ["base", "base", "jib"]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('<link name="base"/>', '<xacro:macro name="arm"/>'),
        ('value="20"', 'value="${mass}"'),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
@pytest.mark.parametrize("file", ["short.urdf", "short.urdf.xacro"])
def test_a_xacro_file_that_is_not_expanded_is_said_so(tmp_path, old, new, file, encoding):
    (tmp_path / file).write_text(SHORT.replace(old, new), encoding=encoding)
    with pytest.raises(InvalidFile, match=r"not expanded.*xacro in\.xacro > arm\.urdf"):
        flexarm.Arm.from_toml(tmp_path / file)


@pytest.mark.parametrize("number", ["1e300", "inf", "-1e40"])
def test_numbers_beyond_any_range_are_refused_where_they_stand(folder, number):
    (folder / "crane.urdf").write_text(URDF.replace('ixx="1"', f'ixx="{number}"'))
    with pytest.raises(InvalidFile, match=r"links\.mast\.ixx: must be at"):
        flexarm.Arm.from_toml(folder / "crane.urdf")


def test_of_many_roots_ten_are_named(tmp_path):
    links = "".join(f"<link name='l{i}'/>" for i in range(300))
    (tmp_path / "a.urdf").write_text(f"<robot name='x'>{links}</robot>")
    model = tmp_path / "arm.toml"
    model.write_text('format = "flexarm-arm/1"\nurdf = "a.urdf"\n')
    with pytest.raises(InvalidFile, match=r"l8, l9 and 290 more$"):
        flexarm.Arm.from_toml(model)
