"""Whatever a damaged file holds, a reader gives an object or an `InvalidFile` that names the file."""

import shutil
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from foreign_parts import POINTS, market, write_dmig, write_grids
from mesh_files import ABAQUS_BAR, GMSH_4, GMSH_TETRAHEDRA, NASTRAN_BAR
from mutations import mutated
from parts import frame_part

from flexarm import (
    Arm,
    Drive,
    InvalidFile,
    Modes,
    Record,
    Simulation,
    State,
    Statics,
    Stepper,
    SuperElement,
    accept_matrices,
    linearise,
    modes,
    read_mesh,
    simulate,
    static,
)
from flexarm.linear.linear_model import LinearModel

COPIES = 24
"""Damaged copies for each reader; `make torture` takes more."""
URDF = """<robot name="arm"><link name="base"/><link name="rod"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
<limit effort="1" velocity="1" lower="-1" upper="1"/></joint></robot>
"""

Reader = Callable[[Path], Any]


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory, model_text: str, record_files: dict[str, str]) -> Path:
    """A directory with one sound file for each reader."""
    folder = tmp_path_factory.mktemp("sound")
    (folder / "arm.toml").write_text(model_text)
    arm = Arm.from_toml(folder / "arm.toml")
    texts = {"bar.inp": ABAQUS_BAR, "bar.bdf": NASTRAN_BAR, "2.msh": GMSH_TETRAHEDRA, "4.msh": GMSH_4}
    drive = "time_s,hinge\n" + "".join(f"{0.01 * t},{0.1 * t}\n" for t in range(9))
    texts |= {"arm.urdf": URDF, "drive.csv": drive, **record_files}
    for name, text in texts.items():
        (folder / name).write_text(text)
    simulate(arm, Drive.from_csv(folder / "drive.csv", arm), step=0.01, end=0.03).save(
        folder / "simulation.nc"
    )
    static(arm).save(folder / "statics.nc")
    modes(arm, count=2).save(folder / "modes.nc")
    model = linearise(arm, modes=2)
    model.save(folder / "linear.nc")
    model.save(folder / "linear.mat")
    Stepper(arm, {"hinge": "motor"}).start().save(folder / "state.npz")
    part = frame_part(n_modes=0)
    part.save(folder / "part.nc")
    market(folder, part, ("K", "M"))
    write_dmig(folder / "part.pch", part)
    write_grids(folder / "grids.bdf", part)
    return folder


def _matrices(path: Path) -> Any:
    K = path.parent / ("K.mtx" if path.suffix == ".mtx" else path.name)
    extra = {"mass_matrix": K.parent / "M.mtx", "order": "11 7 23"} if path.suffix == ".mtx" else {}
    return accept_matrices(K, grids=path.parent / "grids.bdf", interfaces=POINTS, unit="mm", **extra)


READERS: dict[str, Reader] = {
    "arm.toml": Arm.from_toml,
    "arm.urdf": Arm.from_toml,
    "simulation.nc": Simulation.load,
    "statics.nc": Statics.load,
    "modes.nc": Modes.load,
    "linear.nc": LinearModel.load,
    "linear.mat": LinearModel.load,
    "state.npz": State.load,
    "part.nc": SuperElement.load,
    "K.mtx": _matrices,
    "part.pch": _matrices,
    "grids.bdf": lambda path: _matrices(path.parent / "part.pch"),
    "bar.inp": lambda path: read_mesh(path, unit="mm"),
    "bar.bdf": lambda path: read_mesh(path, unit="mm"),
    "2.msh": lambda path: read_mesh(path, unit="mm"),
    "4.msh": lambda path: read_mesh(path, unit="mm"),
    "drive.csv": lambda path: Drive.from_csv(path, Arm.from_toml(path.parent / "arm.toml")),
    "record.toml": Record.load,
    "encoder.csv": lambda path: Record.load(path.parent),
}


@pytest.mark.parametrize("name", READERS)
def test_a_damaged_file_is_read_or_refused(sound: Path, tmp_path: Path, name: str) -> None:
    shutil.copytree(sound, tmp_path, dirs_exist_ok=True)
    file, read = tmp_path / name, READERS[name]
    content = file.read_bytes()
    read(file)
    refused = 0
    for how, damaged in mutated(content, 7, COPIES):
        file.write_bytes(damaged)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                read(file)
        except InvalidFile as error:
            refused += 1
            assert str(tmp_path) in error.file, how
            assert str(error).isprintable(), how
    assert refused


def test_texts_that_the_hdf5_library_reads_for_ever_are_refused(sound: Path, tmp_path: Path) -> None:
    """A free object of size zero in the collection of texts, in a file without a checksum."""
    content = bytearray((sound / "part.nc").read_bytes().partition(b"flexarm CRC-32")[0])
    start = content.index(b"GCOL")
    end = start + int.from_bytes(content[start + 8 : start + 16], "little")
    content[start + 16 : end] = bytes(end - start - 16)
    (tmp_path / "part.nc").write_bytes(content)
    with pytest.raises(InvalidFile, match="texts in it have no end"):
        SuperElement.load(tmp_path / "part.nc")
