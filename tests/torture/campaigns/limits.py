"""Small files that ask for much: declared sizes, compressed zeros, rings, devices, depth, great numbers."""

from __future__ import annotations

import os
import random
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np

from torture.campaign import Campaign
from torture.sandbox import Case, Step, command

REDUCE = ("--interface", "a=foot", "--interface", "b=body", "--unit", "mm", "--modes", "1", "--out", "new.nc")
LARGEST = 10_000_000
"""Bytes that a file may have here."""


def mesh(name: str, content: str | bytes) -> Case:
    """A case that reduces a mesh."""
    steel = () if name.endswith("inp") else ("--material", "E=210000,nu=0.3,rho=7.8e-9")
    step = command("reduce", name, *REDUCE, *steel, writes=("new.nc",))
    return Case(name, (step,), {name: content if isinstance(content, bytes) else content.encode()})


def model(content: str, prepare: Callable[[], object] | None = None, **files: bytes) -> Case:
    """A case that checks, and holds, a model."""
    steps = (command("check", "arm.toml"), command("static", "arm.toml"))
    files = {name.replace("_", "."): value for name, value in files.items()}
    return Case("arm.toml", steps, {"arm.toml": content.encode(), **files}, prepare)


def record(seeds: Path, prepare: Callable[[], object] | None = None, **files: bytes) -> Case:
    """A case that checks a record, by itself and with its model."""
    right = {f"slow/{path.name}": path.read_bytes() for path in (seeds / "example" / "slow").iterdir()}
    right["arm.toml"] = (seeds / "example" / "arm.toml").read_bytes()
    changed = {f"slow/{name.replace('_', '.')}": content for name, content in files.items()}
    steps = (
        command("check", "slow"),
        command("check", "arm.toml", "slow"),
        command("compare", "arm.toml", "slow"),
    )
    return Case("slow", steps, right | changed, prepare)


def loads(name: str, path: str, prepare: Callable[[], object] | None, content: bytes | None = None) -> Case:
    """A case that loads a result by the class of this name."""

    def load() -> None:
        import flexarm

        getattr(flexarm, name).load(path)

    return Case(
        path, (Step(f"{name}.load({path!r})", load),), {} if content is None else {path: content}, prepare
    )


def vtu(data: str, points: str = "9", more: str = "") -> str:
    return (
        '<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"'
        f'{more}><UnstructuredGrid><Piece NumberOfPoints="{points}" NumberOfCells="1"><Points>{data}</Points>'
        '<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3</DataArray></Cells>'
        "</Piece></UnstructuredGrid></VTKFile>"
    )


def hdf5_bomb(variable: str, shape: tuple[int, ...]) -> Callable[[], None]:
    """Puts a compressed variable of zeros, gigabytes of them, into file.nc."""

    def make() -> None:
        import h5py

        with h5py.File("file.nc", "a") as file:
            if variable in file:
                del file[variable]
            file.create_dataset(
                variable, shape, "f8", compression="gzip", chunks=(1000, *shape[1:]), fillvalue=0.0
            )
            file[variable][:1] = 1.0

    return make


def many_attributes() -> None:
    import h5py

    with h5py.File("file.nc", "a") as file:
        deep = "[" * 20000 + "]" * 20000
        file.attrs["model"] = f"x = {deep}"


def mat_bomb() -> bytes:
    """A MAT file of 5 with a compressed matrix of a gigabyte of zeros."""
    size = 1 << 30
    flags = np.array([6, 8, 6, 0, 5, 8, 1 << 13, 1 << 14, 1, 1], "<u4").tobytes() + b"A" + bytes(7)
    head = (
        np.array([14, len(flags) + 8 + size], "<u4").tobytes() + flags + np.array([9, size], "<u4").tobytes()
    )
    packer = zlib.compressobj(9)
    packed = (
        packer.compress(head) + b"".join(packer.compress(bytes(1 << 24)) for _ in range(64)) + packer.flush()
    )
    text = b"MATLAB 5.0 MAT-file".ljust(116) + bytes(8) + b"\x00\x01IM"
    return text + np.array([15, len(packed)], "<u4").tobytes() + packed


def npz_bomb() -> None:
    np.savez_compressed("state.npz", format=np.zeros(200_000_000))


def fifo(name: str) -> Callable[[], object]:
    return lambda: ((Path(name).unlink(missing_ok=True)), os.mkfifo(name))


def link(name: str, target: str) -> Callable[[], object]:
    return lambda: (Path(name).unlink(missing_ok=True), Path(name).symlink_to(target))


