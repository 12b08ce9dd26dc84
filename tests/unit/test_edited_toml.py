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


def test_the_same_values_give_the_same_text():
    assert edited_toml(TEXT, data()) == TEXT


def test_a_changed_value_keeps_its_comment_and_all_others():
    new = data()
    new["links"][0]["mass"] = 2.125
    assert edited_toml(TEXT, new) == TEXT.replace("mass = 2.0 ", "mass = 2.125 ")


def test_added_and_removed_tables_leave_other_comments_where_they_are():
    new = data()
    del new["uncertainty"]
    new["effects"] = [{"name": "payload_mass", "at": "tool", "mass": 1.5}]
    new["title"] = "arm"
    new["links"].append({"name": "cable", "mass": 0.1})
    found = edited_toml(TEXT, new)
    assert tomllib.loads(found) == new
    for comment in ("second hall", "the first", "steel", "weighed in May", "changed daily"):
        assert comment in found
    assert "of the scale" not in found


def test_tables_in_another_order_are_written_anew():
    new = data()
    new["links"].reverse()
    assert tomllib.loads(edited_toml(TEXT, new))["links"] == new["links"]


@pytest.mark.parametrize("text", ["<robot/>", "", "a = 1\na = 2\n"])
def test_a_text_that_is_no_toml_of_the_data_gives_the_data(text):
    assert tomllib.loads(edited_toml(text, data())) == data()


def test_a_model_with_an_effect_keeps_the_comments_of_its_file(tmp_path):
    path = Path(__file__).parents[2] / "examples" / "three_joints.toml"
    arm = Arm.from_toml(path)
    new = arm.with_effect(effects.JointCompliance(at="elbow", stiffness=5e3, damping=1.0))
    file = tmp_path / "updated.toml"
    comments = [line.split("#", 1)[1] for line in path.read_text().splitlines() if "#" in line]
    file.write_text(new.toml_for(tmp_path, path))
    assert Arm.from_toml(file) == new
    assert comments and all(comment in file.read_text() for comment in comments)
