"""What is exported is read again as it was, by flexarm's readers, MuJoCo and SciPy."""

import difflib
from xml.etree import ElementTree

import numpy as np
import pytest
from parts import frame_mass, frame_part
from pytest import approx
from scipy.io import loadmat
from scipy.spatial.transform import Rotation

import flexarm
from flexarm import Arm, InvalidFile, InvalidParameter, SuperElement, accept_matrices
from flexarm.cli.run import run

MODEL = """
format = "flexarm-arm/1"
name = "swing"
[[links]]
name = "rod"
type = "rigid"
mass = 2.0
com = [0.5, 0, 0]
inertia = [0.01, 0.2, 0.2]
[[joints]]
name = "hinge"
type = "revolute"
parent = "base"
child = "rod"
axis = [0, 0, 1]
gear_ratio = 100
rotor_inertia = 2e-4
[[joints]]
name = "slide"
type = "prismatic"
parent = "rod"
child = "hand"
axis = [1, 0, 0]
[[links]]
name = "hand"
type = "rigid"
mass = 0.5
com = [0, 0, 0]
inertia = [0.001, 0.001, 0.001]
"""
EFFECTS = [
    {"name": "joint_compliance", "at": "hinge", "stiffness": 5e3, "damping": 2.0},
    {"name": "viscous_friction", "at": "hinge", "coefficient": 1.5},
    {"name": "coulomb_friction", "at": "hinge", "torque": 0.25},
    {"name": "motor_friction", "at": "hinge", "coulomb": 0.75, "viscous": 0.5},
    {"name": "viscous_friction", "at": "slide", "coefficient": 3.0},
    {"name": "backlash", "at": "hinge", "gap": 1e-3},
]
URDF = """<?xml version="1.0"?>
<robot name="swing"><!-- by hand -->
  <link name="ground"/><link name="rod"/><link name="hand"/>
  <joint name="hinge" type="revolute">
    <parent link="ground"/><child link="rod"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="9" velocity="9"/><dynamics damping="99"/>
  </joint>
  <joint name="slide" type="prismatic"><parent link="rod"/><child link="hand"/><axis xyz="1 0 0"/></joint>
</robot>
"""
MJCF = """<mujoco model="swing">
  <!-- by hand -->
  <compiler autolimits="true"/>
  <option gravity="0 0 0"/>
  <default><joint damping="7" armature="3"/></default>
  <worldbody>
    <body name="rod">
      <joint name="hinge" type="hinge" axis="0 0 1" range="-90 90"/>
      <inertial pos="0.5 0 0" mass="2" diaginertia="0.01 0.2 0.2"/>
      <body name="hand">
        <joint name="slide" type="slide" axis="1 0 0"/>
        <inertial pos="0 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def files(tmp_path):
    """Model with effects, URDF and MJCF of one machine."""
    effects = "".join(
        "[[effects]]\n" + "".join(f"{key} = {value!r}\n" for key, value in effect.items())
        for effect in EFFECTS
    )
    for name, text in (("arm.toml", MODEL + effects), ("arm.urdf", URDF), ("arm.xml", MJCF)):
        (tmp_path / name).write_text(text)
    return tmp_path


def test_urdf_gets_friction_and_what_it_has_no_word_for(files):
    arm = Arm.from_toml(files / "arm.toml")
    notes = flexarm.export_urdf(arm, files / "arm.urdf", files / "found.urdf")
    text = (files / "found.urdf").read_text()
    hinge, slide = ElementTree.fromstring(text).findall("joint")
    assert {key: float(value) for key, value in hinge.find("dynamics").items()} == {
        "damping": 2.0,  # 1.5 of the bearing, 0.5 of the motor
        "friction": 1.0,
    }
    assert {key: float(value) for key, value in hinge.find("flexarm").items()} == {
        "stiffness": 5e3,
        "damping": 2.0,
        "rotor_inertia": 2e-4,
        "gear_ratio": 100.0,
    }
    assert (slide.find("dynamics").get("damping"), slide.find("flexarm")) == ("3", None)
    assert "<!-- by hand -->" in text and 'upper="1"' in text
    assert notes == ["joint hinge: backlash is not written, the format has no word for it"]
    model = files / "again.toml"
    model.write_text('format = "flexarm-arm/1"\nurdf = "found.urdf"\n')
    assert [joint.name for joint in Arm.from_toml(model).joints] == ["hinge", "slide"]


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_all_else_of_a_robot_file_stays_as_it_stands(files, newline):
    """A difference of both files shows lines of joints alone, indented as their neighbours."""
    arm = Arm.from_toml(files / "arm.toml")
    text = """<?xml version="1.0" encoding="latin-1"?>
