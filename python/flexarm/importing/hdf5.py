"""HDF5 and NetCDF: groups and variables by path, packed values and units as their attributes say."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from flexarm.importing.source import Array, Group
from flexarm.importing.tree import Tree
from flexarm.reading import BoundedFile, has_endless_heap, room


def _unpacked(values: Array, attributes: Mapping[str, Any]) -> Array:
    """Return values with fill values as NaN, scaled as the conventions of NetCDF have it."""
    for key in ("_FillValue", "missing_value"):
        if key in attributes:
            fill = np.asarray(attributes[key]).ravel()[0]
            if (values == fill).any():
                values = np.where(values == fill, np.nan, values)
    if "scale_factor" in attributes or "add_offset" in attributes:
        scale, offset = attributes.get("scale_factor", 1.0), attributes.get("add_offset", 0.0)
        values = values * np.asarray(scale).item() + np.asarray(offset).item()
    return values


def _text(value: Any) -> str:
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


class Hdf5File(Tree):
    """An HDF5 file, such as NetCDF-4."""

    separator = "/"
    tried_apart = True

    def leaves(self) -> dict[str, tuple[int, ...]]:
        """Return path -> shape of all variables of numbers; fields of compound types are variables too."""
        import h5py  # type: ignore[import-untyped]

        if has_endless_heap(self.path):
            raise ValueError("texts in it have no end")
        found: dict[str, tuple[int, ...]] = {}
        self.units: dict[str, str] = {}

        def visit(name: str, item: Any) -> None:
            if not isinstance(item, h5py.Dataset) or item.external or item.is_virtual:
                return
            for part in item.dtype.names or ("",):
                kind = item.dtype[part] if part else item.dtype
                if kind.base.kind in "fiubc":
                    path = f"{name}/{part}" if part else name
                    found[path] = (*item.shape, *kind.shape)
                    self.units[path] = _text(item.attrs.get("units", ""))

        with h5py.File(self.path, "r") as file:
            file.visititems(visit)
        return found

    def leaf(self, path: str) -> Array:
        """Return a variable."""
        import h5py

        with h5py.File(self.path, "r") as file:
            name, part = (path, "") if path in file else path.rsplit("/", 1)
            item = file[name]
            room(self.path, path, (item.size or 0) * item.dtype.itemsize)
            return _unpacked(item[part] if part else item[()], dict(item.attrs))

    def time_unit(self, topic: str | None, index: int) -> str:
        """Return the unit that the attribute `units` states, such as `ns since 1970-01-01`."""
        return self.units[self.path_of(topic, self.names(topic)[index])]

    def groups(self) -> list[Group]:
        """Return variables by group, with their units."""
        return [
            Group(
                group.topic,
                group.names,
                units=tuple(
                    self.units.get(self.path_of(group.topic, name.partition("[")[0]), "")
                    for name in group.names
                ),
            )
            for group in super().groups()
        ]


class NetcdfFile(Hdf5File):
    """A NetCDF file of the classic format, whose variables are kept."""

    leaf = Tree.leaf

    def leaves(self) -> dict[str, tuple[int, ...]]:
        """Return name -> shape of all variables of numbers."""
        from scipy.io import netcdf_file

        with BoundedFile(self.path) as raw, netcdf_file(raw, mmap=False) as file:
            variables = {n: v for n, v in file.variables.items() if v.data.dtype.kind in "fiu"}
            attributes = {n: dict(getattr(v, "_attributes", {})) for n, v in variables.items()}
            self.units = {n: _text(attributes[n].get("units", "")) for n in variables}
            self._arrays = {
                n: _unpacked(v.data.astype(v.data.dtype.newbyteorder("=")), attributes[n])
                for n, v in variables.items()
            }
        return {name: values.shape for name, values in self._arrays.items()}
