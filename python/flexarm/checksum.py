"""Checksums behind files of results, which tell of damage before the HDF5 library meets it.

The library ends the process at some damaged bytes. It reads nothing behind the end that a file states, and
cuts that off when it changes a file.
"""

from __future__ import annotations

import mmap
import zlib
from pathlib import Path
from typing import BinaryIO

from flexarm.errors import InvalidFile

_MARK = b"flexarm CRC-32 "
_LENGTH = len(_MARK) + 4


def add_checksum(file: BinaryIO) -> None:
    """Write behind a whole file the checksum of what it holds."""
    file.seek(0)
    found = 0
    while piece := file.read(2**20):
        found = zlib.crc32(piece, found)
    file.write(_MARK + found.to_bytes(4, "little"))


def check_checksum(path: Path) -> None:
    """Raise InvalidFile if a file has a checksum, and another one than its bytes."""
    if path.stat().st_size <= _LENGTH:
        return
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as raw:
        if raw[-_LENGTH:-4] != _MARK:
            return
        with memoryview(raw) as whole, whole[:-_LENGTH] as held:
            found = zlib.crc32(held)
        if found != int.from_bytes(raw[-4:], "little"):
            raise InvalidFile(path, "file", "is damaged: its checksum is not that of the bytes in it")
