"""Files as they come in: only regular ones, no more than they can hold, and one kind of error.

A reader asks `regular_file` before it opens anything, `room` before it takes up what a file declares, and
does its work inside `reading`, which turns whatever a library meets in a damaged file into `InvalidFile`.
"""

from __future__ import annotations

import mmap
import os
import re
import stat
import struct
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from io import BufferedReader, FileIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.checksum import check_checksum
from flexarm.errors import InvalidFile, InvalidParameter, NotConverged

if TYPE_CHECKING:
    import xarray as xr

SMALL = 2**28
"""Bytes that any file may unfold to: 256 MB, a part of 3000 freedoms."""
EXPANSION = 20
"""Times its size that a compressed file may unfold to, above `SMALL`: numbers with noise shrink far less."""
OUTSIDE: ContextVar[bool] = ContextVar("OUTSIDE", default=False)
"""True if records may name files outside their directories, see --allow-outside."""


def regular_file(path: str | Path) -> Path:
    """Return the path, if a regular file is there that may be read; links are followed.

    Raise InvalidFile if nothing is there, or a directory, pipe, device or socket, which might never end.
    """
    try:
        mode = Path(path).stat().st_mode
    except FileNotFoundError:
        raise InvalidFile(path, "file", "there is no such file") from None
    except (OSError, ValueError) as error:  # ValueError: a path with a null byte
        reason = getattr(error, "strerror", None) or str(error)
        raise InvalidFile(path, "file", f"cannot be read: {reason}") from None
    if stat.S_ISDIR(mode):
        raise InvalidFile(path, "file", "is a directory, a file is needed")
    if not stat.S_ISREG(mode):
        raise InvalidFile(path, "file", "is no regular file; pipes and devices are not read")
    if not os.access(path, os.R_OK):
        raise InvalidFile(path, "file", "cannot be read: Permission denied")
    return Path(path)


def is_inside(path: Path, folder: Path) -> bool:
    """Return True if a path that can be followed lies in a folder, links and all."""
    try:
        return path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):  # links in a circle, a null byte, a name that is too long
        return False


def any_text(path: str | Path) -> str:
    """Return the text of another program's file: UTF-8, or UTF-16 that says so, or else Latin-1.

    Raise InvalidFile if it is no regular file, or cannot be read.
    """
    with reading(regular_file(path), "text"):
        raw = Path(path).read_bytes()
        if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
            return raw.decode("utf-16")
        try:
            return raw.decode("utf-8-sig")
        except UnicodeDecodeError:
            return raw.decode("latin-1")


def decoded(path: str | Path, raw: bytes, encoding: str) -> str:
    """Return the text that bytes of a file are; raise InvalidFile with the line of the first that is none."""
    try:
        return raw.decode(encoding)
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        byte = f"byte 0x{error.object[error.start]:02x} at position {error.start}"
        raise InvalidFile(path, f"line {line}", f"not a text in {encoding.upper()}: {byte}") from error
    except LookupError:
        raise InvalidFile(path, "line 1", f"declares the unknown encoding {encoding!r}") from None


def xml_text(path: str | Path, raw: bytes) -> tuple[str, str]:
    """Return the text of an XML file, its byte order mark included, and its encoding.

    UTF-16 if its first bytes say so, else what it declares, else UTF-8. Source: XML 1.0, appendix F.
    """
    for wide in ("utf-16-le", "utf-16-be"):
        if raw.startswith(("\ufeff".encode(wide), "<".encode(wide))):
            return decoded(path, raw, wide), wide
    declared = re.match(rb"(?:\xef\xbb\xbf)?<\?xml\s[^>]*?\bencoding\s*=\s*[\"']([\w.:-]+)", raw)
    encoding = declared[1].decode() if declared else "utf-8"
    return decoded(path, raw, encoding), encoding


@contextmanager
def reading(path: str | Path, what: str, where: str = "file") -> Iterator[None]:
    """Turn errors while a file is parsed as `what`, such as "a NetCDF file", to `InvalidFile` at `where`."""
    try:
        yield
    except (InvalidFile, NotConverged):
        raise
    except InvalidParameter as error:
        first = error.problems[0]
        raise InvalidFile(path, first.where or where, first.what, problems=error.problems) from None
    except Exception as error:  # a damaged file fails in whatever the reader happens to meet
        told = getattr(error, "strerror", None) or " ".join(str(error).split())
        reason = f"{type(error).__name__}: {told}" if isinstance(error, LookupError) else told
        raise InvalidFile(
            path, where, f"cannot be read as {what}: {reason or type(error).__name__}"
        ) from None


