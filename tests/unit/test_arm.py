"""An arm is what its file says, frozen, and writes itself back."""

import pickle
import pydoc
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pytest import approx

from flexarm import Arm, Frame, Sensor
from flexarm.arm import Beam, General, Joint, Material, Payload, Rectangle, RigidLink, Round, Tube
from flexarm.effects import CoulombFriction, JointCompliance
from flexarm.errors import InvalidParameter

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)


def one_link(**section: Any) -> Arm:
    rod = {"name": "rod", "type": "beam", "end": [0, 0, 3], "section": section, "material": STEEL.to_plain()}
    hinge = {"name": "hinge", "type": "revolute", "parent": "base", "child": "rod", "axis": [0, 1, 0]}
    return Arm.from_dict({"joints": [hinge], "links": [rod]})


def test_an_arm_written_and_read_is_the_same_arm(model_file: Path, tmp_path: Path) -> None:
    arm = Arm.from_toml(model_file)
    arm.to_toml(tmp_path / "again.toml")
    assert Arm.from_toml(tmp_path / "again.toml") == arm


def test_defaults_are_those_of_the_format() -> None:
    arm = one_link(shape="round", diameter=0.05)
    rod, hinge = arm.link("rod"), arm.joint("hinge")
    assert arm.gravity == (0, 0, -9.81)
    assert (rod.theory, rod.damping_ratio) == ("timoshenko", 0)
    assert (hinge.at, hinge.gear_ratio, hinge.rotor_inertia, hinge.origin.xyz) == ("start", 1, 0, (0, 0, 0))


def test_an_arm_cannot_be_changed_in_place(model_file: Path) -> None:
    arm = Arm.from_toml(model_file)
    with pytest.raises(
        InvalidParameter, match=r"name: Arm is frozen; replace\(name=\.\.\.\) makes a changed copy"
    ):
        arm.name = "other"
    with pytest.raises(TypeError, match="frozen"):
        arm.uncertainty["payloads.load.mass"] = 0.1
    assert len({arm, Arm.from_toml(model_file)}) == 1


@pytest.mark.parametrize("kind", [Arm, Sensor, Frame, JointCompliance])
def test_help_and_completion_list_what_a_table_has_of_its_own(kind: type) -> None:
    lines = pydoc.plain(pydoc.render_doc(kind)).splitlines()
    assert [line for line in lines if "pydantic" in line] == [
        " |      pydantic.main.BaseModel"
    ]  # of the bases
    assert {"replace", "to_plain"} <= set(dir(kind))
    assert not {"model_dump", "parse_obj", "copy"} & set(dir(kind))


def test_completion_of_an_arm_lists_its_tables(model_file: Path) -> None:
    listed = dir(Arm.from_toml(model_file))
    assert {"joints", "with_effect", "replace", "plot"} <= set(listed)
    assert not [name for name in listed if name.startswith("model_")]


def test_a_number_is_changed_by_its_key(model_file: Path) -> None:
    arm = Arm.from_toml(model_file)
    heavier = arm.with_value("payloads.load.mass", 5)
    assert heavier.payload("load").mass == 5 and arm.payload("load").mass != 5
    assert heavier.with_value("payloads.load.mass", arm.payload("load").mass) == arm


def test_a_beam_that_comes_to_bend_differently_in_two_planes_keeps_its_axes(tmp_path: Path) -> None:
    """Without `up`, local z leans to the axis that is farthest from the beam, here y."""
    section = {"shape": "general", "area": 1e-3, "second_moment": 1e-7, "torsion_constant": 1e-7}
    steel = {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 7850}
    beam = {"name": "rod", "type": "beam", "end": [0.9, 0.1, 0.4], "section": section, "material": steel}
    hinge = {"name": "hinge", "type": "revolute", "parent": "base", "child": "rod", "axis": [0, 1, 0]}
    arm = Arm.from_dict({"format": "flexarm-arm/1", "name": "arm", "joints": [hinge], "links": [beam]})
    flat = arm.with_value("links.rod.section.second_moment.x", 3e-7)
    flat.to_toml(tmp_path / "flat.toml")
    assert Arm.from_toml(tmp_path / "flat.toml") == flat
    assert flat.links[0].up == (0, 1, 0)
    assert "up" not in arm.with_value("links.rod.section.area", 2e-3).to_dict()["links"][0]


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("links.rod.material.density", 0, "damping_ratio: must be 0 where the density is 0"),
        ("payloads.lod.mass", 5, "lod"),
        ("payloads.load.mass", -5, "mass.*at least 0, got -5"),
        ("payloads.load.mass", "5 kg", "value: must be a number, got '5 kg'"),
        ("payloads.load.position", 5, "must name one number.*position.x, .*position.y"),
    ],
)
def test_a_number_that_cannot_be_changed_is_refused(
    key: str, value: Any, message: str, model_file: Path
) -> None:
    with pytest.raises(InvalidParameter, match=message):
        Arm.from_toml(model_file).with_value(key, value)