<!-- licence: own -->
<robot name='lift' xmlns:xacro="http://ros.org/wiki/xacro">
  <link name="rod"   >
    <visual><origin xyz="0 0 0"/><a:b xmlns:a="urn:x" c="1 > 0 &amp; &quot;\xe4&quot;"/></visual></link>
  <link name="hand"></link>
  <joint name="hinge"
         type="revolute">
    <parent link="base"/><child link="rod"/>
    <axis xyz="0 0 1" />
  </joint>
  <joint name="slide" type="prismatic"><parent link="rod"/><child link="hand"/></joint>
</robot>
<!-- end -->
"""
    (files / "own.urdf").write_bytes(text.replace("\n", newline).encode("latin-1"))
    flexarm.export_urdf(arm, files / "own.urdf", files / "found.urdf")
    found = (files / "found.urdf").read_bytes().decode("latin-1")
    assert found.count(newline) == found.count("\n")
    old, new = text.splitlines(), found.splitlines()
    changed = [line for line in difflib.ndiff(old, new) if line[0] in "+-"]
    assert [line.split("<")[1].split()[0] for line in changed] == ["dynamics", "flexarm", "joint", "joint"]
    assert changed[0].startswith("+     <dynamics ")


@pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be", "gb2312"])
def test_robot_files_keep_their_encoding(files, encoding):
    """UTF-16 with its byte order mark, in both orders, and an encoding of several bytes a sign."""
    arm = Arm.from_toml(files / "arm.toml")
    start = "\ufeff" * ("16" in encoding) + f'<?xml version="1.0" encoding="{encoding[:6]}"?>\n'
    urdf = start + URDF.partition("\n")[2].replace("by hand", "\u624b >")
    (files / "own.urdf").write_bytes(urdf.encode(encoding))
    (files / "own.xml").write_bytes((start + MJCF).encode(encoding))
    flexarm.export_urdf(arm, files / "own.urdf", files / "found.urdf")
    flexarm.export_mjcf(arm, files / "own.xml", files / "found.xml")
    found = (files / "found.urdf").read_bytes().decode(encoding)
    assert found.startswith(start) and "\u624b >" in found
    assert 'name="hinge_deflection"' in (files / "found.xml").read_bytes().decode(encoding)
    assert [joint.name for joint in Arm.from_toml(files / "found.urdf").joints] == ["hinge", "slide"]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_an_mjcf_file_in_place_of_a_model_is_told(files, encoding):
    (files / "arm.xml").write_bytes(MJCF.encode(encoding))
    with pytest.raises(InvalidFile, match="is a robot in MJCF"):
        Arm.from_toml(files / "arm.xml")


def test_an_encoding_that_is_none_is_refused(files):
    (files / "arm.urdf").write_text(URDF.replace('"1.0"', '"1.0" encoding="utf-9"'))
    with pytest.raises(InvalidFile, match="line 1: declares the unknown encoding 'utf-9'"):
        flexarm.export_urdf(Arm.from_toml(files / "arm.toml"), files / "arm.urdf", files / "found.urdf")


def test_a_second_export_replaces_the_first(files):
    arm = Arm.from_toml(files / "arm.toml")
    for export, first in ((flexarm.export_urdf, "arm.urdf"), (flexarm.export_mjcf, "arm.xml")):
        export(arm, files / first, files / "once")
        export(arm, files / "once", files / "twice")
        assert (files / "once").read_text() == (files / "twice").read_text()


def test_friction_of_which_the_model_has_none_stays_as_the_file_has_it(files):
    """The model has no effect at the hinge; a rotor is written all the same."""
    (files / "arm.toml").write_text(MODEL)
    arm = Arm.from_toml(files / "arm.toml")
    notes = flexarm.export_urdf(arm, files / "arm.urdf", files / "found.urdf")
    hinge = ElementTree.parse(files / "found.urdf").getroot().find("joint")
    assert hinge.find("dynamics").attrib == {"damping": "99"}
    assert hinge.find("flexarm").get("gear_ratio") == "100"
    assert notes == ["joint hinge: damping 99 of the file stays, as the model has no viscous friction"]
    own = MJCF.replace('axis="0 0 1" range', 'axis="0 0 1" frictionloss="4" range')
    (files / "arm.xml").write_text(own)
    flexarm.export_mjcf(arm, files / "arm.xml", files / "found.xml")
    joints = {each.get("name"): each for each in ElementTree.parse(files / "found.xml").iter("joint")}
    assert (joints["hinge"].get("frictionloss"), joints["hinge"].get("damping")) == ("4", None)


def test_friction_that_a_default_class_gives_a_joint_is_told(files):
    """A joint's class is its own, that of the nearest body or frame around it, or main."""
    (files / "arm.toml").write_text(MODEL)
    inner = '<default class="geared"><joint frictionloss="4" damping="0"/></default><default class="oiled"/>'
    for default, place, kept in (
        ('<joint damping="7"/>', "", ["damping 7"]),
        (f'<joint damping="7"/>{inner}', ' childclass="geared"', ["frictionloss 4"]),
        (f'<joint damping="7"/>{inner}', ' childclass="geared"><frame childclass="oiled"', ["damping 7"]),
    ):
        text = MJCF.replace('<joint damping="7" armature="3"/>', default)
        text = text.replace('<body name="rod">', f'<body name="rod"{place}>')
        if "<frame" in place:
            text = text.replace("    </body>\n  </worldbody>", "    </frame></body>\n  </worldbody>")
        (files / "arm.xml").write_text(text)
        notes = flexarm.export_mjcf(Arm.from_toml(files / "arm.toml"), files / "arm.xml", files / "out.xml")
        told = [note.partition(": ")[2] for note in notes if note.startswith("joint hinge")]
        assert [note.partition(" of the file stays")[0] for note in told] == kept


