"""Open a model, record, part or result by its kind: what `flexarm view` and `flexarm.load` share."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

from flexarm.arguments import takes
from flexarm.errors import InvalidFile
from flexarm.reading import check_hdf5, reading

MESHES = (".inp", ".msh", ".vtu", ".bdf", ".nas", ".fem")
"""Endings of meshes, which are no models."""
_CLASSES = {
    "report.json": ("flexarm.diagnosis.result", "Diagnosis"),
    "calibration.json": ("flexarm.calibration.result", "Calibration"),
    "study.json": ("flexarm.campaigns.campaign", "Campaign"),
    "simulation.nc": ("flexarm.simulation", "Simulation"),
    "record.toml": ("flexarm.record", "Record"),
    "simulation": ("flexarm.simulation", "Simulation"),
    "statics": ("flexarm.statics", "Statics"),
    "modes": ("flexarm.modal", "Modes"),
    "linear model": ("flexarm.linear", "LinearModel"),
    "part": ("flexarm.superelement", "SuperElement"),
    ".mat": ("flexarm.linear", "LinearModel"),
    ".npz": ("flexarm.stepping", "State"),
}
"""Module and class by the file that a directory holds, by the kind of a NetCDF file, and by ending."""


@takes()
def load(path: str | Path) -> Any:
    """Open a model, record, part or result by what the file or directory is.

    Parameters
    ----------
    path : str or Path
        A model (TOML, URDF), a directory of `simulate`, `diagnose`, `calibrate` or `campaign`, a record, or a
        file that a `save` wrote. A directory with both a run and its record gives the run; `Record.load`
        opens the record.

    Returns
    -------
    object
        An Arm, Record, Simulation, Statics, Modes, SuperElement, LinearModel, State, Diagnosis, Calibration
        or Campaign, as the method `load` of its class returns it, or `Arm.from_toml`.

    Raises
    ------
    InvalidFile
        If nothing is there, it is of no such kind, or the file is damaged.

    Examples
    --------
    >>> arm = flexarm.load("arm.toml")  # doctest: +SKIP
    >>> run = flexarm.load("run")  # doctest: +SKIP
    """
    path = Path(path)
    if path.suffix in MESHES:
        raise InvalidFile(path, "path", "is a mesh; flexarm.read_mesh opens it")
    if path.is_dir():
        kind = next((name for name in _CLASSES if "." in name[1:] and (path / name).is_file()), "")
        if not kind:
            files = ", ".join(name for name in _CLASSES if "." in name[1:])
            raise InvalidFile(path, "path", f"is a directory without any of {files}")
        path = path / kind if kind == "simulation.nc" else path
    elif path.name == "gaps.nc":
        return load(path.parent)
    elif path.suffix == ".nc":
        kind = kind_of_netcdf(path)
    else:
        kind = path.name if path.name in _CLASSES else path.suffix
    if kind == "study.json" and path.is_file():
        path = path.parent
    if kind not in _CLASSES:
        from flexarm.arm import Arm

        return Arm.from_toml(path)
    module, name = _CLASSES[kind]
    return getattr(import_module(module), name).load(path)


def kind_of_netcdf(path: Path) -> str:
    """Return "part" for a super-element, or the kind of result that a file holds."""
    import h5netcdf

    check_hdf5(path)
    with reading(path, "NetCDF"), h5netcdf.File(path, "r") as file:
        return str(file.attrs.get("kind", "part"))
