"""Variables and attributes of a NetCDF file, classic or HDF5, as plain arrays.

Read without the NetCDF libraries: they ask for dimensions that another program may have left out, and leave
tracebacks behind when a file is damaged.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexarm.errors import InvalidFile
from flexarm.reading import check_hdf5, reading, regular_file


@dataclass(frozen=True, eq=False)
class Variables:
    """The arrays of a file by name, and its attributes."""

    arrays: Mapping[str, NDArray[Any]]
    attributes: Mapping[str, Any]


def read_variables(path: str | Path) -> Variables:
    """Return all variables of a file.

    Raises
    ------
    InvalidFile
        If it does not exist, is no NetCDF file, or is damaged.
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

    with netcdf_file(path, "r", mmap=False) as file:
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
