"""Super-element files: NetCDF with the attribute `format = "flexarm-superelement/1"`.

Variables and dimensions are listed in docs/superelements.md. Any NetCDF that holds them is read, whoever
wrote it: classic or HDF5, single or double precision, names as strings or characters, dimensions by any name.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.configuration import config
from flexarm.errors import InvalidFile, InvalidParameter, Problem
from flexarm.superelement.element import SuperElement, inertia_load

if TYPE_CHECKING:
    import xarray as xr

FORMAT = "flexarm-superelement/1"

DIMENSIONS = {
    "interface_position": ("interface", "axis"),
    "interface_rotation": ("interface", "axis", "interface_axis"),
    "stiffness": ("dof", "dof"),
    "mass": ("dof", "dof"),
    "damping": ("dof", "dof"),
    "frequency_hz": ("mode",),
    "inertia_load": ("dof", "axis"),
}

UNITS = {
    "interface_position": "m",
    "interface_rotation": "1",
    "stiffness": "N/m, N, N m",
    "mass": "kg, kg m, kg m2",
    "damping": "N s/m, N s, N m s",
    "frequency_hz": "Hz",
    "inertia_load": "kg, kg m",
}


def save(element: SuperElement, path: str | Path, force: bool = False) -> None:
    """Writes a super-element; the file appears when it is whole.

    Raises
    ------
    InvalidFile
        If the file exists and `force` is not set, or cannot be written.
    """
    from flexarm import result

    if Path(path).is_dir():
        raise InvalidFile(path, "output", "is a directory, a file is needed")
    if Path(path).exists() and not force:
        raise InvalidFile(path, "output", "exists already; allowed is a new file, or --force")
    with _repeated_dimensions():
        result.save(dataset(element), path)


def dataset(element: SuperElement) -> xr.Dataset:
    """The super-element as an xarray Dataset with units."""
    import xarray as xr

    values: dict[str, Any] = {
        "interface_position": element.positions,
        "interface_rotation": element.rotations,
        "stiffness": element.stiffness,
        "mass": element.mass,
        "damping": element.damping,
        "frequency_hz": element.frequency_hz,
        "inertia_load": element.inertia_load,
    }
    variables: dict[str, Any] = {
        "interface_name": (("interface",), np.array(element.interfaces, dtype=object))
    }
    for name, array in values.items():
        variables[name] = (DIMENSIONS[name], array, {"units": UNITS[name]})
    if element.recovery is not None:
        variables["recovery"] = (("point_dof", "dof"), element.recovery, {"units": "1, m, 1/sqrt(kg)"})
    attributes = {
        "format": FORMAT,
        "name": element.name,
        "units": "SI: m, kg, s, N, Pa, rad; the part's frame",
        "quality": json.dumps(_plain(element.quality)),
        **_provenance(),
        **element.provenance,
    }
    with _repeated_dimensions():
        return xr.Dataset(variables, attrs=attributes)


def _provenance() -> dict[str, str]:
    versions = config()
    return {
        "flexarm_version": versions["flexarm"],
        "git": versions["git"],
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def _plain(value: Any) -> Any:
    """Arrays as lists, so that JSON takes them."""
    if isinstance(value, dict) or hasattr(value, "items"):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def load(path: str | Path) -> SuperElement:
    """Reads a super-element file and asks what mechanics demands of it.

    Raises
    ------
    InvalidFile
        If the file is no super-element, or one that no elastic part could have.
    """
    data = _opened(path)
    if data.attrs.get("format") != FORMAT:
        found = data.attrs.get("format", "none")
        raise InvalidFile(path, "format", f"the attribute must be {FORMAT!r}, got {found!r}")
    try:
        element = _element(data, path)
        element.check()
    except InvalidFile:
        raise
    except InvalidParameter as error:
        first = error.problems[0]
        raise InvalidFile(path, first.where, first.what, problems=error.problems) from None
    return element


def _opened(path: str | Path) -> xr.Dataset:
    import xarray as xr

    try:
        with Path(path).open("rb") as file:
            classic = file.read(3) == b"CDF"
        engine = "scipy" if classic else "h5netcdf"
        with _repeated_dimensions(), xr.open_dataset(path, engine=engine) as opened:
            return opened.load()
    except FileNotFoundError:
        raise InvalidFile(path, "file", "does not exist") from None
    except IsADirectoryError:
        raise InvalidFile(path, "file", "is a directory, a super-element file is needed") from None
    except Exception as error:  # a damaged file fails in whatever the reader happens to meet
        raise InvalidFile(path, "file", f"cannot be read as NetCDF: {' '.join(str(error).split())}") from None


def _element(data: xr.Dataset, path: str | Path) -> SuperElement:
    """The data class; a variable that is missing or holds no numbers is reported with its name."""
    n = data["interface_name"].size if "interface_name" in data else 0
    optional = {"inertia_load"} | ({"frequency_hz"} if _shape(data, "stiffness") == (6 * n, 6 * n) else set())
    missing = [name for name in ("interface_name", *DIMENSIONS) if name not in data and name not in optional]
    if missing:
        what = f"is missing; a super-element file holds interface_name, {', '.join(DIMENSIONS)}"
        raise InvalidFile(path, missing[0], what, problems=tuple(Problem(name, what) for name in missing))
    mass = _numbers(data, "mass", path)
    return SuperElement(
        name=str(data.attrs.get("name") or Path(path).stem),
        interfaces=_interface_names(data, path),
        positions=_numbers(data, "interface_position", path),
        rotations=_numbers(data, "interface_rotation", path),
        stiffness=_numbers(data, "stiffness", path),
        mass=mass,
        damping=_numbers(data, "damping", path),
        frequency_hz=_numbers(data, "frequency_hz", path) if "frequency_hz" in data else np.zeros(0),
        inertia_load=_numbers(data, "inertia_load", path)
        if "inertia_load" in data
        else inertia_load(mass, n),
        recovery=_numbers(data, "recovery", path) if "recovery" in data else None,
        quality=_quality(data),
        provenance={str(k): str(v) for k, v in data.attrs.items() if k not in _OWN_ATTRIBUTES},
    )


_OWN_ATTRIBUTES = ("format", "name", "units", "quality")


def _shape(data: xr.Dataset, name: str) -> tuple[int, ...]:
    return tuple(data[name].shape) if name in data else ()


def _numbers(data: xr.Dataset, name: str, path: str | Path) -> Floats:
    values = data[name].values
    if values.dtype.kind not in "fiu":
        raise InvalidFile(path, name, f"must hold real numbers, got values of type {values.dtype}")
    return np.asarray(values, dtype=float)


def _interface_names(data: xr.Dataset, path: str | Path) -> tuple[str, ...]:
    values = data["interface_name"].values
    if values.ndim != 1 or values.dtype.kind not in "OUST":
        what = f"must be a list of names, got shape {values.shape} of type {values.dtype}"
        raise InvalidFile(path, "interface_name", what)
    return tuple(_text(value).strip("\0 ") for value in values)


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _quality(data: xr.Dataset) -> dict[str, Any]:
    """What `save` stored; another program's attribute of that name is left alone."""
    try:
        told = json.loads(data.attrs.get("quality", "{}"))
    except (TypeError, ValueError):
        return {}
    return told if isinstance(told, dict) else {}


@contextmanager
def _repeated_dimensions() -> Iterator[None]:
    """A matrix over (dof, dof) is what the format says; xarray warns of it and stores it rightly."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Duplicate dimension names", category=UserWarning)
        yield
