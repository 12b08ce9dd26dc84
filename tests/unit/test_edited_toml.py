"""TOML texts with other values: comments of what stays are kept."""

import tomllib
from pathlib import Path

import pytest

from flexarm import Arm, effects
from flexarm.tables.edited import edited_toml

TEXT = """# Arm of the second hall.
format = "flexarm-arm/1"  # the first
gravity = [0, 0, -9.81]

[[links]]
name = "rod"     # steel
mass = 2.0       # weighed in May
material = { youngs_modulus = 210e9 }

# The tool is changed daily.
[[links]]
name = "tool"
mass = 0.5

[uncertainty]
"links.rod.mass" = 0.1  # of the scale
"""


def data():
    return tomllib.loads(TEXT)


def edited(new):
    return edited_toml(TEXT, data(), new)


def test_the_same_values_give_the_same_text():
    assert edited(data()) == TEXT


def test_a_changed_value_keeps_its_comment_and_all_others():
    new = data()
    new["links"][0]["mass"] = 2.125
    assert edited(new) == TEXT.replace("mass = 2.0 ", "mass = 2.125 ")


def test_added_and_removed_tables_leave_other_comments_where_they_are():
    new = data()
    del new["uncertainty"]
    new["effects"] = [{"name": "payload_mass", "at": "tool", "mass": 1.5}]
    new["title"] = "arm"
    new["links"].append({"name": "cable", "mass": 0.1})
    found = edited(new)
    assert tomllib.loads(found) == new
    for comment in ("second hall", "the first", "steel", "weighed in May", "changed daily"):
        assert comment in found
    assert "of the scale" not in found


def test_only_the_difference_is_written():
    """What a program knows of defaults does not come into the text, nor leave it."""
    before = {"links": [{"name": "rod", "mass": 2.0, "shear": True}, {"name": "tool", "mass": 0.5}]}
    after = {"links": [{"name": "rod", "mass": 2.5, "shear": True}, {"name": "tool", "mass": 0.5}]}
    assert edited_toml(TEXT, before, after) == TEXT.replace("mass = 2.0 ", "mass = 2.5 ")


INTERLEAVED = """[[joints]]
name = "j1"
[[links]]
name = "l1" # first
text = '''
[[no]] header
'''
# of j2
[[joints]]
name = "j2"
[joints.origin]
xyz = [
  0, # none
  1
]

[[links]]
name = "l2"
section.width = 1
"""


def test_tables_of_several_lists_keep_their_order():
    new = tomllib.loads(INTERLEAVED)
    new["joints"][1]["origin"]["rpy"] = [0, 0, 1]
    new["links"][1]["section"]["width"] = 2
    found = edited_toml(INTERLEAVED, tomllib.loads(INTERLEAVED), new)
    wanted = INTERLEAVED.replace("  1\n]\n", "  1\n]\nrpy = [0, 0, 1]\n").replace("width = 1", "width = 2")
    assert found == wanted


def test_a_table_goes_with_those_below_it():
    new = tomllib.loads(INTERLEAVED)
    del new["joints"][1]
    found = edited_toml(INTERLEAVED, tomllib.loads(INTERLEAVED), new)
    assert tomllib.loads(found) == new and "# of j2" in found


def test_a_table_that_becomes_a_number_has_no_place():
    with pytest.raises(ValueError, match="uncertainty"):
        edited(data() | {"uncertainty": 1.0})


MODEL = """format = "flexarm-arm/1"
[[joints]]
name = "hinge"
type = "revolute"
parent = "base"
child = "rod"
axis = [0, 1, 0]

[[links]]
name = "rod"
type = "beam"
end = [0, 0, 1]
section = { shape = "round", diameter = 0.02 }
material = { youngs_modulus = 210e9, poisson_ratio = 0.3, density = 7850 }
elements = 4  # enough

[[joints]]
name = "wrist"
type = "fixed"
parent = "rod"
at = "end"
child = "tool"

[[links]]
name = "tool"
type = "rigid"
mass = 1.0
"""
SPRING = """
[[effects]]
name = "joint_compliance"
at = "hinge"
stiffness = 5000.0
"""


def test_a_model_with_an_effect_is_its_file_with_that_effect(tmp_path):
    """Defaults stay where the file states them, such as four elements, and do not come in elsewhere."""
    (tmp_path / "arm.toml").write_text(MODEL)
    new = Arm.from_toml(tmp_path / "arm.toml").with_effect(effects.JointCompliance(at="hinge", stiffness=5e3))
    assert new.toml_for(tmp_path, tmp_path / "arm.toml") == MODEL + SPRING


def test_a_refined_value_of_a_model_is_written_as_people_write_it(tmp_path):
    (tmp_path / "arm.toml").write_text(MODEL)
    arm = Arm.from_toml(tmp_path / "arm.toml").with_value("links.rod.material.youngs_modulus", 208.3e9)
    wanted = MODEL.replace("youngs_modulus = 210e9", "youngs_modulus = 2.083e11")
    assert arm.toml_for(tmp_path, tmp_path / "arm.toml") == wanted


def test_a_model_beside_its_urdf_file_still_names_it_from_another_folder(tmp_path):
    links = '<link name="foot"/><link name="rod"><inertial><mass value="2"/></inertial></link>'
    ends = '<parent link="foot"/><child link="rod"/>'
    robot = f'<robot name="r">{links}<joint name="hinge" type="continuous">{ends}</joint></robot>'
    (tmp_path / "r.urdf").write_text(robot)
    text = 'format = "flexarm-arm/1"\nurdf = "r.urdf"\n'
    (tmp_path / "arm.toml").write_text(text)
    arm = Arm.from_toml(tmp_path / "arm.toml").with_effect(effects.JointCompliance(at="hinge", stiffness=5e3))
    found = arm.toml_for(tmp_path / "out", tmp_path / "arm.toml")
    assert found == text.replace("r.urdf", "../r.urdf") + SPRING
    heavier = arm.with_value("links.rod.mass", 3.0)
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "new.toml").write_text(heavier.toml_for(tmp_path / "out", tmp_path / "arm.toml"))
    assert Arm.from_toml(tmp_path / "out" / "new.toml") == heavier


@pytest.mark.parametrize("text", ["<robot/>", "", "format = 1\n"])
def test_a_text_that_cannot_hold_a_model_is_written_anew(text, tmp_path):
    (tmp_path / "arm.toml").write_text(MODEL)
    (tmp_path / "other.toml").write_text(text)
    arm = Arm.from_toml(tmp_path / "arm.toml")
    (tmp_path / "new.toml").write_text(arm.toml_for(tmp_path, tmp_path / "other.toml"))
    assert Arm.from_toml(tmp_path / "new.toml") == arm


def test_a_model_with_an_effect_keeps_the_comments_of_its_file(tmp_path):
    path = Path(__file__).parents[2] / "examples" / "three_joints.toml"
    arm = Arm.from_toml(path)
    new = arm.with_effect(effects.JointCompliance(at="elbow", stiffness=5e3, damping=1.0))
    file = tmp_path / "updated.toml"
    comments = [line.split("#", 1)[1] for line in path.read_text().splitlines() if "#" in line]
    file.write_text(new.toml_for(tmp_path, path))
    assert Arm.from_toml(file) == new
    assert comments and all(comment in file.read_text() for comment in comments)
