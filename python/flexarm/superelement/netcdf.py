"""Super-element files: NetCDF with the attribute `format = "flexarm-superelement/1"`.

Variables and dimensions are listed in docs/superelements.md. Any NetCDF that holds them is read, whoever
wrote it: classic or HDF5, single or double precision, names as strings or characters, dimensions by any name.
Variables are read without the NetCDF libraries: they ask for dimensions that another program may have left
out, and leave tracebacks behind when a file is damaged.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.configuration import config
from flexarm.errors import InvalidFile, Problem
from flexarm.json_values import plain
from flexarm.netcdf import Contents
from flexarm.netcdf import save as write
from flexarm.output import refuse_existing
from flexarm.reading import BoundedFile, check_hdf5, reading, regular_file
from flexarm.superelement.shape import VARIABLES

if TYPE_CHECKING:
    from flexarm.superelement.element import SuperElement

FORMAT = "flexarm-superelement/1"


def save(element: SuperElement, path: str | Path, force: bool = False, inputs: Iterable[Path] = ()) -> None:
    """Write a super-element; the file appears when it is complete, and replaces no input.

    Raise InvalidFile if the file exists and `force` is not set, or cannot be written.
    """
    refuse_existing(Path(path), force, inputs)
    write(contents(element), path)


def contents(element: SuperElement) -> Contents:
    """Return the content of a super-element's file."""
    variables: dict[str, Any] = {"interface_name": (("interface",), list(element.interfaces), {})}
    for field, (name, dimensions, unit) in VARIABLES.items():
        variables[name] = (dimensions, getattr(element, field), {"units": unit})
    if element.recovery is not None:
        variables["recovery"] = (("point_dof", "dof"), element.recovery, {"units": "1, m, 1/sqrt(kg)"})
    versions = config()
    attributes = {
        "format": FORMAT,
        "name": element.name,
        "units": "SI: m, kg, s, N, Pa, rad; the part's frame",
        "quality": json.dumps(plain(element.quality)),
        "flexarm_version": versions["flexarm"],
        "git": versions["git"],
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        **element.provenance,
    }
    return Contents(variables, attributes=attributes)


def stored(path: str | Path) -> dict[str, Any]:
    """Return the attributes of the super-element in a file.

    Raise InvalidFile if the file is no super-element.
    """
    data = read_variables(path)
    if data.attributes.get("format") != FORMAT:
        found = data.attributes.get("format", "none")
        raise InvalidFile(path, "format", f"the attribute must be {FORMAT!r}, got {found!r}")
    return _attributes(data, path)


def _attributes(data: Variables, path: str | Path) -> dict[str, Any]:
    """Return the attributes; a variable that is missing or holds no numbers is reported with its name."""
    n = (*_shape(data, "interface_name"), 0)[0]
    optional = ["inertia_load"] + ["frequency_hz"] * (_shape(data, "stiffness") == (6 * n, 6 * n))
    known = ["interface_name", *(name for name, _, _ in VARIABLES.values())]
    missing = [name for name in known if name not in optional and name not in data.arrays]
    if missing:
        what = f"is missing; a super-element file holds {', '.join(known)}"
        raise InvalidFile(path, missing[0], what, problems=tuple(Problem(name, what) for name in missing))
    fields = {field: name for field, (name, _, _) in VARIABLES.items()} | {"recovery": "recovery"}
    arrays = {field: _numbers(data, name, path) for field, name in fields.items() if name in data.arrays}
    arrays.setdefault("frequency_hz", np.zeros(0))
    return dict(
        name=str(data.attributes.get("name") or Path(path).stem),
        interfaces=_interface_names(data, path),
        quality=_quality(data),
        provenance={str(k): str(v) for k, v in data.attributes.items() if k not in _OWN_ATTRIBUTES},
        **arrays,
    )


_OWN_ATTRIBUTES = ("format", "name", "units", "quality")


def _shape(data: Variables, name: str) -> tuple[int, ...]:
    return tuple(data.arrays[name].shape) if name in data.arrays else ()


def _numbers(data: Variables, name: str, path: str | Path) -> Floats:
    values = data.arrays[name]
    if values.dtype.kind not in "fiu":
        raise InvalidFile(path, name, f"must hold real numbers, got values of type {values.dtype}")
    return np.asarray(values, dtype=float)


def _interface_names(data: Variables, path: str | Path) -> tuple[str, ...]:
    values = data.arrays["interface_name"]
    names = texts(values)
    if names is None:
        what = f"must be a list of names, got shape {values.shape} of type {values.dtype}"
        raise InvalidFile(path, "interface_name", what)
    return tuple(names)


def _quality(data: Variables) -> dict[str, Any]:
    """Return what `save` stored; another program's attribute of that name is ignored."""
    try:
        told = json.loads(data.attributes.get("quality", "{}"))
    except (TypeError, ValueError, RecursionError):
        return {}
    return told if isinstance(told, dict) else {}


@dataclass(frozen=True, eq=False)
class Variables:
    """The arrays of a file by name, and its attributes."""

    arrays: Mapping[str, NDArray[Any]]
    attributes: Mapping[str, Any]


def read_variables(path: str | Path) -> Variables:
    """Return all variables of a file.

    Raise InvalidFile if it does not exist, is no NetCDF file, or is damaged.
    """
    with reading(regular_file(path), "NetCDF"):
        with Path(path).open("rb") as file:
            classic = file.read(3) == b"CDF"
        return _classic(Path(path)) if classic else _hdf5(Path(path))


def _hdf5(path: Path) -> Variables:
    import h5py  # type: ignore[import-untyped]

    check_hdf5(path)
    with h5py.File(path, "r") as file:
        arrays = {}
        for name, item in file.items():
            if isinstance(item, h5py.Dataset):
                _refuse_packed(path, name, item.attrs)
                arrays[name] = np.asarray(item[()])
        return Variables(arrays, {name: _plain(value) for name, value in file.attrs.items()})


def _classic(path: Path) -> Variables:
    from scipy.io import netcdf_file

    with BoundedFile(path) as raw, netcdf_file(raw, "r", mmap=False) as file:
        for name, item in file.variables.items():
            _refuse_packed(path, name, item._attributes)
        arrays = {name: np.array(item.data) for name, item in file.variables.items()}
        native = {name: a.astype(a.dtype.newbyteorder("=")) for name, a in arrays.items()}
        return Variables(native, {name: _plain(value) for name, value in file._attributes.items()})


def _refuse_packed(path: Path, name: str, attributes: Any) -> None:
    """Refuse numbers stored as integers with a scale, which would be read wrongly."""
    for key in ("scale_factor", "add_offset"):
        if key in attributes:
            raise InvalidFile(path, name, f"must hold its numbers as they are, got packed ones ({key})")


def _plain(value: Any) -> Any:
    """Convert bytes to str and single numbers to Python's."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, np.ndarray):
        return _plain(value.item()) if value.size == 1 else value.tolist()
    return value.item() if isinstance(value, np.generic) else value


def texts(values: NDArray[Any]) -> list[str] | None:
    """Return names stored as strings, bytes, or characters along a last dimension; None if they are none."""
    if values.dtype.kind == "S" and values.dtype.itemsize == 1 and values.ndim == 2:
        values = np.array([b"".join(row) for row in values])
    if values.ndim != 1 or values.dtype.kind not in "OUST":
        return None
    found = [str(_plain(value)) for value in values.tolist()]
    return [text.strip("\0 ") for text in found]
