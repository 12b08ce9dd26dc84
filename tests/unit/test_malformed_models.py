"""Every mistake in a model ends as one line with the file, the place, the value and what is allowed."""

# ruff: noqa: E501 (a mistake a line, as a table)

from pathlib import Path

import pytest

from flexarm import Arm
from flexarm.arm.section import General, contradiction
from flexarm.errors import InvalidFile

# what is replaced, by what, where the error stands, what it says besides
MISTAKES = {
    "unknown key": ("elements = 4", "elments = 4", "links.rod.elments", "did you mean 'elements'?"),
    "deep tables": ("[[payloads]]", "[a" + 5000 * ".b" + "]\n[[payloads]]", "a", "unknown key"),
    "unknown table": ("[[payloads]]", "[[payload]]", "payload", "did you mean 'payloads'?"),
    "missing key": ("mass = 14.1\n", "", "payloads.load.mass", "is missing; needed is mass [kg]"),
    "missing axis": ("axis = [0, 1, 0]\n", "", "joints.hinge.axis", "is missing; a revolute joint needs"),
    "zero axis": ("axis = [0, 1, 0]", "axis = [0, 0, 0]", "joints.hinge.axis", "must not be zero"),
    "short vector": ("axis = [0, 1, 0]", "axis = [0, 1]", "joints.hinge.axis", "a list of 3 numbers, got [0, 1]"),
    "text in vector": ("[0, 1, 0]", '[0, "1", 0]', "joints.hinge.axis[1]", "must be a number, got '1'"),
    "text for number": ("mass = 14.1", 'mass = "14.1"', "payloads.load.mass", "a number [kg], got '14.1'"),
    "truth for number": ("mass = 14.1", "mass = true", "payloads.load.mass", "a number [kg], got true"),
    "nan": ("density = 7850", "density = nan", "links.rod.material.density", "must be a finite number [kg/m3]"),
    "infinite": ("mass = 2.0", "mass = inf", "links.gripper.mass", "must be a finite number [kg], got inf"),
    "negative mass": ("mass = 14.1", "mass = -1", "payloads.load.mass", "must be at least 0, got -1 kg"),
    "zero modulus": ("210e9", "0", "links.rod.material.youngs_modulus", "must be positive, got 0 Pa"),
    "Poisson's ratio": ("= 0.3", "= 0.5", "links.rod.material.poisson_ratio", "must be less than 0.5, got 0.5"),
    "solid tube": ("= 3.25e-3", "= 0.04", "links.rod.section.thickness", "half the outer diameter of 0.06024 m"),
    "unknown shape": ('"tube"', '"tubular"', "links.rod.section.shape", "'rectangle', 'general', got 'tubular'"),
    "no shape": ('shape = "tube", ', "", "links.rod.section.shape", "is missing"),
    "unknown type": ('"beam"', '"rod"', "links.rod.type", "must be one of 'beam', 'rigid', 'superelement'"),
    "unknown joint type": ('"revolute"', '"ball"', "joints.hinge.type", "'universal' or 'spherical', got 'ball'"),
    "no length": ("end = [0, 0, 3.0]", "end = [0, 0, 0]", "links.rod.end", "must have a length"),
    "half an element": ("elements = 4", "elements = 2.5", "links.rod.elements", "must be a whole number, got 2.5"),
    "no element": ("elements = 4", "elements = 0", "links.rod.elements", "must be at least 1, got 0"),
    "zero ratio": ("gear_ratio = 120", "gear_ratio = 0", "joints.hinge.gear_ratio", "must not be zero"),
    "impossible inertia": ("0.01]", "0.05]", "links.gripper.inertia", "none may exceed the sum of the others"),
    "negative inertia": ("[0.02, 0.02,", "[-0.02, 0.02,", "links.gripper.inertia", "must not be negative"),
    "unknown child": ('child = "rod"', 'child = "rot"', "joints.hinge.child", "there are rod, gripper"),
    "unknown parent": ('parent = "rod"', 'parent = "rot"', "joints.wrist.parent", "there is no link 'rot'"),
    "loop": ('parent = "base"', 'parent = "gripper"', "links.rod", "hangs on itself and not on the base"),
    "two joints, one child": ('parent = "rod"\nchild = "gripper"\nat = "end"', 'parent = "base"\nchild = "rod"',
                              "joints.wrist.child", "link 'rod' is already the child of joint 'hinge'"),
    "joint to itself": ('child = "gripper"', 'child = "rod"', "joints.wrist.child", "joins 'rod' to itself"),
    "link without joint": ('[[payloads]]', '[[links]]\nname = "spare"\ntype = "rigid"\nmass = 1\n[[payloads]]',
                           "links.spare", "no joint has link 'spare' as its child"),
    "joint twice": ('name = "wrist"', 'name = "hinge"', "joints.hinge.name", "is used twice"),
    "link called base": ('name = "gripper"', 'name = "base"', "links.base.name", "cannot be the name of a link"),
    "end of a rigid link": ('parent = "base"', 'parent = "base"\nat = "end"', "joints.hinge.at", "needs a beam"),
    "payload on nothing": ('link = "gripper"', 'link = "hand"', "payloads.load.link", "there is no link 'hand'"),
    "point on an interface": ('link = "rod"', 'link = "rod:end"', "points.tip.link", "must be LINK"),
    "sensor of nothing": ('point = "tip"', 'point = "top"', "sensors.tracker.point", "there are tip"),
    "sensor without place": ('point = "tip"\n', "", "sensors.tracker.point", "position needs the name of a point"),
    "sensor at a wrong place": ('point = "tip"', 'joint = "hinge"', "sensors.tracker.joint", "but at a point"),
    "unknown quantity": ('"position"', '"place"', "sensors.tracker.quantity", "got 'place'"),
    "unit of another kind": ('unit = "mm"', 'unit = "deg"', "sensors.tracker.unit", "unit 'deg' does not fit"),
    "axis twice": ('["x", "z"]', '["x", "x"]', "sensors.tracker.axes", "none twice"),
    "motor of nothing": ('joint = "hinge"\nres', 'joint = "wrist"\nres', "motors[0].joint", "no moving joint 'wrist'"),
    "controller of nothing": ('joint = "hinge"\ntype', 'joint = "h"\ntype', "controllers[0].joint", "there are hinge"),
    "unknown effect": ('"joint_compliance"', '"joint_complianc"', "effects.joint_complianc.hinge", "did you mean"),
    "backlash of a rigid joint": ('"joint_compliance"\nat = "hinge"\nstiffness = 1.0e5\ndamping = 20.0',
                                  '"backlash"\nat = "hinge"\ngap = 4e-4', "effects.backlash.hinge.at",
                                  'add [[effects]] name = "joint_compliance", at = "hinge"'),
    "parameter of an effect": ("stiffness = 1.0e5", "stiffness = -5", "effects.joint_compliance.hinge.stiffness",
                               "must be positive, got -5 N m/rad"),
    "effect nowhere": ('at = "hinge"', 'at = "wrist"', "effects.joint_compliance.wrist.at", "there are hinge"),
    "effect without a place": ('at = "hinge"\nstiffness', "stiffness", "effects.joint_compliance.at",
                               "is missing; needed is name of a joint, link"),
    "uncertainty of nothing": ("load.mass", "lead.mass", "uncertainty.payloads.lead.mass", "there are load"),
    "uncertainty in a table": ('[uncertainty]\n"links.rod.material.youngs_modulus"', '[uncertainty.links.rod.material]\nyoungs_modulus',
                               "uncertainty.links.rod.material.youngs_modulus (line ",
                               'got 0.02; write the key in quotes, in one piece, under [uncertainty]: "links.rod.material.youngs_modulus" = 0.02'),
    "uncertainty without quotes": ('"payloads.load.mass" =', "payloads.load.mass =", "uncertainty.payloads.load.mass", 'write the key in quotes'),
    "relative vector": ("position_m", "position", "uncertainty.points.tip.position", "write position_m"),
    "wrong format": ("flexarm-arm/1", "flexarm-arm/9", "format", "is 'flexarm-arm/9'; allowed is 'flexarm-arm/1'"),
    "no format": ("format =", "formatted =", "format", "is missing"),
    "not TOML": ("gravity =", "gravity", "line 3, column 9", "not valid TOML"),
    "decimal comma": ("mass = ", "mass = 6,5 #", "line ", "'; decimals take a point"),
    "text without quotes": ('name = "tip"', "name = tip", "line ", "got 'name = tip'; texts stand in quotes"),
    "unit behind a number": ("mass = ", "mass = 6 kg #", "line ", "'; a number stands without its unit"),
    "name with a dot": ('name = "tip"', 'name = "tip.1"', "points.tip.1.name", "contains '.'"),
    "long name": ('name = "tip"', f'name = "{"t" * 101}"', "points.ttt", "has 101 characters; allowed are 100"),
    "name that turns writing": ('name = "tip"', 'name = "tip\\u202e"', "points.tip", "contains '\\u202e'"),
    "name with a control": ('name = "tip"', 'name = "tip\\u0007"', "points.tip", "contains '\\x07'"),
    "name with blanks": ('name = "tip"', 'name = " tip "', "points. tip .name", "contains ' '"),
    "effect at a hidden name": ('name = "joint_compliance"\nat = "hinge"\nstiffness = 1.0e5\ndamping = 20.0',
                                'name = "time_delay"\nat = "a\\u202eb"', "effects.time_delay", "contains '\\u202e'"),
    "section of two planes": ('shape = "tube", outer_diameter = 0.06024, thickness = 3.25e-3',
                              'shape = "rectangle", width = 0.1, height = 0.02', "links.rod.up", "is missing"),
    "table for a list": ("[[points]]", "[points]", "points", "; write each as [[points]]"),
}  # fmt: skip