def test_an_arm_crosses_process_borders(model_file: Path) -> None:
    arm = Arm.from_toml(model_file)
    assert pickle.loads(pickle.dumps(arm)) == arm


def test_numpy_numbers_are_numbers() -> None:
    load = Payload(
        name="load", link="rod", position=np.array([0, 0, 3.0]), mass=np.float32(2), inertia=np.ones(3)
    )
    assert load.position == (0, 0, 3)
    assert load.mass == 2


def test_wrong_values_in_python_name_the_value() -> None:
    with pytest.raises(InvalidParameter, match="stiffness: must be positive, got -1 N m/rad"):
        JointCompliance(at="hinge", stiffness=-1)
    with pytest.raises(InvalidParameter, match=r"outer diameter of 0.05 m, got 0.03 m"):
        Tube(outer_diameter=0.05, thickness=0.03)
    with pytest.raises(InvalidParameter, match="axis: must not be zero"):
        Joint(name="hinge", type="revolute", parent="base", child="rod", axis=(0, 0, 0))
    with pytest.raises(InvalidParameter, match="RigidLink has no 'weight'; it has name, type, mass"):
        RigidLink(name="hub", mass=1).replace(weight=2)


# ------------------------------------------------------------------------ effects


def test_an_effect_is_added_replaced_and_removed(model_file: Path) -> None:
    arm = Arm.from_toml(model_file)
    rough = arm.with_effect(CoulombFriction(at="hinge", torque=12.0))
    assert [effect.name for effect in rough.effects_at("hinge")] == ["joint_compliance", "coulomb_friction"]
    softer = rough.with_effect(JointCompliance(at="hinge", stiffness=5e4))
    assert softer.effect("joint_compliance", "hinge").stiffness == 5e4
    assert len(softer.effects) == 2
    assert softer.without_effect("coulomb_friction", "hinge").effect("coulomb_friction", "hinge") is None
    assert arm.effect("joint_compliance", "hinge").stiffness == 1e5  # the first arm is as it was


def test_removing_an_effect_that_is_not_there_says_which_are(model_file: Path) -> None:
    with pytest.raises(InvalidParameter, match="there are joint_compliance at hinge"):
        Arm.from_toml(model_file).without_effect("backlash", "hinge")


def test_an_effect_given_twice_replaces_the_first(model_text: str, tmp_path: Path) -> None:
    again = '[[effects]]\nname = "joint_compliance"\nat = "hinge"\nstiffness = 7.0e4\n'
    (tmp_path / "arm.toml").write_text(model_text.replace("[uncertainty]", again + "[uncertainty]"))
    assert [effect.stiffness for effect in Arm.from_toml(tmp_path / "arm.toml").effects] == [7e4]


# ------------------------------------------------------------------------ sections


def test_sections_have_the_area_and_moments_of_the_textbook() -> None:
    assert Tube(outer_diameter=0.06024, thickness=3.25e-3).area == approx(
        5.8188e-4, rel=1e-4
    )  # design.md: 5.82e-4
    assert Tube(outer_diameter=0.06024, thickness=3.25e-3).second_moments[0] == approx(2.37e-7, rel=1e-3)
    assert Round(diameter=0.1).second_moments[1] == approx(pi * 0.1**4 / 64)
    assert Rectangle(width=0.02, height=0.1).second_moments == approx(
        (0.02 * 0.1**3 / 12, 0.1 * 0.02**3 / 12)
    )
    assert General(area=1e-3, second_moment=[1e-6, 2e-6], torsion_constant=1e-6).second_moments == (
        1e-6,
        2e-6,
    )
    assert General(area=1e-3, second_moment=1e-6, torsion_constant=1e-6, shear_area=5e-4).shear_area == (
        5e-4,
        5e-4,
    )


def test_the_misprint_of_table_1_is_a_warning_that_says_what_would_agree() -> None:
    """Gagarina-Sasia et al. 2008, Table 1: A = 5.92e-5 m2 with a wall of 3.25 mm and I = 2.37e-7 m4."""
    printed = one_link(
        shape="general", area=5.92e-5, second_moment=2.37e-7, torsion_constant=4.74e-7, thickness=3.25e-3
    )
    [first, *_] = printed.warnings
    assert first.where == "links.rod.section"
    assert "outer diameter 60.24 mm and area 0.000582 m2" in first.what


