"""Files that never end, unfold without end, lead elsewhere or hold control characters are refused."""

import os
import re
import struct
import subprocess
import sys
import tracemalloc
import zipfile
import zlib
from base64 import b64encode
from contextlib import suppress
from itertools import chain
from pathlib import Path

import h5py
import meshlane
import numpy as np
import pytest
from mesh_files import GMSH_4, GMSH_TETRAHEDRA
from parts import frame_part

from flexarm import Arm, InvalidFile, Record, Simulation, State, SuperElement, read_mesh
from flexarm.errors import Problem
from flexarm.linear.matlab import check_mat, read_mat
from flexarm.reading import regular_file
from flexarm.solids import ring


@pytest.mark.parametrize("read", [Arm.from_toml, Simulation.load, State.load, SuperElement.load, read_mesh])
@pytest.mark.parametrize("kind", ["pipe", "device", "circle", "null byte", "directory", "long name"])
def test_only_regular_files_are_opened(tmp_path: Path, read: object, kind: str) -> None:
    path = tmp_path / "file.inp"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "device":
        path.symlink_to("/dev/zero")
    elif kind == "circle":
        path.symlink_to(path)
    elif kind == "directory":
        path.mkdir()
    else:
        path = tmp_path / ("a\0b" if kind == "null byte" else 300 * "a")
    with pytest.raises(InvalidFile, match=r"file: (cannot be read|is no regular file|is a directory)"):
        read(path)  # type: ignore[operator]


def test_a_damaged_mat_file_does_not_end_the_program(tmp_path: Path) -> None:
    """Sizes of elements are changed one by one; in a process of its own, for SciPy's reader would end it."""
    script = """
import struct, sys
import numpy as np
from scipy.io import savemat
from flexarm import InvalidFile
from flexarm.linear.matlab import read_mat
savemat("a.mat", {"A": np.eye(3), "kind": "linear model"})
sound = open("a.mat", "rb").read()
for at in range(128, len(sound) - 4, 4):
    for value in (0, 1, 7, 0x00040001, 2**31 - 1, 2**32 - 1):
        open("a.mat", "wb").write(sound[:at] + struct.pack("<I", value) + sound[at + 4 :])
        try:
            read_mat("a.mat")
        except InvalidFile:
            pass
"""
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_a_struct_that_overruns_what_holds_it_is_refused(tmp_path: Path) -> None:
    """SciPy's reader ends the program on some such files."""
    from scipy.io import savemat

    savemat(tmp_path / "a.mat", {"rec": {"angle": np.eye(3)}})
    check_mat(tmp_path / "a.mat")
    raw = bytearray((tmp_path / "a.mat").read_bytes())
    at = raw.rindex(struct.pack("<2I", 9, 72))  # the nine doubles
    raw[at + 4 : at + 8] = struct.pack("<I", 131)
    (tmp_path / "a.mat").write_bytes(raw)
    with pytest.raises(InvalidFile, match="an element of 131 bytes goes beyond what holds it"):
        check_mat(tmp_path / "a.mat")


@pytest.mark.parametrize("compressed", [False, True])
def test_mat_files_are_read_as_scipy_reads_them(tmp_path: Path, compressed: bool) -> None:
    from scipy.io import savemat

    names = np.empty((2, 1), dtype=object)
    names[:, 0] = ["hinge.angle", "é"]
    values = {"A": np.arange(6.0).reshape(2, 3), "b": np.array([[1, 2]], np.int16), "n": names, "t": "text"}
    savemat(tmp_path / "a.mat", values, do_compression=compressed)
    found = read_mat(tmp_path / "a.mat")
    assert np.array_equal(found["A"], values["A"])
    assert np.array_equal(found["b"], [[1, 2]])
    assert (found["n"], found["t"]) == (["hinge.angle", "é"], "text")


def test_a_mat_file_that_unfolds_without_end_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("flexarm.linear.matlab.SMALL", 2**16)
    packed = zlib.compress(bytes(2**18))
    header = b" " * 124 + b"\x00\x01IM"
    (tmp_path / "a.mat").write_bytes(
        header + (15).to_bytes(4, "little") + len(packed).to_bytes(4, "little") + packed
    )
    with pytest.raises(InvalidFile, match="unfolds to more than 20 times its size"):
        read_mat(tmp_path / "a.mat")