SHAFTS = """
[[joints]]
name = "SHAFT"
type = "revolute"
parent = "base"
child = "ROTOR"
axis = [0, 1, 0]
[[links]]
name = "ROTOR"
type = "rigid"
mass = 1.0
"""
GEAR = '[[gears]]\nname = "{}"\ninput = "{}"\noutput = "{}"\nratio = {}\n'
GEARS = {
    "the same pair twice": (
        [("shaft", "idler", 10), ("shaft", "idler", 10)],
        "the output of gear 'g0' (ratio 10)",
    ),
    "two ratios": ([("shaft", "idler", 10), ("shaft", "idler", 12)], "(ratio 10) already, got ratio 12"),
    "two inputs": ([("shaft", "idler", 10), ("spare", "idler", 12)], "a joint has one input"),
    "there and back": (
        [("shaft", "idler", 10), ("idler", "shaft", 0.1)],
        "are coupled already by gears before it ('g0')",
    ),
    "a loop of three": (
        [("shaft", "idler", 2), ("idler", "spare", 2), ("spare", "shaft", 2)],
        "must not form a loop",
    ),
}


@pytest.mark.parametrize("case", GEARS)
def test_gears_that_repeat_or_contradict_each_other_are_refused(
    case: str, model_text: str, tmp_path: Path
) -> None:
    gears, what = GEARS[case]
    text = model_text
    for name in ("shaft", "idler", "spare"):
        text += SHAFTS.replace("SHAFT", name).replace("ROTOR", f"{name}_rotor")
    text += "".join(GEAR.format(f"g{k}", *gear) for k, gear in enumerate(gears))
    (tmp_path / "arm.toml").write_text(text)
    with pytest.raises(InvalidFile) as caught:
        Arm.from_toml(tmp_path / "arm.toml")
    (line,) = caught.value.lines()
    assert f"gears.g{len(gears) - 1}.output" in line
    assert what in line