def test_a_springdamper_does_not_override_what_is_written(files):
    """MuJoCo would take its stiffness and damping for those of the motor's joint and of the reducer's."""
    mujoco = pytest.importorskip("mujoco")
    text = MJCF.replace('armature="3"', 'armature="3" springdamper="0.1 1"')
    (files / "arm.xml").write_text(text)
    notes = flexarm.export_mjcf(Arm.from_toml(files / "arm.toml"), files / "arm.xml", files / "out.xml")
    model = mujoco.MjModel.from_xml_path(str(files / "out.xml"))
    assert model.jnt_stiffness == approx([0, 5e3, 0])
    assert model.dof_damping == approx([0.5, 2.0, 3.0])
    told = "springdamper 0.1 1 of the file is replaced by stiffness and damping"
    assert {f"joint hinge: {told}", f"joint slide: {told}"} <= set(notes)
    (files / "arm.toml").write_text(MODEL)
    notes = flexarm.export_mjcf(Arm.from_toml(files / "arm.toml"), files / "arm.xml", files / "out.xml")
    assert sum("springdamper 0.1 1 of the file stays" in note for note in notes) == 2


def test_joints_in_frames_of_a_body_are_found(files):
    """A frame's children stand in its body, turned by the frame: the deflection goes beside its joint."""
    mujoco = pytest.importorskip("mujoco")
    plain = (files / "arm.xml").read_text()
    hinge = '<joint name="hinge" type="hinge" axis="0 0 1" range="-90 90"/>'
    framed = f'<frame euler="90 0 0"><frame pos="0 0 0">{hinge.replace("0 0 1", "0 1 0")}</frame></frame>'
    (files / "framed.xml").write_text(plain.replace(hinge, framed))
    models = []
    for name in ("arm.xml", "framed.xml"):
        arm = Arm.from_toml(files / "arm.toml")
        assert len(flexarm.export_mjcf(arm, files / name, files / "once.xml")) == 1
        flexarm.export_mjcf(arm, files / "once.xml", files / "twice.xml")
        assert (files / "once.xml").read_text() == (files / "twice.xml").read_text()
        models.append(mujoco.MjModel.from_xml_path(str(files / "once.xml")))
    for key in ("jnt_axis", "jnt_stiffness", "dof_damping", "dof_armature", "dof_frictionloss", "jnt_range"):
        assert getattr(models[1], key) == approx(getattr(models[0], key), abs=1e-12)