def test_numbers_that_unfold_beyond_their_file_are_refused(tmp_path: Path) -> None:
    frame_part(n_modes=0).save(tmp_path / "part.nc")
    with h5py.File(tmp_path / "part.nc", "a") as file:
        file.create_dataset("bomb", shape=(10**6, 10**6), dtype="f8", chunks=(1000, 1000), compression="gzip")
    with pytest.raises(InvalidFile, match=r"bomb: declares \d+ bytes in a file of \d+"):
        SuperElement.load(tmp_path / "part.nc")


@pytest.mark.parametrize("kind", ["link", "soft link", "storage", "virtual"])
def test_numbers_of_another_file_are_refused(tmp_path: Path, kind: str) -> None:
    frame_part(n_modes=0).save(tmp_path / "part.nc")
    with h5py.File(tmp_path / "other.nc", "w") as file:
        file["mass"] = np.eye(18)
    with h5py.File(tmp_path / "part.nc", "a") as file:
        if kind == "link":
            file["else"] = h5py.ExternalLink("other.nc", "mass")
        elif kind == "soft link":
            file["else"] = h5py.SoftLink("/mass")
        elif kind == "storage":
            file.create_dataset("else", (4,), "u1", external=[("/etc/passwd", 0, 4)])
        else:
            layout = h5py.VirtualLayout((18, 18), "f8")
            layout[:] = h5py.VirtualSource(tmp_path / "other.nc", "mass", (18, 18), "f8")
            file.create_virtual_dataset("else", layout)
    with pytest.raises(InvalidFile, match=r"else: (is a link|lies in another file)"):
        SuperElement.load(tmp_path / "part.nc")