def test_gears_may_form_a_train_and_branch(model_text: str, tmp_path: Path) -> None:
    text = model_text
    for name in ("shaft", "idler", "spare"):
        text += SHAFTS.replace("SHAFT", name).replace("ROTOR", f"{name}_rotor")
    text += GEAR.format("g0", "shaft", "idler", 2) + GEAR.format("g1", "shaft", "spare", 3)
    (tmp_path / "arm.toml").write_text(text)
    assert len(Arm.from_toml(tmp_path / "arm.toml").gears) == 2


def test_damping_of_a_link_without_mass_is_refused_in_model_and_effect(
    model_text: str, tmp_path: Path
) -> None:
    """A ratio of damping is of a vibration, and a link without mass has none."""
    weightless = model_text.replace("density = 7850", "density = 0")
    effect = '[[effects]]\nname = "link_damping"\nat = "rod"\ndamping_ratio = 0.01\n'
    undamped = weightless.replace("damping_ratio = 0.005", "")
    for text, where in (
        (weightless, "links.rod.damping_ratio"),
        (undamped + effect, "effects.link_damping.rod"),
    ):
        (tmp_path / "arm.toml").write_text(text)
        with pytest.raises(InvalidFile, match=rf"{where}.*must be 0 where the density is 0"):
            Arm.from_toml(tmp_path / "arm.toml")


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_in_a_model_is_named_with_file_and_place(
    mistake: str, model_text: str, tmp_path: Path
) -> None:
    old, new, where, what = MISTAKES[mistake]
    assert old in model_text
    file = tmp_path / "arm.toml"
    file.write_text(model_text.replace(old, new, 1))

    with pytest.raises(InvalidFile) as caught:
        Arm.from_toml(file)

    lines = [line for line in caught.value.lines() if f": {where}" in line and what in line]
    assert lines, caught.value.lines()
    assert all(line.startswith(f"{file}: ") for line in caught.value.lines())


