"""Files of results: NetCDF with named dimensions, units and attributes.

A NetCDF-4 file is an HDF5 file whose dimensions are dimension scales, attached to every variable that has
them. h5py writes it: to import xarray, and pandas with it, would take longer than a run of 20 s and all its
files. Source: Unidata, NetCDF File Format Specifications, "The NetCDF-4 Format".
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from io import BytesIO, FileIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexarm.checksum import add_checksum
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

    It is made in memory, where HDF5 can write; see `growing_hdf5`.

    Raise InvalidFile if the file cannot be written.
    """
    image = BytesIO()
    _write(contents, image)
    add_checksum(image)
    write_file(path, image.getbuffer(), inputs)


@contextmanager
def growing_hdf5(path: Path) -> Iterator[Any]:
    """Yield a new HDF5 file; raise OSError at the end if some of it could not be written.

    HDF5 itself would try again at exit, and crash.
    """
    import h5py  # type: ignore[import-untyped]

    with _Sink(path, "w+") as sink:
        try:
            with h5py.File(sink, "w") as file:
                yield file
            add_checksum(sink)
        finally:
            if sink.error is not None:
                raise sink.error


class _Sink(FileIO):
    """A file of which HDF5 does not learn that it cannot be written."""

    error: OSError | None = None

    def write(self, content: Any) -> int:
        """Write all, or nothing any more once there was an error."""
        left = memoryview(content)
        try:
            while len(left) and self.error is None:
                left = left[super().write(left) :]
        except OSError as error:
            self.error = error
        return len(content)

    def truncate(self, size: int | None = None) -> int:
        """Set the length, if that is possible."""
        try:
            return super().truncate(size)
        except OSError as error:
            self.error = error
            return size or 0


def _write(contents: Contents, image: BytesIO) -> None:
    import h5py

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
                    scales[dimension] = file.create_dataset(dimension, shape=(size,), dtype=">f4")
                    mark = f"This is a netCDF dimension but not a netCDF variable.{size:10d}"
                    scales[dimension].make_scale(mark)
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