def test_numbers_that_agree_give_no_warning() -> None:
    tube = Tube(outer_diameter=0.06024, thickness=3.25e-3)
    arm = one_link(
        shape="general",
        area=tube.area,
        second_moment=tube.second_moments[0],
        torsion_constant=4.74e-7,
        thickness=3.25e-3,
    )
    assert arm.warnings == ()


def test_a_payload_beyond_the_beam_is_a_warning(model_text: str, tmp_path: Path) -> None:
    (tmp_path / "arm.toml").write_text(model_text.replace("position = [0, 0, 3.0]", "position = [0, 0, 3.2]"))
    assert [problem.where for problem in Arm.from_toml(tmp_path / "arm.toml").warnings] == [
        "points.tip.position"
    ]


# --------------------------------------------------------------------- uncertainty


def test_uncertainty_is_relative_unless_it_ends_in_a_unit(model_file: Path) -> None:
    arm = Arm.from_toml(model_file)
    assert arm.sigma("links.rod.material.youngs_modulus") == (210e9, approx(0.02 * 210e9))
    assert arm.sigma("points.tip.position_m") == ((0, 0, 3), 0.001)
    stiff = arm.replace(uncertainty={"effects.joint_compliance.hinge.stiffness": 0.1})
    assert stiff.sigma("effects.joint_compliance.hinge.stiffness") == (1e5, approx(1e4))


# ---------------------------------------------------------------- written and read

numbers = st.floats(1e-6, 1e6)
vectors = st.tuples(st.floats(-10, 10), st.floats(-10, 10), st.floats(0.1, 10))
names = st.from_regex(r"[A-Za-zäöü0-9_-]{1,8}", fullmatch=True).filter(lambda name: name != "base")
sections = st.one_of(
    st.builds(Round, diameter=numbers),
    st.builds(lambda d, share: Tube(outer_diameter=d, thickness=d * share), numbers, st.floats(0.01, 0.49)),
    st.builds(General, area=numbers, second_moment=numbers, torsion_constant=numbers),
)
beams = st.builds(
    Beam,
    name=st.just("rod"),
    end=vectors,
    section=sections,
    elements=st.integers(1, 50),
    theory=st.sampled_from(["timoshenko", "euler-bernoulli"]),
    damping_ratio=st.just(0.0) | st.floats(1e-6, 0.5),
    material=st.builds(
        Material, youngs_modulus=numbers, poisson_ratio=st.floats(-0.9, 0.49), density=numbers
    ),
)
joints = st.builds(
    Joint,
    name=names,
    type=st.sampled_from(["revolute", "prismatic"]),
    parent=st.just("base"),
    child=st.just("rod"),
    axis=vectors,
    gear_ratio=numbers,
    rotor_inertia=numbers,
)
payloads = st.lists(
    st.builds(Payload, name=names, link=st.just("rod"), position=vectors, mass=numbers),
    max_size=3,
    unique_by=lambda load: load.name,
)


@settings(deadline=None, derandomize=True, max_examples=60)
@given(
    joint=joints,
    beam=beams,
    loads=payloads,
    label=st.text(st.characters(codec="utf-8"), min_size=1, max_size=100).filter(
        lambda text: text.isprintable() and text == text.strip()
    ),
    gravity=vectors,
)
def test_any_arm_survives_writing_and_reading(
    tmp_path_factory: pytest.TempPathFactory,
    joint: Joint,
    beam: Beam,
    loads: list[Payload],
    label: str,
    gravity: Any,
) -> None:
    arm = Arm(
        name=label,
        joints=(joint,),
        links=(beam,),
        payloads=tuple(loads),
        gravity=gravity,
        effects=(JointCompliance(at=joint.name, stiffness=joint.gear_ratio),),
    )
    file = tmp_path_factory.mktemp("arm") / "arm.toml"
    arm.to_toml(file)
    assert Arm.from_toml(file) == arm


def test_the_arm_tells_what_it_is(model_file: Path) -> None:
    arm = Arm.from_toml(model_file)
    assert repr(arm) == "<Arm 'crane': 1 moving joint, 2 links, 1 payload, 1 effect>"
    for line in (
        "joint hinge: revolute, base -> rod, ratio 120",
        "link rod: beam, 3 m, tube, E = 210 GPa",
        "payload load: 14.1 kg on gripper",
        "joint_compliance at hinge: stiffness = 100000 N m/rad",
    ):
        assert line in arm.summary()


def test_every_model_of_the_cases_is_read_without_a_warning(shared_dir: Path) -> None:
    files = sorted(shared_dir.glob("cases/case_*/model.toml"))
    assert len(files) >= 18
    for file in files:
        assert Arm.from_toml(file).warnings == ()