def test_a_state_that_unfolds_beyond_its_file_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("flexarm.reading.SMALL", 2**16)
    with zipfile.ZipFile(tmp_path / "state.npz", "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("state.q.npy", bytes(2**18))
    with pytest.raises(InvalidFile, match="declares 262144 bytes"):
        State.load(tmp_path / "state.npz")


@pytest.mark.parametrize("text", [GMSH_TETRAHEDRA, GMSH_4], ids=["2.2", "4.1"])
def test_a_mesh_of_more_nodes_than_bytes_is_refused(tmp_path: Path, text: str) -> None:
    begin, header, rest = text.partition("$Nodes\n")
    line, _, rest = rest.partition("\n")
    words = line.split()
    words[-3 if len(words) > 1 else 0] = "99999999"
    (tmp_path / "part.msh").write_text(f"{begin}{header}{' '.join(words)}\n{rest}")
    with pytest.raises(InvalidFile, match=r"\$Nodes: declares \d+ entries"):
        read_mesh(tmp_path / "part.msh")


def taken_up(path: Path) -> float:
    """Return the memory [MB] that a mesh takes, or its refusal."""
    tracemalloc.start()
    with suppress(InvalidFile):
        read_mesh(path)
    peak = tracemalloc.get_traced_memory()[1] / 1e6
    tracemalloc.stop()
    return peak


@pytest.mark.parametrize("text", [GMSH_TETRAHEDRA, GMSH_4], ids=["2.2", "4.1"])
def test_no_number_of_a_mesh_takes_up_memory(tmp_path: Path, text: str) -> None:
    path = tmp_path / "part.msh"
    path.write_text(text)
    read_mesh(path)  # imports what it needs
    for number in re.finditer(r"(?<![\d.])\d+(?!\.)", text):
        path.write_text(f"{text[: number.start()]}900000000{text[number.end() :]}")
        assert taken_up(path) < 5, text[: number.end()]


@pytest.mark.parametrize("kind", ["gmsh", "gmsh22"])
def test_no_bytes_of_a_binary_mesh_take_up_memory(tmp_path: Path, kind: str) -> None:
    part = ring(0.1, 0.2, 0.1, size=0.1, around=8, order=1)
    mesh = meshlane.Mesh(part.points, [("hexahedron", part.cells["hex8"])])
    mesh.cell_data = {name: [np.ones(8, int)] for name in ("gmsh:physical", "gmsh:geometrical")}
    mesh.point_data = {"gmsh:dim_tags": np.tile([3, 1], (part.n_points, 1))} if kind == "gmsh" else {}
    path = tmp_path / "part.msh"
    meshlane.write(path, mesh, file_format=kind, binary=True)
    read_mesh(path)
    sound = path.read_bytes()
    places = (range(200), range(sound.index(b"$Elements"), sound.index(b"$Elements") + 100))
    for at in chain(*places):
        path.write_bytes(sound[:at] + struct.pack("<i", 900_000_000) + sound[at + 4 :])
        assert taken_up(path) < 5, at


@pytest.mark.parametrize("kind", ["inline", "appended"])
@pytest.mark.parametrize("honest", [True, False])
def test_a_grid_that_unfolds_beyond_its_file_is_refused(tmp_path: Path, kind: str, honest: bool) -> None:
    """Of 300 MB of zeros in 300 kB, declared or not."""
    block = zlib.compress(bytes(2**20), 9)
    size = 2**20 if honest else 2**10
    head = np.array([300, size, 0, *[len(block)] * 300], "<u4").tobytes()
    data = (b64encode(head) + b64encode(300 * block)).decode()
    about = 'format="binary"' if kind == "inline" else 'format="appended" offset="0"'
    points = f'<DataArray type="Float64" NumberOfComponents="3" {about}>{data if kind == "inline" else ""}'
    appended = "" if kind == "inline" else f'<AppendedData encoding="base64">_{data}</AppendedData>'
    (tmp_path / "part.vtu").write_text(
        '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian" header_type="UInt32" '
        'compressor="vtkZLibDataCompressor"><UnstructuredGrid><Piece NumberOfPoints="1" NumberOfCells="0">'
        f"<Points>{points}</DataArray></Points></Piece></UnstructuredGrid>{appended}</VTKFile>"
    )
    told = (
        "declares 314572800 bytes in a file of"
        if honest
        else "holds a block of more than the 1024 bytes that"
    )
    with pytest.raises(InvalidFile, match=f"DataArray: {told}"):
        read_mesh(tmp_path / "part.vtu")


@pytest.mark.parametrize(
    ("name", "comment", "include"),
    [("part.inp", "** end", "*INCLUDE, INPUT={}\n"), ("part.bdf", "$ end", "INCLUDE '{}'\n")],
)
def test_includes_end(tmp_path: Path, name: str, comment: str, include: str) -> None:
    file = tmp_path / name
    file.write_text(include.format(name))
    with pytest.raises(InvalidFile, match="is being read already"):
        read_mesh(file)
    for level in range(12):  # each includes the next one ten times
        (tmp_path / f"{level}{name}").write_text(10 * include.format(f"{level + 1}{name}"))
    (tmp_path / f"12{name}").write_text(comment)
    file.write_text(include.format(f"0{name}"))
    with pytest.raises(InvalidFile, match="at most 1000 in all"):
        read_mesh(file)


def test_a_record_reads_no_file_outside_its_directory(tmp_path: Path, record_files: dict[str, str]) -> None:
    record = tmp_path / "record"
    record.mkdir()
    for name, text in record_files.items():
        (record / name).write_text(text)
    secret = tmp_path / "secret.csv"
    (record / "encoder.csv").rename(secret)
    (record / "encoder.csv").symlink_to(secret)
    for name in ("encoder.csv", "../secret.csv", str(secret)):
        (record / "record.toml").write_text(record_files["record.toml"].replace("encoder.csv", name))
        with pytest.raises(InvalidFile, match="lies outside the record's directory") as raised:
            Record.load(record)
        assert "encoder_deg" not in str(raised.value)
        assert Record.load(record, allow_outside=True).signals["hinge"].file == name


def test_an_attribute_nested_deep_is_left_alone(tmp_path: Path) -> None:
    frame_part(n_modes=0).save(tmp_path / "part.nc")
    with h5py.File(tmp_path / "part.nc", "a") as file:
        file.attrs["quality"] = 20_000 * "[" + 20_000 * "]"
    assert SuperElement.load(tmp_path / "part.nc").quality == {}


def test_messages_show_no_control_characters_and_no_long_text() -> None:
    problem = Problem("links.a\x1b[2J", f"must be a number, got '{'x' * 5000}\u202e'\n")
    assert str(problem).isprintable()
    assert len(str(problem)) < 300
    error = InvalidFile("a\x1b.toml", problem.where, problem.what)
    assert str(error).isprintable()
    assert all(line.isprintable() for line in error.lines())


def test_a_file_nobody_may_read_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.toml").touch()
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(InvalidFile, match=r"a\.toml: file: cannot be read: Permission denied"):
        regular_file(tmp_path / "a.toml")