def chain(n: int, link: str) -> str:
    """A model of a chain of so many joints and links."""
    joints = (
        f'[[joints]]\nname = "j{i}"\ntype = "revolute"\nparent = "{f"l{i - 1}" if i else "base"}"\n'
        f'child = "l{i}"\naxis = [0, 1, 0]\norigin = {{ xyz = [0, 0, 0.001] }}\n'
        f'[[links]]\nname = "l{i}"\n{link}\n'
        for i in range(n)
    )
    return 'format = "flexarm-arm/1"\n' + "".join(joints)


RIGID = 'type = "rigid"\nmass = 0.1\ninertia = [1e-3, 1e-3, 1e-3]'
NODES = (
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n1 0 0 0\n$EndNodes\n"
    "$Elements\n{}\n1 15 2 4 1 1\n$EndElements\n"
)
BINARY = (
    b"$MeshFormat\n4.1 1 8\n\x01\x00\x00\x00\n$EndMeshFormat\n$Nodes\n"
    + b"\xff\xff\xff\x7f\x00\x00\x00\x00" * 8
)
PART = chain(1, "").replace("l0", "l")
ENTITIES = '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa">' + "".join(
    f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefghij", "bcdefghijk", strict=True)
)


def cases(seeds: Path) -> dict[str, Callable[[], Case]]:
    """Cases by name."""
    crane = (seeds / "crane.toml").read_text()
    urdf = (seeds / "arm.urdf").read_text()
    inp = (seeds / "bar.inp").read_text()
    newer = (seeds / "newer.msh").read_text()
    rows = "\n".join(f"{i * 1e-5:.5f},0.3" for i in range(600_000))
    result = {name: (seeds / name).read_bytes() for name in ("statics.nc", "element.nc", "linear.nc")}
    simulation = (seeds / "run" / "simulation.nc").read_bytes()
    long = record(seeds, hinge_csv=f"time_s,hinge_rad\n{rows}\n".encode())
    return {
        "msh: 2e9 nodes declared": lambda: mesh("a.msh", NODES.format(2_000_000_000, 1)),
        "msh: 2e9 elements declared": lambda: mesh("a.msh", NODES.format(1, 2_000_000_000)),
        "msh: 1e30 nodes declared": lambda: mesh("a.msh", NODES.format(10**30, 1)),
        "msh: binary sizes": lambda: mesh("a.msh", BINARY),
        "msh: a node of number 2e9": lambda: mesh(
            "a.msh", NODES.format(1, 1).replace("1 0 0 0", "2000000000 0 0 0")
        ),
        "msh: entities declared": lambda: mesh(
            "a.msh",
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n9999999999 0 0 0\n$EndEntities\n"
            "$Nodes\n99999999 999999999 1 999999999\n3 2 0 99999999\n",
        ),
        **{
            f"msh: {old} becomes {new}": lambda old=old, new=new: mesh("a.msh", newer.replace(old, new, 1))
            for old, new in (
                ("1 5 1 8", "1 5 1 800000000"),
                ("1 5 1 8", "1 500000000 1 8"),
                ("1 5 1 8", "100000000 5 1 8"),
                ("\n8\n0 0 0", "\n800000000\n0 0 0"),
                ("2 3 10 31", "2 300000000 10 31"),
                ("2 3 10 31", "2 3 10 900000000"),
                ("\n31 2", "\n900000000 2"),
            )
        },
        "inp: generate 2e9": lambda: mesh("a.inp", inp.replace("15, 18, 1", "1, 2000000000, 1")),
        "inp: a ring of sets": lambda: mesh("a.inp", inp + "*NSET, NSET=foot\nfoot\n"),
        "inp: includes itself": lambda: mesh("a.inp", "*INCLUDE, INPUT=a.inp\n*INCLUDE, INPUT=a.inp\n" + inp),
        "inp: includes a device": lambda: mesh("a.inp", "*INCLUDE, INPUT=/dev/zero\n" + inp),
        "inp: a line of 9 MB": lambda: mesh("a.inp", "*NODE\n1, " + "0" * 9_000_000 + "\n"),
        "inp: 100000 sets": lambda: mesh(
            "a.inp", inp + "".join(f"*NSET, NSET=s{i}\n1\n" for i in range(100_000))
        ),
        "inp: nested parts": lambda: mesh("a.inp", "*PART, NAME=p\n" * 200_000 + inp),
        "bdf: THRU 2e9": lambda: mesh(
            "a.bdf", "BEGIN BULK\nSET 1 = 1 THRU 2000000000\nSPC1,1,123,1,THRU,2000000000\n"
        ),
        "bdf: includes itself": lambda: mesh("a.bdf", "INCLUDE 'a.bdf'\n" * 3),
        "bdf: includes a tree": lambda: include_tree(),
        "vtu: 2e9 points declared": lambda: mesh("a.vtu", vtu("", "2000000000")),
        "vtu: packed zeros": lambda: mesh("a.vtu", packed_vtu()),
        "vtu: entities": lambda: mesh("a.vtu", ENTITIES + "]><r>&k;</r>"),
        "vtu: depth": lambda: mesh("a.vtu", "<a>" * 500_000),
        "urdf: entities": lambda: model_urdf(ENTITIES + "]>" + urdf.split("?>")[1].replace('"two"', '"&k;"')),
        "urdf: depth": lambda: model_urdf("<robot name='x'>" + "<link name='a'>" * 300_000),
        "urdf: 30000 links": lambda: model_urdf(
            "<robot name='x'>" + "".join(f"<link name='l{i}'/>" for i in range(30_000)) + "</robot>"
        ),
        "toml: depth of arrays": lambda: model(crane + "\na = " + "[" * 4_000_000),
        "toml: depth of tables": lambda: model(crane + "\n[" + ".".join("a" * 100_000) + "]"),
        "toml: dotted keys": lambda: model(
            crane + "\n" + "".join(f"a{i}.b.c.d = 1\n" for i in range(100_000))
        ),
        "toml: a text of 9 MB": lambda: model(crane.replace('"crane"', f'"{"x" * 9_000_000}"')),
        "toml: 9 MB of zeros": lambda: model("\x00" * 9_000_000),
        "toml: 3000 wrong links": lambda: model(
            crane + '\n[[links]]\nname = "rod"\ntype = "rigid"\nmass = -1' * 3000
        ),
        "toml: 1e9 elements": lambda: model(crane.replace("elements = 4", "elements = 1000000000")),
        "toml: 1000 wrong joints": lambda: model(
            chain(1000, RIGID).replace('type = "revolute"', 'type = "x"')
        ),
        "toml: a chain of 1000": lambda: model(chain(1000, RIGID)),
        "toml: a chain of 2000 checked": lambda: Case(
            "arm.toml", (command("check", "arm.toml"),), {"arm.toml": chain(2000, RIGID).encode()}
        ),
        "toml: a FIFO": lambda: model("", fifo("arm.toml")),
        "toml: a device": lambda: model("", link("arm.toml", "/dev/zero")),
        "toml: a link to itself": lambda: model("", link("arm.toml", "arm.toml")),
        "toml: a directory": lambda: model("", lambda: (Path("arm.toml").unlink(), Path("arm.toml").mkdir())),
        "part: a device": lambda: model(PART + 'type = "superelement"\nfile = "/dev/zero"\n'),
        "part: a FIFO": lambda: model(PART + 'type = "superelement"\nfile = "x"\n', lambda: os.mkfifo("x")),
        "part: compressed zeros": lambda: model(
            PART + 'type = "superelement"\nfile = "file.nc"\n',
            hdf5_bomb("stiffness", (20_000, 20_000)),
            file_nc=result["element.nc"],
        ),
        "csv: 600000 rows": lambda: long,
        "csv: a line of 9 MB": lambda: record(seeds, hinge_csv=b"time_s,hinge_rad\n0," + b"1" * 9_000_000),
        "csv: a header of 9 MB": lambda: record(seeds, hinge_csv=b"x" * 9_000_000),
        "csv: 1000000 columns": lambda: record(seeds, hinge_csv=(b"a," * 1_000_000 + b"\n") * 2),
        "csv: 4 MB of line ends": lambda: record(seeds, hinge_csv=b"time_s,hinge_rad\n" + b"\n" * 4_000_000),
        "csv: 4 MB of quotes": lambda: record(seeds, hinge_csv=b'time_s,hinge_rad\n"' + b'""' * 2_000_000),
        "csv: a FIFO": lambda: record(seeds, fifo("slow/hinge.csv")),
        "csv: a device": lambda: record(seeds, link("slow/hinge.csv", "/dev/zero")),
        "csv: a random device": lambda: record(seeds, link("slow/hinge.csv", "/dev/urandom")),
        "csv: a link to itself": lambda: record(seeds, link("slow/hinge.csv", "hinge.csv")),
        "csv: a record's FIFO": lambda: record(seeds, fifo("slow/record.toml")),
        "nc: compressed zeros in statics": lambda: loads(
            "Statics", "file.nc", hdf5_bomb("position", (300_000_000, 3)), result["statics.nc"]
        ),
        "nc: compressed zeros in a run": lambda: loads(
            "Simulation", "file.nc", hdf5_bomb("time", (600_000_000,)), simulation
        ),
        "nc: compressed zeros in a part": lambda: loads(
            "SuperElement", "file.nc", hdf5_bomb("mass", (20_000, 20_000)), result["element.nc"]
        ),
        "nc: compressed zeros in matrices": lambda: loads(
            "LinearModel", "file.nc", hdf5_bomb("A", (20_000, 20_000)), result["linear.nc"]
        ),
        "nc: depth of an attribute": lambda: loads(
            "Statics", "file.nc", many_attributes, result["statics.nc"]
        ),
        "nc: a FIFO": lambda: loads("Statics", "file.nc", fifo("file.nc")),
        "nc: a device": lambda: loads("Simulation", "file.nc", link("file.nc", "/dev/zero")),
        "mat: compressed zeros": lambda: loads("LinearModel", "a.mat", None, mat_bomb()),
        "npz: compressed zeros": lambda: loads("State", "state.npz", npz_bomb),
        "json: depth": lambda: loads("Diagnosis", "why/report.json", None, b"[" * 3_000_000),
        "mtx: 2e9 rows declared": lambda: matrix(
            "%%MatrixMarket matrix coordinate real symmetric\n" + "2000000000 " * 2 + "1\n1 1 1\n"
        ),
        "mtx: a full matrix declared": lambda: matrix(
            "%%MatrixMarket matrix array real general\n100000 100000\n1\n"
        ),
        "mtx: 1e30 entries declared": lambda: matrix(
            f"%%MatrixMarket matrix coordinate real symmetric\n18 18 {10**30}\n"
        ),
        "drive: 500000 rows": lambda: Case(
            "drive.csv",
            (
                command(
                    "simulate",
                    "arm.toml",
                    "--drive",
                    "drive.csv",
                    "--step",
                    "1",
                    "--out",
                    "run",
                    writes=("run",),
                ),
            ),
            {"arm.toml": crane.encode(), "drive.csv": ("time_s,hinge\n" + rows).encode()},
        ),
        "drive: 1e9 seconds": lambda: Case(
            "drive.csv",
            (command("simulate", "arm.toml", "--drive", "drive.csv", "--out", "run", writes=("run",)),),
            {"arm.toml": crane.encode(), "drive.csv": b"time_s,hinge\n0,0\n1,0\n2,0\n1e9,1\n"},
        ),
    }