def test_mujoco_sees_the_reducer_between_motor_and_link(files):
    """With the motor's angle phi free, M and K are those of two inertias and a spring, closed form (1)."""
    mujoco = pytest.importorskip("mujoco")
    arm = Arm.from_toml(files / "arm.toml")
    flexarm.export_mjcf(arm, files / "arm.xml", files / "found.xml")
    model = mujoco.MjModel.from_xml_path(str(files / "found.xml"))
    names = [model.joint(i).name for i in range(model.njnt)]
    assert names == ["hinge", "hinge_deflection", "slide"]
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    M = np.zeros((3, 3))
    for row, unit in zip(M, np.eye(3), strict=True):
        mujoco.mj_mulM(model, data, row, unit)
    link = 0.2 + 2.0 * 0.5**2 + 0.001  # about the hinge's axis, the hand at the origin
    armature = 2e-4 * 100**2
    assert M[:2, :2] == approx(np.array([[link + armature, link], [link, link]]))
    assert model.jnt_stiffness == approx([0, 5e3, 0])
    assert model.dof_damping == approx([0.5, 2.0, 3.0])
    assert model.dof_frictionloss == approx([0.75, 0, 0])
    assert (model.tendon_damping.ravel()[0], model.tendon_frictionloss[0]) == approx((1.5, 0.25))
    # Two free inertias: omega^2 = k (1/J_m + 1/J_l)
    squares = np.linalg.eigvals(np.linalg.solve(M[:2, :2], np.diag([0.0, 5e3])))
    assert max(squares.real) == approx(5e3 * (1 / armature + 1 / link), rel=1e-9)
    assert "<!-- by hand -->" in (files / "found.xml").read_text()


def test_compliance_without_a_rotor_is_told(files):
    text = (files / "arm.toml").read_text().replace("rotor_inertia = 2e-4\n", "")
    (files / "arm.toml").write_text(text)
    arm = Arm.from_toml(files / "arm.toml")
    notes = flexarm.export_mjcf(arm, files / "arm.xml", files / "found.xml")
    assert "joint hinge: its joint_compliance is not written; give the joint a rotor_inertia" in notes
    joint = next(ElementTree.parse(files / "found.xml").iter("joint"))
    hinge = next(e for e in ElementTree.parse(files / "found.xml").iter("joint") if e.get("name") == "hinge")
    assert joint.get("damping") == "7"  # the default stays
    assert (hinge.get("damping"), hinge.get("frictionloss"), hinge.get("armature")) == ("2", "1", None)


def test_a_stiffness_of_the_file_that_is_replaced_is_told(files):
    text = (
        (files / "arm.xml").read_text().replace('<joint name="hinge"', '<joint name="hinge" stiffness="300"')
    )
    (files / "arm.xml").write_text(text)
    notes = flexarm.export_mjcf(Arm.from_toml(files / "arm.toml"), files / "arm.xml", files / "found.xml")
    assert "joint hinge: stiffness 300 of the file is replaced by its joint_compliance" in notes


