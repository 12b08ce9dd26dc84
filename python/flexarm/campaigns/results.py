"""The results of a campaign as NetCDF, written part by part so that memory stays flat.

Dimension `sample`; coordinates: every parameter that varied and every label of the cases; `status` "ok" or
"failed" with `reason`; `seconds`; every kept variable, NaN where a run failed, and its `NAME_nominal`, by
`case` if there are several. Layout
as `flexarm.netcdf` has it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.campaigns.outcome import Outcome, Variable
from flexarm.campaigns.store import Part, Store
from flexarm.netcdf import growing_hdf5

SAMPLE = "sample"


def write_results(
    store: Store,
    path: Path,
    variables: Sequence[Variable],
    coordinates: Mapping[str, tuple[Sequence[Any] | Floats, Mapping[str, Any]]],
    nominal: Sequence[Outcome],
    attributes: Mapping[str, Any],
) -> None:
    """Write the file of results from the batches of a store, which hold every sample once.

    `variables` are those that every run has; others are found in the batches. `coordinates` are values by
    sample and attributes (parameters, labels), `nominal` the nominal run through each case; none for
    diagnoses.

    Raise OSError if the file cannot be written.
    """
    count = len(next(iter(coordinates.values()))[0])
    with growing_hdf5(path) as file:
        file.attrs.update({**attributes, "coordinates": " ".join(coordinates)})
        made = _File(file, count, " ".join(coordinates))
        for name, (values, attrs) in coordinates.items():
            made.fixed(name, (SAMPLE,), values, attrs)
        _declare(made, variables, nominal)
        _declare_found(made, store.read(), {each.name for each in variables})
        for part in store.read():
            made.put(part)


class _File:
    """An HDF5 file with dimension scales."""

    def __init__(self, file: Any, count: int, coordinates: str) -> None:
        self._file, self._count, self._coordinates = file, count, coordinates
        self._scales: dict[str, Any] = {}
        self.scale(SAMPLE, np.arange(count), {"long_name": "number of the sample"})

    def scale(self, name: str, values: Any, attributes: Mapping[str, Any]) -> None:
        """Make a dimension with its coordinate."""
        if name not in self._scales:
            self._scales[name] = self.fixed(name, (), values, attributes)
            self._scales[name].make_scale(name)

    def variable(
        self, name: str, dims: Sequence[str], shape: tuple[int, ...], attributes: Mapping[str, Any], kind: Any
    ) -> None:
        """Make a variable along the samples and its own dimensions, empty."""
        # Bytes of a piece of a variable in the file: several batches of long series, or thousands of
        # numbers.
        chunk_bytes = 2**20
        width = 8 * int(np.prod(shape, dtype=int))
        chunk = (max(1, min(self._count, chunk_bytes // max(width, 8))), *shape)
        made = self._file.create_dataset(
            name,
            shape=(self._count, *shape),
            dtype=kind,
            chunks=chunk,
            fillvalue=None if kind != "f8" else np.nan,
        )
        made.attrs.update({**attributes, "coordinates": self._coordinates})
        for axis, dim in enumerate((SAMPLE, *dims)):
            made.dims[axis].attach_scale(self._scales[dim])

    def fixed(self, name: str, dims: Sequence[str], values: Any, attributes: Mapping[str, Any]) -> Any:
        """Write a variable whose values are known, texts as a list, and return it."""
        kind = _text() if isinstance(values, list) else None
        made = self._file.create_dataset(name, data=np.array(values, object) if kind else values, dtype=kind)
        made.attrs.update(attributes)
        for axis, dim in enumerate(dims):
            made.dims[axis].attach_scale(self._scales[dim])
        return made

    def put(self, part: Part) -> None:
        """Write the rows of a batch."""
        rows, first, last = part.samples, int(part.samples[0]), int(part.samples[-1])
        if last - first + 1 == len(rows):
            rows = slice(first, last + 1)  # which HDF5 writes faster
        reasons = np.array(part.reasons, dtype=object)
        self._file["seconds"][rows] = part.seconds
        self._file["reason"][rows] = reasons
        self._file["status"][rows] = np.where(reasons == "", "ok", "failed").astype(object)
        for name, values in part.arrays.items():
            self._file[name][rows] = values
        for row, found in zip(part.samples, part.others, strict=True):
            for name, value in found.items():
                self._file[name][row] = value if isinstance(value, str) else value[0]


def _text() -> Any:
    import h5py  # type: ignore[import-untyped]

    return h5py.string_dtype()


def _declare(made: _File, variables: Sequence[Variable], nominal: Sequence[Outcome]) -> None:
    """Make the variables that every run has, and write their nominal values."""
    made.variable("status", (), (), {"long_name": 'outcome of the run: "ok" or "failed"'}, _text())
    made.variable("reason", (), (), {"long_name": "why a run failed; empty where it did not"}, _text())
    made.variable("seconds", (), (), {"units": "s", "long_name": "time of the run"}, "f8")
    for each in variables:
        for dim in each.dims:
            unit = {"units": each.units[dim]} if dim in each.units else {}
            made.scale(dim, each.coordinates[dim], unit)
        about = {"units": each.unit, "long_name": each.text, "measure": each.measure}
        if each.tolerance is not None:
            about["tolerance"] = each.tolerance  # type: ignore[assignment]
        text = each.name == "verdict"
        made.variable(each.name, each.dims, each.shape, about, _text() if text else "f8")
        if nominal and each.measure in ("series", "value"):
            values = np.stack([np.asarray(outcome[each.name]) for outcome in nominal])
            dims = each.dims
            if len(nominal) > 1:
                made.scale("case", np.arange(len(nominal)), {"long_name": "number of the drive"})
                dims = ("case", *dims)
            whole = values if len(nominal) > 1 else values[0]
            made.fixed(f"{each.name}_nominal", dims, whole, {"units": each.unit})


def _declare_found(made: _File, parts: Iterable[Part], known: set[str]) -> None:
    """Make the variables of which only some runs have values."""
    for part in parts:
        for found in part.others:
            for name, value in found.items():
                if name not in known:
                    known.add(name)
                    made.variable(name, (), (), {"units": value[1], "measure": "found"}, "f8")
