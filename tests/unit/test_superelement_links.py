"""Links of type "superelement": where their files lie, what names their interfaces, what they weigh."""

from pathlib import Path

import numpy as np
import pytest
from arms import arm, paper_arm
from part_arms import arm_of_parts, tube_part
from pytest import approx

import flexarm
from flexarm import Arm, InvalidFile, InvalidParameter
from flexarm.arm.kinematics import link_pose
from flexarm.arm.weight import weight_statement

MODEL = """
format = "flexarm-arm/1"
[[joints]]
name = "hinge"
type = "revolute"
parent = "base"
child = "tube:start"
axis = [0, 1, 0]
[[links]]
name = "tube"
type = "superelement"
file = "parts/tube.nc"
[[payloads]]
name = "load"
link = "tube:end"
position = [0, 0, 0]
mass = 14.1
[[points]]
name = "tip"
link = "tube:end"
position = [0, 0, 0]
"""


@pytest.fixture
def model(tmp_path: Path) -> Path:
    (tmp_path / "parts").mkdir()
    tube_part().save(tmp_path / "parts" / "tube.nc")
    (tmp_path / "arm.toml").write_text(MODEL)
    return tmp_path / "arm.toml"


def test_the_file_counts_from_where_the_model_lies(
    model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    found = Arm.from_toml(model)
    assert flexarm.static(found).position[0] == approx([0, 0, 3], abs=1e-5)
    found.to_toml("copy.toml")
    assert 'file = "../parts/tube.nc"' in Path("copy.toml").read_text()
    assert Arm.from_toml("copy.toml") == found


@pytest.mark.parametrize(
    ("old", "new", "where", "what"),
    [
        ('"parts/tube.nc"', '"tube.nc"', "links.tube.file", "there is no file"),
        ('"tube:start"', '"tube:foot"', "joints.hinge.child", "no interface 'foot' on 'tube'; there are"),
        ('"tube:start"', '"tube"', "joints.hinge.child", "must name an interface of the super-element"),
        ('link = "tube:end"\nposition = [0, 0, 0]\nmass', 'link = "tube"\nposition = [0, 0, 0]\nmass',
         "payloads.load.link", "must be LINK:INTERFACE"),
    ],
)  # fmt: skip
def test_wrong_names_are_refused_with_their_place(
    model: Path, old: str, new: str, where: str, what: str
) -> None:
    assert MODEL.count(old) == 1
    model.write_text(MODEL.replace(old, new))
    with pytest.raises(InvalidFile, match=what) as error:
        Arm.from_toml(model)
    assert error.value.problems[0].where == where


def test_a_file_that_is_no_superelement_is_named(model: Path) -> None:
    (model.parent / "parts" / "tube.nc").write_text("nothing")
    with pytest.raises(InvalidFile, match=r"tube\.nc"):
        Arm.from_toml(model)


def test_a_file_written_anew_is_read_anew(model: Path) -> None:
    found = Arm.from_toml(model)
    before = flexarm.static(found, joints={"hinge": 1.0}).displacement[0, 0]
    soft = tube_part()
    soft.replace(stiffness=0.5 * soft.stiffness).save(model.parent / "parts" / "tube.nc", force=True)
    assert flexarm.static(found, joints={"hinge": 1.0}).displacement[0, 0] == approx(2 * before, rel=0.05)


def test_it_weighs_what_the_beam_weighs(tmp_path: Path) -> None:
    beam, parts = weight_statement(paper_arm()), weight_statement(arm(**arm_of_parts(tmp_path, 3)))
    assert parts.whole.mass == approx(beam.whole.mass)
    assert parts.whole.centre == approx(beam.whole.centre)
    # A cubic element has its exact inertia across the axis; about the axis both have rho (Iy + Iz) L.
    assert np.array(parts.whole.inertia)[:2, :2] == approx(np.array(beam.whole.inertia)[:2, :2], rel=1e-9)


def test_rigid_poses_lead_through_interfaces(tmp_path: Path) -> None:
    found = arm(**arm_of_parts(tmp_path, 3))
    q = np.array([0.0, 0.4])
    pose = link_pose(found, "s2:end", {"hinge": q})
    assert pose.x == approx(3 * np.stack([np.sin(q), 0 * q, np.cos(q)], axis=1))
    assert link_pose(found, "s2", {"hinge": q}).x == approx(pose.x * 2 / 3)


def test_a_position_that_repeats_the_interface_s_own_is_doubted(model: Path) -> None:
    model.write_text(
        MODEL.replace(
            '"tip"\nlink = "tube:end"\nposition = [0, 0, 0]', '"tip"\nlink = "tube:end"\nposition = [0, 0, 3]'
        )
    )
    (doubt,) = Arm.from_toml(model).warnings
    assert doubt.where == "points.tip.position"
    assert "counts from the interface" in doubt.what


def test_a_missing_file_of_an_arm_made_in_python_is_named(tmp_path: Path) -> None:
    tables = arm_of_parts(tmp_path, 1)
    (tmp_path / "segment.nc").unlink()
    with pytest.raises((InvalidFile, InvalidParameter), match=r"segment\.nc"):
        flexarm.static(arm(**tables))