def test_what_only_sounds_like_an_earlier_export_stays(files):
    """A mesh, a geometry and a body of a user's file, named as the export names joints and tendons."""
    own = '<asset><mesh name="hinge_bearing" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset><worldbody>'
    text = (files / "arm.xml").read_text().replace("<worldbody>", own)
    text = text.replace('<body name="hand">', '<geom name="hinge_deflection" size="1"/><body name="hand">')
    (files / "arm.xml").write_text(text)
    arm = Arm.from_toml(files / "arm.toml")
    for source, out in (("arm.xml", "once.xml"), ("once.xml", "twice.xml")):
        flexarm.export_mjcf(arm, files / source, files / out)
    tags = [each.tag for each in ElementTree.parse(files / "twice.xml").iter() if each.get("name")]
    assert (tags.count("mesh"), tags.count("geom"), tags.count("body")) == (1, 1, 2)
    assert (files / "once.xml").read_text() == (files / "twice.xml").read_text()


def test_gears_and_shapes_of_friction_are_noted(files):
    gear = '[[gears]]\nname = "belt"\ninput = "hinge"\noutput = "slide"\nratio = 20\n'
    text = (files / "arm.toml").read_text() + gear
    (files / "arm.toml").write_text(
        text.replace("name = 'coulomb_friction'", "name = 'coulomb_friction'\ndrop = 0.5")
    )
    arm = Arm.from_toml(files / "arm.toml")
    for name, export in (("arm.xml", flexarm.export_mjcf), ("arm.urdf", flexarm.export_urdf)):
        notes = " ".join(export(arm, files / name, files / f"out_{name}"))
        assert "gear belt is not written" in notes
        assert "the shape of coulomb_friction is not written" in notes


def test_matrices_that_are_there_are_not_replaced(part, tmp_path):
    (tmp_path / "part_mass.mtx").write_text("of the other run")
    with pytest.raises(InvalidFile, match="exists already"):
        flexarm.export_part(part, tmp_path / "part.inp", force=False)
    assert [each.name for each in tmp_path.iterdir()] == ["part_mass.mtx"]


def test_robot_files_without_the_model_s_joints_are_refused(files):
    arm = Arm.from_toml(files / "arm.toml")
    (files / "other.urdf").write_text('<robot name="x"><link name="a"/></robot>')
    with pytest.raises(InvalidFile, match=r"other\.urdf: joints: must have a joint of the model \(hinge, sl"):
        flexarm.export_urdf(arm, files / "other.urdf", files / "out.urdf")
    with pytest.raises(InvalidFile, match=r"must hold a <mujoco>, got <robot>"):
        flexarm.export_mjcf(arm, files / "arm.urdf", files / "out.xml")
    with pytest.raises(InvalidFile, match=r"would replace .*arm\.urdf, which is read"):
        flexarm.export_urdf(arm, files / "arm.urdf", files / "arm.urdf")


@pytest.mark.parametrize("ending", ["urdf", "xml"])
def test_a_file_that_another_run_wrote_meanwhile_is_not_replaced(files, ending):
    """Two exports may both find the place free; the later one finds the file of the other."""
    arm, export = Arm.from_toml(files / "arm.toml"), {"urdf": flexarm.export_urdf, "xml": flexarm.export_mjcf}
    out = files / f"taken.{ending}"
    out.write_text("of the other run")
    with pytest.raises(InvalidFile, match="exists already"):
        export[ending](arm, files / f"arm.{ending}", out, force=False)
    assert out.read_text() == "of the other run"


def test_a_part_that_another_run_wrote_meanwhile_is_not_replaced(part, tmp_path):
    for name in ("part.mat", "part.bdf", "part.inp"):
        (tmp_path / name).write_text("of the other run")
        with pytest.raises(InvalidFile, match="exists already"):
            flexarm.export_part(part, tmp_path / name, force=False)
        assert (tmp_path / name).read_text() == "of the other run"


@pytest.fixture(scope="module")
def part() -> SuperElement:
    """A frame whose interfaces stand turned, in three ways."""
    turned = Rotation.from_euler("xyz", [[0, 0, 0], [0.3, -0.2, 1.0], [0, 0, np.pi / 2]]).as_matrix()
    return frame_part(n_modes=3, damping=1e-5).replace(rotations=turned)