def test_all_mistakes_are_reported_together(model_text: str, tmp_path: Path) -> None:
    file = tmp_path / "arm.toml"
    file.write_text(model_text.replace("mass = 14.1", "mass = -1").replace("elements = 4", "elements = 0"))
    with pytest.raises(InvalidFile) as caught:
        Arm.from_toml(file)
    assert [problem.where for problem in caught.value.problems] == [
        "links.rod.elements",
        "payloads.load.mass",
    ]


def test_the_line_of_a_mistake_is_named(model_text: str, tmp_path: Path) -> None:
    file = tmp_path / "arm.toml"
    text = model_text.replace("mass = 14.1", "mass = -1")
    file.write_text(text)
    with pytest.raises(InvalidFile) as caught:
        Arm.from_toml(file)
    assert text.splitlines()[caught.value.problems[0].line - 1] == "mass = -1"


@pytest.mark.parametrize(("content", "what"), [
    (None, "there is no such file"),
    (b"\x89PNG\r\n\x1a\n\x00\x00", r"is a picture \(PNG\), which flexarm does not read"),
    (b"name = \"caf\xe9\"", "not a text in UTF-8: byte 0xe9"),
    (b"a\x00b = 1", "not valid TOML"),
    (b"Weg [\xb0];Zeit\n1,5;2\n3,5;4\n5,5;6\n", "is a table of numbers.*`flexarm import --guess`"),
    (b"links = [{ name = 'a' }]\n[[links]]\nname = 'b'", r"links = \.\.\. is given above; write all of it there"),
    (b"", "format: is missing"),
    (b"x = " + b"[" * 5000, "not valid TOML"),
])  # fmt: skip
def test_a_file_that_is_no_model_is_told_apart(content: bytes | None, what: str, tmp_path: Path) -> None:
    file = tmp_path / "arm.toml"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(InvalidFile, match=what):
        Arm.from_toml(file)


def test_a_directory_is_no_model(tmp_path: Path) -> None:
    with pytest.raises(InvalidFile, match="is a directory, a file is needed"):
        Arm.from_toml(tmp_path)


def test_a_record_in_place_of_a_model_is_told(tmp_path: Path) -> None:
    (tmp_path / "record.toml").write_text('format = "flexarm-record/1"\n')
    with pytest.raises(InvalidFile, match="is a record, a file is needed; a command takes the model first"):
        Arm.from_toml(tmp_path)


def test_a_table_within_uncertainty_is_named_with_its_line(model_text: str, tmp_path: Path) -> None:
    """And a key in quotes that stands below it by mistake is told as it is."""
    file = tmp_path / "arm.toml"
    text = model_text.replace(
        '[uncertainty]\n"links.rod.material.youngs_modulus"',
        "[uncertainty.links.rod.material]\nyoungs_modulus",
    )
    file.write_text(text)
    with pytest.raises(InvalidFile) as caught:
        Arm.from_toml(file)
    first, second, _ = caught.value.problems
    assert text.splitlines()[first.line - 1] == "youngs_modulus = 0.02"
    assert '"payloads.load.mass" = 0.005' in second.what
    assert text.splitlines()[second.line - 1] == '"payloads.load.mass" = 0.005'


def test_a_wall_that_no_round_section_of_that_area_can_have_is_said() -> None:
    """A = pi r2 of a solid bar: 5.8e-4 m2 have r = 13.59 mm; I = pi r4/4 = 2.3e-7 m4 has r = 23.3 mm."""
    section = General(area=5.8e-4, second_moment=2.3e-7, torsion_constant=4e-7, thickness=0.05)
    said = contradiction(section)
    assert said is not None
    assert said.startswith("wall 0.05 m contradicts area 0.00058 m2")
    assert said.endswith("its radius is 0.0136 m, and a wall must be less than that")


def test_an_error_lists_a_thousand_problems_and_counts_the_others(tmp_path, model_file):
    text = "".join(f"a{i} = 1\n" for i in range(1500)) + model_file.read_text()
    (tmp_path / "many.toml").write_text(text)
    with pytest.raises(InvalidFile) as error:
        Arm.from_toml(tmp_path / "many.toml")
    assert len(error.value.problems) == 1001
    assert error.value.problems[-1].what == "has 500 more problems"