def model_urdf(content: str) -> Case:
    return Case("arm.urdf", (command("check", "arm.urdf"),), {"arm.urdf": content.encode()})


def include_tree() -> Case:
    """Files that each include the next one twice: 2^40 of them read."""
    case = mesh("a.bdf", "INCLUDE '0.bdf'\n")
    tree = {f"{i}.bdf": f"INCLUDE '{i + 1}.bdf'\nINCLUDE '{i + 1}.bdf'\n".encode() for i in range(40)}
    return Case(case.kind, case.steps, {**case.files, **tree, "40.bdf": b"GRID,1\n"})


def matrix(content: str) -> Case:
    words = ("--grids", "grids.bdf", "--mass-matrix", "K.mtx", "--order", "11 7 23", "--interface", "a=11")
    step = command("reduce", "K.mtx", *words, "--out", "new.nc", writes=("new.nc",))
    grids = b"BEGIN BULK\nGRID,11,,0.,0.,0.\nGRID,7,,1.,0.,0.\nGRID,23,,0.,1.,0.\nENDDATA\n"
    return Case("K.mtx", (step,), {"K.mtx": content.encode(), "grids.bdf": grids})


def packed_vtu() -> str:
    """Points of which a gigabyte of zeros is packed into a megabyte."""
    import base64

    block = zlib.compress(bytes(1 << 24), 9)
    head = np.array([64, 1 << 24, 0, *[len(block)] * 64], "<u4").tobytes()
    data = (base64.b64encode(head) + base64.b64encode(block * 64)).decode()
    array = f'<DataArray type="Float64" NumberOfComponents="3" format="binary">{data}</DataArray>'
    return vtu(array, str((1 << 30) // 24), ' header_type="UInt32" compressor="vtkZLibDataCompressor"')


def case(number: int, rng: random.Random, seeds: Path) -> Case:
    made = cases(seeds)
    name = random.Random(0).sample(list(made), len(made))[number % len(made)]
    found = made[name]()
    assert all(len(content) <= LARGEST for content in found.files.values()), name
    return Case(name, found.steps, found.files, found.prepare, found.wall)


CAMPAIGN = Campaign("limits", "small files that ask for much", case, 73, 24)
