"""Linear models as MAT files (level 5), which MATLAB, Octave and SciPy read.

Matrices under their names, names and units as columns of cells, texts as texts:

    m = load('arm.mat');  sys = ss(m.A, m.B, m.C, m.D, 'InputName', m.input, 'OutputName', m.output)
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexarm.errors import InvalidFile
from flexarm.linear.mat_file import read_mat
from flexarm.netcdf import Contents
from flexarm.output import write_file

if TYPE_CHECKING:
    import xarray as xr


def save(contents: Contents, path: str | Path, inputs: Iterable[Path] = ()) -> None:
    """Write variables, labels and attributes; the file appears when it is complete and replaces no input.

    Raises
    ------
    InvalidFile
        If the file cannot be written.
    """
    from scipy.io import savemat

    arrays = {**{name: values for name, (_, values, _) in contents.variables.items()}, **contents.labels}
    columns = {name: _column(values) for name, values in arrays.items()}
    texts = {_identifier(name): text for name, text in contents.attributes.items()}
    image = BytesIO()
    savemat(image, {**columns, **texts}, long_field_names=True)
    write_file(path, image.getbuffer(), inputs)


def load(path: str | Path) -> xr.Dataset:
    """Read the dataset that `save` wrote.

    Raises
    ------
    InvalidFile
        If the file is missing or no MAT file of a linear model.
    """
    import xarray as xr

    data = xr.Dataset()
    for name, values in read_mat(path).items():
        if isinstance(values, str):
            data.attrs[name] = values
        elif isinstance(values, list):
            data[name] = ((f"{name}_row",), values)
        else:
            array = values[:, 0] if name.endswith(("_at_rest", "_values")) and values.shape[1] else values
            data[name] = (tuple(f"{name}_{axis}" for axis in range(array.ndim)), array)
    if data.attrs.get("kind") != "linear model":
        raise InvalidFile(path, "kind", f"must be 'linear model', got {data.attrs.get('kind', 'none')!r}")
    return data


def _identifier(name: str) -> str:
    """Return a name that MATLAB takes as a variable's: a part may be called "2-hub"."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return plain if plain[0].isalpha() else f"x{plain}"


def _column(values: object) -> object:
    """Return texts as a column of cells, numbers along one axis as a column."""
    if isinstance(values, list | tuple):
        cells = np.empty((len(values), 1), dtype=object)
        cells[:, 0] = [str(text) for text in values]
        return cells
    array = np.asarray(values)
    return array[:, None] if array.ndim == 1 else array
