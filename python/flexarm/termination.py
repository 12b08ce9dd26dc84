"""Termination by Ctrl-C or SIGTERM: at once, with one line, and without half-written output.

The signal's handler ends the process itself. An exception would have to pass through libraries that catch
it, and wait for threads that compute. Python calls a handler between two instructions of the main thread,
which may be in a long call of a compiled library: a second thread then leaves in its place.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from contextlib import contextmanager, suppress

TYPE_CHECKING = False  # a command leaves quietly once this module is loaded: typing would cost 7 ms
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path
    from typing import NoReturn

WAYS = {signal.SIGINT: (130, "interrupted"), signal.SIGTERM: (143, "terminated")}
"""Exit code and word of each signal."""

_undo: list[Callable[[], object]] = []
_told: list[Callable[[], str]] = []
_leaving = threading.RLock()  # a second signal interrupts the handler of the first, in the same thread


def exit_on_signals() -> None:
    """Let Ctrl-C and SIGTERM end this process from now on, unless they are ignored."""
    for number in WAYS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _leave)
    if os.name != "posix":  # signals come through a socket there, and Ctrl-C in a thread of its own
        return
    told, tell = os.pipe()
    os.set_blocking(tell, False)
    signal.set_wakeup_fd(tell, warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(told,), daemon=True).start()


def stay() -> None:
    """Ignore Ctrl-C and SIGTERM from now on: the command is done, and only the interpreter has to end."""
    for number in WAYS:
        signal.signal(number, signal.SIG_IGN)


@contextmanager
def undone_on_exit(undo: Callable[[], object]) -> Iterator[None]:
    """Call `undo` if the process leaves within the block, in any thread; its errors count for nothing."""
    _undo.append(undo)
    try:
        yield
    finally:
        _undo.remove(undo)


@contextmanager
def told_on_exit(text: Callable[[], str]) -> Iterator[None]:
    """Say what is kept if the process leaves within the block, in place of what was written whole."""
    _told.append(text)
    try:
        yield
    finally:
        _told.remove(text)


@contextmanager
def scratch_directory() -> Iterator[Path]:
    """Make a directory that vanishes with the block, or with the process."""
    import shutil
    from pathlib import Path
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as path, undone_on_exit(lambda: shutil.rmtree(path, ignore_errors=True)):
        yield Path(path)


def farewell(how: str) -> str:
    """Return the line about a command that was stopped, and the outputs that were written whole."""
    if _told:
        return f"{how}: {_told[-1]()}"
    written = getattr(sys.modules.get("flexarm.output"), "written", ())  # not imported: nothing is
    what = f"{', '.join(map(str, written))} was written whole" if written else "nothing was written"
    return f"{how}: {what}"


def _leave(number: int, frame: object) -> NoReturn:
    with _leaving:
        for undo in reversed(_undo):
            with suppress(Exception):
                undo()
        code, how = WAYS[signal.Signals(number)]
        with suppress(OSError):
            after_a_bar = "\n" if os.isatty(2) else ""
            os.write(2, f"{after_a_bar}{farewell(how)}\n".encode())
        os._exit(code)


def _watch(told: int) -> None:
    """Leave in place of a main thread that has not done so."""
    patience = 0.1  # time that the main thread has to exit by itself [s]
    while True:
        number = os.read(told, 1)[0]
        if number in WAYS:
            time.sleep(patience)
            while signal.getsignal(number) is not _leave:  # held back while output moves to its place
                time.sleep(patience / 10)
            _leave(number, None)
