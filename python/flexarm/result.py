"""Common parts of results: provenance and storage."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from flexarm.arguments import takes
from flexarm.configuration import config
from flexarm.errors import InvalidFile
from flexarm.netcdf import Contents, save
from flexarm.pictures import Shown
from flexarm.reading import check_hdf5, reading

if TYPE_CHECKING:
    import xarray as xr

    from flexarm.arm import Arm


class OfArm:
    """Base of arrays that belong to an arm: the names along their axes."""

    arm: Arm

    @property
    def points(self) -> tuple[str, ...]:
        """Names of the points, in the order of the arrays."""
        return tuple(point.name for point in self.arm.points)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, in the order of the arrays."""
        return tuple(joint.name for joint in self.arm.joints)


class Result(OfArm, Shown, ABC):
    """Base of statics, modes and runs: the arm, names, and a file."""

    @abstractmethod
    def contents(self) -> Contents:
        """Return the contents of the file: variables with units, and their provenance."""

    @property
    def dataset(self) -> xr.Dataset:
        """The same as an xarray Dataset with units."""
        return self.contents().dataset()

    @takes()
    def save(self, path: str | Path, inputs: Iterable[Path] = ()) -> None:
        """Write the result as NetCDF, whose name ends in .nc, with the model it was made with.

        A file of that name is replaced, unless it is an input or a super-element of the model.

        Raise InvalidFile if the name ends otherwise or the file cannot be written.
        """
        if Path(path).suffix != ".nc":
            what = f"must end in .nc, got {Path(path).name}; `dataset.to_dataframe()` gives a table"
            raise InvalidFile(path, "path", what)
        save(self.contents(), path, [*self.arm.part_files, *inputs])


AXES = ["x", "y", "z"]


def labels(result: Result) -> dict[str, Sequence[str]]:
    """Return labels of array axes: points, joints, links, components of vectors and forces."""
    return {
        "point": result.points,
        "joint": result.joints,
        "link": [link.name for link in result.arm.links],
        "closure": [closure.name for closure in result.arm.closures],
        "axis": AXES,
        "end": ["start", "end"],
        "component": ["N", "Vy", "Vz", "T", "My", "Mz"],
        "wrench": ["Fx", "Fy", "Fz", "Mx", "My", "Mz"],
    }


def provenance(arm: Arm) -> dict[str, str]:
    """Return attributes of every stored result: versions, backend, model, hashes and time."""
    from flexarm.tables import toml_text

    model = toml_text(arm.to_dict())
    versions = config()
    return {
        "flexarm_version": versions["flexarm"],
        "git": versions["git"],
        "backend": versions["step factorisation"],
        "licence_of_build": versions["licence of this build"],
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "model": model,
        "model_sha256": hashlib.sha256(model.encode()).hexdigest(),
        **{
            f"{link.name}_sha256": hashlib.sha256(Path(link.file).read_bytes()).hexdigest()
            for link in arm.links
            if link.type == "superelement" and Path(link.file).is_file()
        },
    }


def load(path: str | Path, kind: str) -> xr.Dataset:
    """Read the result of a kind that was saved.

    Raise InvalidFile if the file is missing, is no NetCDF file, or holds another kind of result.
    """
    import xarray as xr

    check_hdf5(path)
    with reading(path, "NetCDF"), xr.open_dataset(path, engine="h5netcdf") as opened:
        dataset = opened.load()
    found = dataset.attrs.get("kind", "nothing that flexarm wrote")
    if not isinstance(found, str) or found != kind:
        raise InvalidFile(path, "kind", f"must be {kind!r}, got {found!r}")
    return dataset


def model_of(dataset: xr.Dataset, path: str | Path = "dataset") -> Arm:
    """Return the arm that a stored result was computed with.

    Raise InvalidFile if the file holds no model, or one that is not allowed.
    """
    import tomllib

    from flexarm.arm import Arm

    with reading(path, "a model", "model"):
        return Arm.from_dict(tomllib.loads(dataset.attrs["model"]))


def counts(arm: Arm) -> dict[str, int]:
    """Return the length of array axes by name."""
    fixed = {"axis": 3, "body_axis": 3, "end": 2, "component": 6, "wrench": 6, "quaternion": 4}
    tables = {"point": arm.points, "joint": arm.joints, "link": arm.links, "closure": arm.closures}
    return {**{name: len(table) for name, table in tables.items()}, **fixed}
