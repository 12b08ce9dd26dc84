"""Makes the right files that campaigns spoil: `python -m torture.seeds FOLDER`."""

from __future__ import annotations

import contextlib
import io
import shutil
import sys
from math import cos, sin
from pathlib import Path

from campaign_runs import STATIC
from right_files import MODEL, RESPONSES

ROOT = Path(__file__).resolve().parents[2]

URDF = """<?xml version="1.0"?>
<robot name="two">
  <link name="stand"/>
  <link name="upper">
    <inertial><origin xyz="0 0 0.2" rpy="0 0 0.1"/><mass value="3.5"/>
      <inertia ixx="0.02" ixy="0.001" ixz="0" iyy="0.03" iyz="0" izz="0.02"/></inertial>
  </link>
  <link name="lower"><inertial><mass value="1.2"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <link name="finger"><inertial><mass value="0.2"/>
    <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial></link>
  <joint name="hinge" type="revolute"><parent link="stand"/><child link="upper"/>
    <origin xyz="0 0 0.4" rpy="0 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="9" velocity="1"/></joint>
  <joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/>
    <origin xyz="0 0 0.5" rpy="0 0.1 0"/><axis xyz="0 1 0"/></joint>
  <joint name="slide" type="prismatic"><parent link="lower"/><child link="finger"/>
    <origin xyz="0 0 0.3"/><axis xyz="0 0 1"/><limit effort="1" velocity="1" lower="0" upper="1"/>
    <mimic joint="elbow" multiplier="0.1" offset="0.02"/></joint>
</robot>
"""
DRIVE = "time_s,hinge\n0,0.1\n0.01,0.1\n0.03,0.105\n0.05,0.11\n"
MJCF = """<mujoco model="robot"><worldbody><body name="rod"><joint name="hinge" type="hinge" axis="0 1 0"/>
  <inertial pos="0 0 1" mass="2" diaginertia="0.01 0.2 0.2"/></body></worldbody></mujoco>
"""
ROBOT = """<robot name="one"><link name="stand"/><link name="rod"/><joint name="hinge" type="continuous">
  <parent link="stand"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>
"""
POSES = """format = "flexarm-record/1"
kind = "static"
drive = ["hinge"]
[[signals]]
name = "hinge"
quantity = "joint_angle"
joint = "hinge"
side = "motor"
file = "poses.csv"
pose = "pose"
channels = ["hinge_rad"]
noise_std = 1e-5
[[signals]]
name = "tip"
quantity = "position"
point = "tip"
axes = ["x", "z"]
file = "poses.csv"
pose = "pose"
channels = ["x", "z"]
noise_std = 1e-4
"""


def make(folder: Path) -> None:
    from flexarm.cli.run import run

    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)

    def flexarm(*words: str) -> None:
        assert run(list(words)) == 0, words

    example = folder / "example"
    flexarm("example", str(example))
    _shorten(example)
    arm = str(example / "arm.toml")
    (folder / "drive.csv").write_text(DRIVE)
    (folder / "arm.urdf").write_text(URDF)
    (folder / "crane.toml").write_text(MODEL)
    for name in ("three_joints.toml", "telescopic_crane.toml"):
        shutil.copy(ROOT / "examples" / name, folder / name)
    flexarm("simulate", arm, "--drive", str(folder / "drive.csv"), "--forces", "--out", str(folder / "run"))
    flexarm("linearise", arm, "--modes", "2", "--out", str(folder / "linear.mat"))
    flexarm("linearise", arm, "--modes", "2", "--out", str(folder / "linear.nc"))
    words = ["--interface", "bore=BORE", "--interface", "flange=FLANGE", "--unit", "mm", "--modes", "1"]
    flexarm("reduce", str(example / "bracket.inp"), *words, "--out", str(folder / "element.nc"))
    _beside_the_example(example)
    _results(folder, arm)
    _logs(folder / "logs")
    _meshes(folder)
    _matrices(folder)
    (folder / "done").touch()


