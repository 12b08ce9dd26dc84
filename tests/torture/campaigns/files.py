"""Damaged files over all readers: each gives what it should or says what is wrong, whatever the bytes."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from log_files import FORMATS
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


def _in(name: str) -> Callable[[Path], object]:
    """A reader of the directory that a file lies in."""
    return lambda path: _library(name)(path.parent)


def _logged(map_: str) -> Callable[[Path], object]:
    """What a map makes of a log, and what is guessed of a log that is one file."""

    def read(path: Path) -> object:
        from flexarm import import_record
        from flexarm.importing.guess import guess_map

        if path.name != map_ and path.parent.name == "logs":
            guess_map([path], Path("crane.toml"), Path("guess.toml"))
        return import_record(f"logs/{map_}").check()

    return read


def _of_logs() -> dict[str, Reader]:
    """Readers of logs by file, each with its map; a map reads a text."""
    found = {}
    for name in (*(name for name in FORMATS if not name.startswith("ros2")), *IN_FOLDERS):
        log = name.partition("/")[0]
        others = [f"logs/{other}" for other in IN_FOLDERS if other.startswith(f"{log}/") and other != name]
        beside = ("crane.toml", f"logs/{log}.toml", *others)
        found[f"logs/{name}"] = Reader("import_record", _logged(f"{log}.toml"), beside)
    text = "motive.csv"
    found[f"logs/{text}.toml"] = Reader("import_record", _logged(f"{text}.toml"), (f"logs/{text}",))
    return found


IN_FOLDERS = (
    *("ros2_mcap/metadata.yaml", "ros2_mcap/ros2_mcap.mcap"),
    *("ros2_sqlite/metadata.yaml", "ros2_sqlite/ros2_sqlite.db3"),
)
"""Logs that are folders of files."""


def _campaign(path: Path) -> object:
    from flexarm import Campaign

    found = Campaign.load(path.parent)
    with found.dataset as data:
        return found.summary(), list(data)


def _study(path: Path) -> object:
    from flexarm.campaigns.plan import planned

    return planned(path).remarks


def _exported(name: str) -> Callable[[Path], object]:
    """What changes a file of another program."""

    def read(path: Path) -> object:
        import flexarm

        return getattr(flexarm, name)(flexarm.Arm.from_toml("example/arm.toml"), path, "new.xml")

    return read


FIT = ("fit/calibration.json", "fit/updated.toml", "fit/gaps.nc")
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
    "diagnosis/report.json": Reader("Diagnosis.load", _in("Diagnosis.load"), ("diagnosis/updated.toml",)),
    "fit/calibration.json": Reader("Calibration.load", _in("Calibration.load"), FIT),
    "fit/gaps.nc": Reader("Calibration.load", _in("Calibration.load"), FIT),
    "study/study.json": Reader("Campaign.load", _campaign, ("study/results.nc",)),
    "study/results.nc": Reader("Campaign.load", _campaign, ("study/study.json",)),
    "example/study.toml": Reader("campaign", _study, ("example/arm.toml",)),
    "example/robot.urdf": Reader("export_urdf", _exported("export_urdf"), ("example/arm.toml",)),
    "example/robot.xml": Reader("export_mjcf", _exported("export_mjcf"), ("example/arm.toml",)),
    **_of_logs(),
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
    step = Step(f"{reader.label}({name!r})", lambda: reader.read(Path(name)), writes=("new.xml",))
    return Case(f"{name}, {how}", (step,), files)


CAMPAIGN = Campaign("files", "damaged files, over all readers", case, 60_000, 250)
