"""VTK unstructured grids (.vtu), as ParaView, pyvista and many solvers write them.

VTU has no sets. By convention here, an array of zeros and ones on points is the set of the points where it is
one; an array of zeros and ones on cells is the group, or for surface cells the set, of those where it is one;
any other array of whole numbers on cells is a group `ARRAY-NUMBER` for each number in it.
"""

from __future__ import annotations

import lzma
import re
import zlib
from base64 import b64decode
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.arrays import Ints
from flexarm.errors import InvalidFile
from flexarm.reading import room
from flexarm.solids.reading.content import Content
from flexarm.solids.reading.through_meshlane import blocks_of, read_by

_NOT_GROUPS = re.compile(r"vtkOriginal|GlobalNodeId|GlobalElementId|GlobalCellId|vtkGhost", re.IGNORECASE)


def content(path: Path) -> Content:
    """Read the content of a VTU file."""
    return read_by(_content, path, "VTK unstructured grid")


def _content(path: Path) -> Content:
    import meshlane

    _refuse_swollen(path)
    mesh = meshlane.vtu.read(str(path))
    blocks = blocks_of(mesh)
    _refuse_losses(path, sum(len(block.data) for block in mesh.cells))
    found = Content(np.asarray(mesh.points, float), np.arange(1, len(mesh.points) + 1), blocks)
    for name, values in mesh.point_data.items():
        array = np.asarray(values)
        if array.ndim == 1 and _is_mask(array) and not _NOT_GROUPS.match(name):
            found.point_sets[name] = np.flatnonzero(array)
    for name, parts in mesh.cell_data.items():
        if not _NOT_GROUPS.match(name):
            found.groups |= _groups(name, [np.asarray(part) for part in parts])
    return found


def _groups(name: str, parts: list[Any]) -> dict[str, dict[int, Ints]]:
    most_numbers = 1000
    whole: Any = np.concatenate(parts) if parts else np.empty(0)
    if whole.ndim != 1 or whole.dtype.kind not in "iub" or not whole.size:
        return {}
    if _is_mask(whole):
        return {name: {i: np.flatnonzero(part) for i, part in enumerate(parts)}}
    numbers = np.unique(whole)
    if len(numbers) > min(most_numbers, max(1, len(whole) // 2)):  # numbers of cells, not of groups
        return {}
    return {
        f"{name}-{number}": {i: np.flatnonzero(part == number) for i, part in enumerate(parts)}
        for number in numbers
    }


def _is_mask(values: Ints) -> bool:
    return values.dtype.kind in "iub" and bool(np.isin(values, (0, 1)).all()) and bool(values.any())


def _refuse_losses(path: Path, n_read: int) -> None:
    """Refuse several pieces, of which meshlane keeps the last, and types of cells that it skips."""
    pieces = re.findall(rb"<Piece[^>]*NumberOfCells\s*=\s*[\"']\s*(\d+)", path.read_bytes())
    if len(pieces) > 1:
        raise InvalidFile(path, "UnstructuredGrid", f"holds {len(pieces)} pieces; save it as one")
    if pieces and int(pieces[0]) != n_read:
        what = f"{int(pieces[0]) - n_read} of {int(pieces[0])} cells are of types that cannot be read"
        raise InvalidFile(path, "Cells", what)


def _refuse_swollen(path: Path) -> None:
    """Refuse compressed arrays that unfold to more than they declare, or than such a file can hold.

    An array is a header of whole numbers, then blocks: their count, the size of each, that of the last one if
    it is another, and the compressed sizes of all. Source: "VTK XML Formats", section "Compressed data".
    """
    raw = path.read_bytes()
    root = _attributes(re.search(rb"<VTKFile([^>]*)>", raw))
    compressor: Callable[[], Any]
    if root.get("compressor") == "vtkZLibDataCompressor":
        compressor = zlib.decompressobj
    elif root.get("compressor") == "vtkLZMADataCompressor":
        compressor = lzma.LZMADecompressor
    else:
        return  # there is none, or one that the reader refuses
    order = ">" if root.get("byte_order") == "BigEndian" else "<"
    kind = np.dtype(f"{order}u{8 if root.get('header_type') == 'UInt64' else 4}")
    appended = re.search(rb"<AppendedData([^>]*)>\s*_", raw)
    total = 0
    for array in re.finditer(rb"<DataArray([^>]*)>\s*([^<]*)", raw):
        about, start = _attributes(array), array.start(2)
        coded = True
        if about.get("format") == "appended" and appended:
            start = appended.end() + int(about["offset"])
            coded = _attributes(appended).get("encoding") != "raw"
        elif about.get("format") != "binary":
            continue
        count = int(np.frombuffer(_bytes(raw, start, kind.itemsize, coded), kind)[0])
        whole = _bytes(raw, start, (3 + count) * kind.itemsize, coded)
        header = np.frombuffer(whole, kind, min(3 + count, len(whole) // kind.itemsize)).tolist()
        declared = [header[1]] * len(header[3:])
        declared[-1:] = [header[2] or header[1]] if declared else []
        total += sum(declared)
        room(path, "DataArray", total)
        ends = np.cumsum([0, *header[3:]], dtype=object).tolist()
        body = _bytes(raw, start + _length(len(header) * kind.itemsize, coded), ends[-1], coded)
        for (begin, end), size in zip(pairwise(ends), declared, strict=True):
            if len(compressor().decompress(body[begin:end], size + 1)) > size:
                what = f"holds a block of more than the {size} bytes that it declares"
                raise InvalidFile(path, "DataArray", what)


def _attributes(tag: re.Match[bytes] | None) -> dict[str, str]:
    """Return the attributes in the first group of a match."""
    found = re.findall(rb"""(\w+)\s*=\s*["']([^"']*)""", tag[1] if tag else b"")
    return {name.decode(): value.decode(errors="replace") for name, value in found}


def _length(count: int, coded: bool) -> int:
    """Return how many characters so many bytes take."""
    return 4 * -(-count // 3) if coded else count


def _bytes(raw: bytes, start: int, count: int, coded: bool) -> bytes:
    """Return bytes from a place of a file on, as many as are there."""
    piece = raw[start : start + _length(count, coded)]
    return b64decode(piece)[:count] if coded else piece
