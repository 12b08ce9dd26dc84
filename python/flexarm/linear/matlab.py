"""Linear models as MAT files (level 5), which MATLAB, Octave and SciPy read.

Matrices under their names, names and units as columns of cells, texts as texts:

    m = load('arm.mat');  sys = ss(m.A, m.B, m.C, m.D, 'InputName', m.input, 'OutputName', m.output)

A file is a header of 128 bytes and elements, each a tag (type, bytes) and its bytes; one of type 14 is a
matrix, whose elements are flags, dimensions, name and values, and one of type 15 holds another, compressed.
Every size is checked against what is there, since SciPy's reader does not survive damaged files.
Source: MathWorks, MAT-File Format, "Level 5 MAT-File Format".
"""

from __future__ import annotations

import math
import re
import struct
import zlib
from collections.abc import Iterable, Iterator
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexarm.errors import InvalidFile
from flexarm.netcdf import Contents
from flexarm.output import write_file
from flexarm.reading import EXPANSION, SMALL, reading, regular_file

if TYPE_CHECKING:
    import xarray as xr


def save(contents: Contents, path: str | Path, inputs: Iterable[Path] = ()) -> None:
    """Write variables, labels and attributes; the file appears when it is complete and replaces no input.

    Raise InvalidFile if the file cannot be written.
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

    Raise InvalidFile if the file is missing or no MAT file of a linear model.
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


Value = NDArray[Any] | str | list[str]

_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXTS = {1: "utf-8", 2: "utf-8", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
_MATRIX, _COMPRESSED = 14, 15
_HEADER = 128
_COMPLEX = 0x0800


def read_mat(path: str | Path) -> dict[str, Value]:
    """Read variables by name: real arrays, texts, and lists of texts; others are left out.

    Raise InvalidFile if the file is missing, none of level 5, or damaged.
    """
    with reading(regular_file(path), "a MAT file"):
        raw = Path(path).read_bytes()
        if (order := _order(raw)) is None:
            raise ValueError("has no header of level 5, which save(..., '-v7') or '-v6' writes")
        found: dict[str, Value] = {}
        for content in _matrices(raw[_HEADER:], order):
            name, value = _variable(content, order)
            if value is not None:
                found[name] = value
        return found


def check_mat(path: str | Path) -> None:
    """Raise InvalidFile if an element of a file of level 5 overruns what holds it: SciPy may crash on it."""
    with reading(regular_file(path), "a MAT file"):
        raw = Path(path).read_bytes()
        if (order := _order(raw)) is not None:
            inside = list(_matrices(memoryview(raw)[_HEADER:], order))
            while inside:
                inside += [content for kind, content in _elements(inside.pop(), order) if kind == _MATRIX]


def _order(raw: bytes) -> str | None:
    """Return the order of bytes that a header of level 5 tells; None without such a header."""
    order = {b"IM": "<", b"MI": ">"}.get(raw[126:_HEADER])
    return order if order and raw[124:126] == struct.pack(f"{order}H", 0x0100) else None


def _elements(raw: bytes | memoryview, order: str) -> Iterator[tuple[int, Any]]:
    """Yield type and bytes of one element after another."""
    at = 0
    while at < len(raw):
        if len(raw) - at < 8:
            raise ValueError("is cut off in the middle of an element")
        kind, size = struct.unpack_from(f"{order}2I", raw, at)
        begin, short = at + 8, kind >> 16
        if short:  # up to four bytes stand in the tag
            kind, size, begin = kind & 0xFFFF, short, at + 4
        if size > (4 if short else len(raw) - begin):
            raise ValueError(f"an element of {size} bytes goes beyond what holds it")
        yield kind, raw[begin : begin + size]
        padding = 0 if kind == _COMPRESSED else -size % 8
        at = at + 8 if short else begin + size + padding


def _matrices(raw: bytes | memoryview, order: str) -> Iterator[Any]:
    most = max(SMALL, EXPANSION * len(raw))
    for kind, content in _elements(raw, order):
        if kind == _COMPRESSED:
            unpacker = zlib.decompressobj()
            unpacked = unpacker.decompress(content, most)
            most -= len(unpacked)
            if unpacker.unconsumed_tail or most <= 0:
                raise ValueError(f"unfolds to more than {EXPANSION} times its size")
            yield from (inner for kind, inner in _elements(unpacked, order) if kind == _MATRIX)
        elif kind == _MATRIX:
            yield content


def _variable(content: bytes, order: str) -> tuple[str, Value | None]:
    """Name and value of a matrix; None for structures, sparse and complex matrices and objects."""
    (_, flags), (_, dimensions), (_, name), *values = _elements(content, order)
    flag = struct.unpack_from(f"{order}I", flags)[0]
    kind, shape = flag & 0xFF, struct.unpack(f"{order}{len(dimensions) // 4}i", dimensions)
    return name.decode("ascii"), None if flag & _COMPLEX else _value(kind, shape, values, order)


def _value(kind: int, shape: tuple[int, ...], values: list[tuple[int, bytes]], order: str) -> Value | None:
    cell, char, numeric = 1, 4, range(6, 16)
    if kind == cell:
        inner = [_variable(content, order)[1] for _, content in values]
        if len(inner) != math.prod(shape):
            raise ValueError(f"a cell array of shape {shape} holds {len(inner)} cells")
        texts = [text for text in inner if isinstance(text, str)]
        return texts if len(texts) == len(inner) else None
    if kind == char:
        raw = b"".join(content for _, content in values)
        codec = _TEXTS[values[0][0]] if values else "utf-8"
        wide = {"<": "-le", ">": "-be"}[order] if codec != "utf-8" else ""
        return raw.decode(codec + wide)
    if kind not in numeric:
        return None
    [(stored, raw)] = values
    return np.frombuffer(raw, order + _NUMBERS[stored]).reshape(shape, order="F").astype(float)
