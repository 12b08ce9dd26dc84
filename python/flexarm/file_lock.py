"""Exclusive locks on open files, by the means of the operating system; a lock ends with its process.

POSIX has `flock`, Windows has `locking` of a range of bytes. Windows removes no file that is open, so its
lock ends before the file is removed; elsewhere the file goes first, and nobody can lock a removed one.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

if sys.platform == "win32":
    import msvcrt

    REMOVED_WHILE_OPEN = False
else:
    import fcntl

    REMOVED_WHILE_OPEN = True
    """True where the path of an open file may be gone, or be that of another file."""


def lock(file: int) -> None:
    """Lock an open file, or raise at once.

    Raise BlockingIOError if another open file holds the lock, and OSError if the file system has no locks.
    """
    if sys.platform == "win32":
        try:
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
        except PermissionError as error:
            raise BlockingIOError(error.errno, error.strerror) from None
    else:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def is_at(file: int, path: Path) -> bool:
    """Return False if an owner removed the locked file before this process could lock it."""
    if not REMOVED_WHILE_OPEN:
        return True
    try:
        return os.path.samestat(os.fstat(file), path.stat())
    except FileNotFoundError:
        return False


def remove(file: int, path: Path) -> None:
    """Remove the locked file and let go of its lock; a file that cannot be removed stays."""
    if not REMOVED_WHILE_OPEN:
        os.close(file)
    with suppress(OSError):
        path.unlink()
    if REMOVED_WHILE_OPEN:
        os.close(file)