def _shorten(example: Path) -> None:
    """Keeps two seconds of the records: what is spoiled is small."""
    shutil.rmtree(example / "other_day")
    for record in ("slow", "fast"):
        for file in (example / record).glob("*.csv"):
            head, *rows = file.read_text().splitlines()
            rows = [row for row in rows if float(row.split(",")[0]) <= 2.0]
            file.write_text("\n".join([head, *rows]) + "\n")


def _beside_the_example(example: Path) -> None:
    """Records of poses and of responses, a study, and files that exports change."""
    rows = [(k, 0.1 * k, 3 * sin(0.1 * k), 3 * cos(0.1 * k)) for k in range(12)]
    _record(example / "poses", POSES, "poses.csv", "pose,hinge_rad,x,z", rows)
    rows = [(f, 0.01 * f, 0.1 / f, 0.99) for f in (0.5 * k for k in range(1, 41))]
    _record(example / "responses", RESPONSES, "frf.csv", "hz,re,im,coherence", rows)
    study = STATIC.replace("n = 50", "n = 8")
    for name, text in {"study.toml": study, "robot.urdf": ROBOT, "robot.xml": MJCF}.items():
        (example / name).write_text(text)


def _record(folder: Path, toml: str, name: str, header: str, rows: list[tuple[float, ...]]) -> None:
    folder.mkdir()
    (folder / "record.toml").write_text(toml)
    (folder / name).write_text(
        "\n".join([header, *(",".join(f"{x:.9g}" for x in row) for row in rows)]) + "\n"
    )


def _logs(folder: Path) -> None:
    """A log of each format and the map that reads it, named after it."""
    from log_files import FORMATS, map_of

    folder.mkdir()
    for name, (write, joint, tip) in FORMATS.items():
        write(folder / name)
        (folder / f"{name}.toml").write_text(map_of(name, joint, tip))


def _results(folder: Path, arm: str) -> None:
    import flexarm

    model = flexarm.Arm.from_toml(arm)
    flexarm.static(model, {"hinge": 0.3}).save(folder / "statics.nc")
    flexarm.modes(model, {"hinge": 0.3}).save(folder / "modes.nc")
    flexarm.Stepper(model, {"hinge": "torque"}).start().save(folder / "state.npz")
    record = flexarm.Record.load(Path(arm).parent / "slow")
    flexarm.diagnose(model, [record], n_jobs=1).save(folder / "diagnosis")
    flexarm.calibrate(model, [record], n_jobs=1).save(folder / "fit")
    flexarm.campaign(Path(arm).parent / "study.toml", folder / "study", n_jobs=1)


def _meshes(folder: Path) -> None:
    import mesh_files
    import meshlane

    from flexarm.solids import ring

    for name, text in {
        "bar.inp": mesh_files.ABAQUS_BAR,
        "assembly.inp": mesh_files.ABAQUS_ASSEMBLY,
        "bar.bdf": mesh_files.NASTRAN_BAR,
        "four.msh": mesh_files.GMSH_TETRAHEDRA,
        "newer.msh": mesh_files.GMSH_4,
    }.items():
        (folder / name).write_text(text)
    part = ring(0.1, 0.2, 0.1, size=0.1, around=8, order=1)
    mesh = meshlane.Mesh(part.points, [("hexahedron", part.cells["hex8"])])
    with contextlib.redirect_stderr(io.StringIO()):  # it warns of the size that texts have
        meshlane.vtu.write(str(folder / "ring.vtu"), mesh, binary=False)
    meshlane.write(folder / "packed.vtu", mesh)


def _matrices(folder: Path) -> None:
    from foreign_parts import market, write_dmig, write_grids
    from parts import frame_part

    part = frame_part(n_modes=0)
    market(folder, part, ("K", "M"))
    write_dmig(folder / "part.pch", part)
    write_grids(folder / "grids.bdf", part)


if __name__ == "__main__":
    make(Path(sys.argv[1]))
