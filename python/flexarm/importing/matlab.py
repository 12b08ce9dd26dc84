"""MATLAB files: structs by path, such as `rec.act_pos_mot_deg[1]`; v5 by SciPy, v7.3 by HDF5."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from flexarm.importing.source import Array
from flexarm.importing.tree import Tree
from flexarm.linear.matlab import check_mat
from flexarm.reading import room


class MatFile(Tree):
    """A MATLAB file."""

    tried_apart = True

    def leaves(self) -> dict[str, tuple[int, ...]]:
        """Return path -> shape of all arrays of numbers, texts and logicals."""
        with self.path.open("rb") as file:
            newer = file.read(19) == b"MATLAB 7.3 MAT-file"
        found = dict(_of_hdf5(self.path) if newer else _of_v5(self.path))
        self._arrays = {path: array for path, array in found.items() if array.dtype.kind in "fiubc"}
        return {path: array.shape for path, array in self._arrays.items()}


def _of_v5(path: Any) -> Iterator[tuple[str, Array]]:
    from scipy.io import loadmat

    check_mat(path)
    for name, value in loadmat(path, simplify_cells=True).items():
        if isinstance(name, str) and not name.startswith("__"):
            yield from _flat(value, name)


def _flat(value: Any, path: str) -> Iterator[tuple[str, Array]]:
    """Yield the arrays of a struct, and those of an array of structs by number."""
    if isinstance(value, dict):
        for name, below in value.items():
            yield from _flat(below, f"{path}.{name}")
    elif isinstance(value, list) or (isinstance(value, np.ndarray) and value.dtype == object):
        for number, below in enumerate(np.asarray(value, dtype=object).ravel().tolist(), 1):
            if isinstance(below, dict | np.ndarray):
                yield from _flat(below, f"{path}[{number}]")
    elif isinstance(value, np.ndarray) or np.isscalar(value):
        yield path, np.asarray(value)


def _of_hdf5(path: Any) -> Iterator[tuple[str, Array]]:
    import h5py  # type: ignore[import-untyped]

    with h5py.File(path, "r") as file:
        found: list[tuple[str, Array]] = []

        def visit(name: str, item: Any) -> None:
            if not isinstance(item, h5py.Dataset) or name.startswith("#"):
                return
            numbers = item.dtype.kind in "fiub"
            if numbers or item.dtype.names == ("real", "imag"):
                room(path, name, (item.size or 0) * item.dtype.itemsize)
                if not item.attrs.get("MATLAB_empty", 0):
                    array = item[()] if numbers else item["real"] + 1j * item["imag"]
                    found.append((name.replace("/", "."), np.squeeze(array.T)))

        file.visititems(visit)
        yield from found
