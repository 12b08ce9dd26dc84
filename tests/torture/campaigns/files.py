"""Damaged files over all readers: each gives what it should or says what is wrong, whatever the bytes."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from mutations import mutated

from torture.campaign import Campaign
from torture.sandbox import Case, Step


@dataclass(frozen=True)
class Reader:
    """What reads a file; `beside` are files that it needs as well."""

    label: str
    read: Callable[[Path], object]
    beside: tuple[str, ...] = ()


def _library(name: str) -> Callable[[Path], object]:
    """A reader of flexarm's, imported when it is used."""

    def read(path: Path) -> object:
        import flexarm

        found: object = flexarm
        for part in name.split("."):
            found = getattr(found, part)
        return found(path)  # type: ignore[operator]

    return read


def _model(path: Path) -> object:
    from flexarm import Arm

    arm = Arm.from_toml(path)
    return list(arm.warnings), arm.summary()


def _record(path: Path) -> object:
    from flexarm import Record

    record = Record.load(path.parent)
    return record.check(), repr(record)


def _drive(path: Path) -> object:
    from flexarm import Arm, Drive

    return Drive.from_csv(path, Arm.from_toml("crane.toml"))


def _matrices(path: Path) -> object:
    from flexarm import accept_matrices

    order = None if path.suffix == ".pch" or Path("part.pch").exists() else "11 7 23"
    if Path("part.pch").exists():
        return accept_matrices("part.pch", grids="grids.bdf", unit="mm")
    return accept_matrices("K.mtx", "M.mtx", grids="grids.bdf", order=order, unit="mm")


def _diagnosis(path: Path) -> object:
    from flexarm import Diagnosis

    return Diagnosis.load(path.parent)


CSV = ("record.toml", "hinge.csv", "torque.csv", "tip.csv", "mid.csv")
RECORD = tuple(f"example/slow/{name}" for name in CSV)
MESH = Reader("read_mesh", _library("read_mesh"))
MARKET = Reader("accept_matrices", _matrices, ("K.mtx", "M.mtx", "grids.bdf"))
NASTRAN = Reader("accept_matrices", _matrices, ("part.pch", "grids.bdf"))
LINEAR = Reader("LinearModel.load", _library("LinearModel.load"))
READERS: dict[str, Reader] = {
    "crane.toml": Reader("Arm.from_toml", _model),
    "arm.urdf": Reader("Arm.from_toml", _model),
    **{name: Reader("Record.load", _record, RECORD) for name in RECORD},
    "drive.csv": Reader("Drive.from_csv", _drive, ("crane.toml",)),
    "run/simulation.nc": Reader("Simulation.load", _library("Simulation.load")),
    "statics.nc": Reader("Statics.load", _library("Statics.load")),
    "modes.nc": Reader("Modes.load", _library("Modes.load")),
    "element.nc": Reader("SuperElement.load", _library("SuperElement.load")),
    "linear.nc": LINEAR,
    "linear.mat": LINEAR,
    "state.npz": Reader("State.load", _library("State.load")),
    "diagnosis/report.json": Reader("Diagnosis.load", _diagnosis, ("diagnosis/updated.toml",)),
    **dict.fromkeys(
        ("bar.inp", "assembly.inp", "bar.bdf", "four.msh", "newer.msh", "ring.vtu", "packed.vtu"), MESH
    ),
    "K.mtx": MARKET,
    "M.mtx": MARKET,
    "part.pch": NASTRAN,
    "grids.bdf": NASTRAN,
}


def case(number: int, rng: random.Random, seeds: Path) -> Case:
    name = list(READERS)[number % len(READERS)]
    reader = READERS[name]
    files = {beside: (seeds / beside).read_bytes() for beside in reader.beside}
    *_, (how, files[name]) = mutated((seeds / name).read_bytes(), rng.randrange(1 << 30), rng.randint(1, 8))
    step = Step(f"{reader.label}({name!r})", lambda: reader.read(Path(name)))
    return Case(f"{name}, {how}", (step,), files)


CAMPAIGN = Campaign("files", "damaged files, over all readers", case, 60_000, 250)
