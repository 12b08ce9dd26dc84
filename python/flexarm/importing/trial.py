"""A first read of a log in a process of its own, for formats whose libraries may end the program.

Some damaged bytes make a compiled library write where it must not. No check of a file foresees all of them;
a process that ends is seen by the one that started it.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from flexarm.errors import InvalidFile
from flexarm.importing.map_file import Dialect
from flexarm.importing.source import Request, Source


def try_apart(reader: type[Source], path: Path, dialect: Dialect, requests: Sequence[Request]) -> None:
    """Read a log in another process.

    Raise InvalidFile if the reader ends that process. Errors that it raises come again in this one.
    """
    given = pickle.dumps((reader, path.absolute(), dialect, tuple(requests)))
    command = [sys.executable, "-m", __name__]
    done = subprocess.run(command, input=given, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    if (name := _fatal(done.returncode)) is not None:
        raise InvalidFile(path, "file", f"is damaged: the library that reads it ended with {name}")


def _fatal(code: int) -> str | None:
    """Return the fault that ended a process; None if it ended by itself, or others ended it."""
    if os.name == "nt":
        return f"exception {code & 0xFFFFFFFF:#x}" if code & 0xFFFFFFFF >= 0xC0000000 else None
    faults = ("SIGSEGV", "SIGABRT", "SIGBUS", "SIGFPE", "SIGILL")
    return next((name for name in faults if code == -getattr(signal, name)), None)


def _read_all(reader: type[Source], path: Path, dialect: Dialect, requests: Sequence[Request]) -> None:
    source = reader(path, dialect, requests)
    for request in requests:
        source.read(request)
    if requests:
        return
    for group in source.groups():
        for index in range(len(source.names(group.topic))):
            with suppress(ValueError):
                source.array(group.topic, index)


if __name__ == "__main__":
    _read_all(*pickle.load(sys.stdin.buffer))
