"""Files of results: NetCDF with named dimensions, units and attributes.

A NetCDF-4 file is an HDF5 file whose dimensions are dimension scales, attached to every variable that has
them. h5py writes it: to import xarray, and pandas with it, would take longer than a run of 20 s and all its
files. Source: Unidata, NetCDF File Format Specifications, "The NetCDF-4 Format".
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexarm.output import write_file

if TYPE_CHECKING:
    import xarray as xr

Attributes = Mapping[str, Any]
Variable = tuple[Sequence[str], ArrayLike, Attributes]
"""Names of its dimensions, its values, and attributes such as the unit."""


@dataclass(frozen=True)
class Contents:
    """Contents of a file."""

    variables: Mapping[str, Variable]
    """Numbers or texts over named dimensions."""
    labels: Mapping[str, Sequence[str]] = field(default_factory=dict)
    """Names along a dimension, such as those of the points; kept if a variable has that dimension."""
    attributes: Attributes = field(default_factory=dict)
    """Of the whole: texts and numbers."""
    coordinates: Mapping[str, Variable] = field(default_factory=dict)
    """Numbers along a dimension of the same name, such as the time."""

    def dataset(self) -> xr.Dataset:
        """Return the same as an xarray Dataset."""
        import xarray as xr

        return xr.Dataset(dict(self.variables), self.along_dimensions(), dict(self.attributes))

    def along_dimensions(self) -> dict[str, Variable]:
        """Return coordinates and labels."""
        used = {dimension for dimensions, _, _ in self.variables.values() for dimension in dimensions}
        labels: dict[str, Variable]
        labels = {name: ((name,), list(texts), {}) for name, texts in self.labels.items() if name in used}
        return {**self.coordinates, **labels}


def save(contents: Contents, path: str | Path, inputs: Iterable[Path] = ()) -> None:
    """Write a file, which appears when it is whole and replaces none of the inputs.

    It is made in memory: HDF5 crashes at exit where it could not write.

    Raise InvalidFile if the file cannot be written.
    """
    image = BytesIO()
    _write(contents, image)
    write_file(path, image.getbuffer(), inputs)


def _write(contents: Contents, image: BytesIO) -> None:
    import h5py  # type: ignore[import-untyped]

    scales: dict[str, Any] = {}
    with h5py.File(image, "w") as file:
        file.attrs.update(contents.attributes)
        for name, variable in contents.along_dimensions().items():
            scales[name] = _stored(file, name, variable)
            scales[name].make_scale(name)
        for name, variable in contents.variables.items():
            stored = _stored(file, name, variable)
            for axis, (dimension, size) in enumerate(zip(variable[0], stored.shape, strict=True)):
                if dimension not in scales:
                    scales[dimension] = _bare_dimension(file, dimension, size)
                if size != len(scales[dimension]):
                    raise ValueError(f"{name} has {size} along {dimension}, of {len(scales[dimension])}")
                stored.dims[axis].attach_scale(scales[dimension])


def _stored(file: Any, name: str, variable: Variable) -> Any:
    """Return a variable with its values and attributes; texts are of variable length."""
    import h5py

    _, values, attributes = variable
    array = np.asarray(values)
    texts = array.dtype.kind in "UO"
    kind = h5py.string_dtype() if texts else array.dtype
    stored = file.create_dataset(name, data=array.astype(object) if texts else array, dtype=kind)
    stored.attrs.update(attributes)
    return stored


def _bare_dimension(file: Any, name: str, size: int) -> Any:
    """Return a dimension without coordinates, marked as the NetCDF library does."""
    scale = file.create_dataset(name, shape=(size,), dtype=">f4")
    scale.make_scale(f"This is a netCDF dimension but not a netCDF variable.{size:10d}")
    return scale