@dataclass
class Includes:
    """The files that a file includes, and those these include: no circles, and an end."""

    open: list[Path] = field(default_factory=list)
    """Those being read, each included by the one before it."""
    count: int = 0
    """Those included so far."""

    @contextmanager
    def into(self, file: Path, where: str, name: str) -> Iterator[Path]:
        """Yield the file that `name` is, relative to the one that includes it, while it is read.

        Raise InvalidFile if it is not there, includes itself, lies too deep, or is one too many.
        """
        most_includes = 1000  # files that a mesh may include in all
        deepest_include = 20  # files that may include one another in turn
        path = file.parent / name
        try:
            regular_file(path)
        except InvalidFile as error:
            what = error.problems[0].what.replace("there is no such file", "is not there")
            raise InvalidFile(file, where, f"{path} {what}") from None
        self.open.append(file.resolve())
        self.count += 1
        if path.resolve() in self.open:
            raise InvalidFile(file, where, f"{name!r} is being read already: files include one another")
        if len(self.open) > deepest_include or self.count > most_includes:
            what = f"includes go at most {deepest_include} deep and are at most {most_includes} in all"
            raise InvalidFile(file, where, what)
        yield path
        self.open.pop()


class BoundedFile(BufferedReader):
    """A file of which no more is read than it holds: Python takes up first what a damaged length asks for."""

    def __init__(self, path: str | Path) -> None:
        super().__init__(FileIO(path))
        self._size = os.fstat(self.fileno()).st_size

    def read(self, size: int | None = -1) -> bytes:
        """Return so many bytes, or all that are left."""
        left = max(0, self._size - self.tell())
        return super().read(left if size is None or size < 0 else min(size, left))


def room(path: str | Path, where: str, declared: int, size: int | None = None) -> None:
    """Raise InvalidFile if a piece of a file declares more bytes than such a file can hold.

    `size` are the bytes of the file, asked for if left out.
    """
    size = Path(path).stat().st_size if size is None else size
    most = max(SMALL, EXPANSION * size)
    if declared > most:
        what = f"declares {declared} bytes in a file of {size}; allowed are {most}"
        raise InvalidFile(path, where, what)


def check_hdf5(path: str | Path) -> None:
    """Raise InvalidFile if HDF5 is damaged, leads to other files, or unfolds to more than a file can hold."""
    import h5py  # type: ignore[import-untyped]

    check_checksum(regular_file(path))
    if has_endless_heap(Path(path)):
        raise InvalidFile(path, "file", "cannot be read as NetCDF: texts in it have no end")
    with reading(path, "NetCDF"), h5py.File(path, "r") as file:
        total, size = 0, Path(path).stat().st_size
        for name in file:
            if not isinstance(file.get(name, getlink=True), h5py.HardLink):
                raise InvalidFile(path, name, "is a link; allowed are numbers that the file holds itself")
            item = file[name]
            if not isinstance(item, h5py.Dataset):
                continue
            if item.is_virtual or item.external:
                raise InvalidFile(path, name, "lies in another file; allowed are numbers that the file holds")
            width = 64 if item.dtype.kind == "O" else item.dtype.itemsize  # a text of Python
            total += (item.size or 0) * width
            room(path, name, total, size)


def has_endless_heap(path: Path) -> bool:
    """Return True if texts of an HDF5 file are damaged so that the HDF5 library never ends.

    A collection of texts is a row of objects, each with its size; the library follows a free one of size zero
    for ever. Source: HDF5 File Format Specification, section III.E, "Global Heap".
    """
    if path.stat().st_size == 0:
        return False
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as raw:
        start = raw.find(_HEAP)
        while start >= 0:
            at, end = start + 16, min(start + int.from_bytes(raw[start + 8 : start + 16], "little"), len(raw))
            while at + 16 <= end:
                index, size = struct.unpack_from("<H6xQ", raw, at)
                if index == 0 and size == 0:
                    return True
                at += size if index == 0 else 16 + size + -size % 8
            start = raw.find(_HEAP, start + 1)
    return False


_HEAP = b"GCOL\x01\0\0\0"
"""First bytes of a collection of texts."""


def require(
    path: str | Path, data: xr.Dataset, axes: Mapping[str, Sequence[str]], sizes: Mapping[str, int]
) -> None:
    """Raise InvalidFile unless variables are there, as real numbers of the right shape.

    `axes` says what the axes of each count, and `sizes` how many there are of it; another axis is as long as
    the first variable says that has it.
    """
    known: dict[str, int] = dict(sizes)
    for name, counted in axes.items():
        if name not in data:
            raise InvalidFile(path, name, f"is missing; needed are {', '.join(axes)}")
        values: Any = data[name]
        if values.dtype.kind not in "fiu":
            raise InvalidFile(path, name, f"must hold real numbers, got type {values.dtype}")
        shape = values.shape
        wanted = tuple(known.setdefault(axis, n) for axis, n in zip(counted, shape, strict=False))
        if len(shape) != len(counted) or shape != wanted:
            told = ", ".join(f"{axis}: {known[axis]}" if axis in known else axis for axis in counted)
            raise InvalidFile(path, name, f"must have the shape ({told}), got {shape}")