def _same(found: SuperElement, part: SuperElement, rel: float) -> None:
    """Modes are free in sign, which the coupling with the interfaces tells."""
    along = np.sum(found.mass[:18, 18:] * part.mass[:18, 18:], axis=0)
    sign = np.concatenate([np.ones(18), np.sign(along)])
    for name in ("stiffness", "mass", "damping"):
        expected = getattr(part, name)
        values = getattr(found, name) * np.outer(sign, sign)
        assert values == approx(expected, abs=rel * np.abs(expected).max()), name
    assert found.positions == approx(part.positions, abs=1e-9)
    assert found.frequency_hz == approx(part.frequency_hz, rel=rel)


@pytest.mark.parametrize("unit", ["m", "mm"])
def test_nastran_reads_the_part_again_with_its_turned_interfaces(part, tmp_path, unit):
    """Ten digits are written; the frame's stiffness spans six decades of them."""
    pytest.importorskip("pyyeti")
    (file,) = flexarm.export_part(part, tmp_path / "part.bdf", unit)
    names = {name: i for i, name in enumerate(part.interfaces, 1)}
    found = accept_matrices(file, grids=file, unit=unit, interfaces=names, mass=frame_mass())
    _same(found, part, 1e-7)
    assert found.rotations == approx(part.rotations, abs=1e-8)


@pytest.mark.parametrize("unit", ["m", "mm"])
def test_abaqus_matrices_are_read_again(part, tmp_path, unit):
    deck, K, M, C = flexarm.export_part(part, tmp_path / "part.inp", unit)
    names = {name: i for i, name in enumerate(part.interfaces, 1)}
    found = accept_matrices(
        K, M, damping_matrix=C, grids=deck, unit=unit, interfaces=names, mass=frame_mass()
    )
    _same(found, part, 1e-9)
    text = deck.read_text()
    assert "*MATRIX ASSEMBLE, STIFFNESS=STIFFNESS, MASS=MASS, VISCOUS DAMPING=DAMPING" in text
    assert "INPUT=part_stiffness.mtx" in text


def test_simscape_gets_frames_and_matrices(part, tmp_path):
    (file,) = flexarm.export_part(part, tmp_path / "part.mat")
    found = loadmat(file)
    assert np.array_equal(found["K"], part.stiffness) and np.array_equal(found["M"], part.mass)
    assert np.array_equal(found["C"], part.damping) and np.array_equal(found["origins"], part.positions)
    turned = Rotation.from_quat(np.roll(found["quaternions"], -1, axis=1)).as_matrix()  # scalar first there
    assert turned == approx(part.rotations)
    assert [str(cell[0][0]) for cell in found["interfaces"]] == list(part.interfaces)


def test_wrong_endings_and_units_are_refused(part, tmp_path):
    with pytest.raises(InvalidFile, match=r"must end in \.mat, \.bdf, .* got 'part\.txt'"):
        flexarm.export_part(part, tmp_path / "part.txt")
    with pytest.raises(InvalidFile, match="unit: must be m for Simscape, got 'mm'"):
        flexarm.export_part(part, tmp_path / "part.mat", "mm")
    with pytest.raises(InvalidParameter, match="'inch' is not known for matrices"):
        flexarm.export_part(part, tmp_path / "part.bdf", "inch")
    assert list(tmp_path.iterdir()) == []


def test_the_command_exports_joints_and_parts(files, part, capsys, monkeypatch):
    monkeypatch.chdir(files)
    part.save("part.nc")
    assert run(["export", "arm.toml", "--urdf", "arm.urdf", "--out", "found.urdf"]) == 0
    assert "backlash is not written" in capsys.readouterr().err
    assert run(["export", "arm.toml", "--mjcf", "arm.xml", "--out", "found.xml", "--json"]) == 0
    assert run(["export", "part.nc", "--unit", "mm", "--out", "part.bdf"]) == 0
    assert run(["export", "part.nc", "--out", "part.mat"]) == 0
    assert run(["export", "part.nc", "--out", "part.mat"]) == 2  # is there
    assert run(["export", "arm.toml", "--out", "x.urdf"]) == 2
    assert run(["export", "arm.toml", "--urdf", "arm.urdf", "--unit", "mm", "--out", "x.urdf"]) == 2
    assert run(["export", "part.nc", "--urdf", "arm.urdf", "--out", "x.mat"]) == 2
