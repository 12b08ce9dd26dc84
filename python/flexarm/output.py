"""Output that is whole or not there: written into a hidden directory, moved to its place at the end.

The hidden directory `.NAME.partial` lies beside the output, or in it where it is a directory that exists: it
may be the root of a file system. A lock on a file in it claims the place. The kernel frees the lock when its
process ends, however it ends, so the next run clears what a killed one left, and never that of a living one.
"""

from __future__ import annotations

import atexit
import os
import re
import shutil
import signal
import threading
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from flexarm import file_lock
from flexarm.arguments import takes
from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.termination import undone_on_exit

PARTIAL, LOCK, ROOM = ".partial", "lock", "new"
"""Ending of the hidden directory's name; in it the locked file, and the directory of what is written."""

PAGES = (".html", ".htm")
"""Endings of the names of pages."""
PAGE, FIGURE = "report.html", "flexarm report"
"""Name of a report's page, and the software that its figures name in their first bytes."""

written: deque[Path] = deque(maxlen=10)
"""The last files and directories that were put in their places."""
_places: dict[Path, Path] = {}
"""Output that this process is writing -> where it will lie."""


@contextmanager
def output_directory(
    path: str | Path, force: bool = False, inputs: Iterable[Path] = (), names: Iterable[str] = ()
) -> Iterator[Path]:
    """Yield a hidden directory to write into, which becomes `path` if the block ends without an error.

    Parents of `path` are made. With `force` it may hold files: those of the same name are replaced, one after
    the other, and others stay; figures of a former report go with its page. Files of `inputs` are never
    replaced; `names` are files that will be written, where they are known: so an input is found before the
    work.

    Raise InvalidFile if `path` is a file, holds files without `force`, is being written by another process,
    would lose an input, or cannot be written.

    >>> with output_directory("results") as directory:  # doctest: +SKIP
    ...     (directory / "summary.json").write_text("{}")
    """
    target, kept = Path(path), tuple(inputs)
    with _claimed(target) as partial:
        with writing(target):
            _refuse_occupied(target, force)
            _refuse_inputs((target / name for name in names), kept)
            partial.mkdir()
        try:
            yield partial
        except OSError as error:
            if not isinstance(error.filename, str) or place_of(error.filename) == Path(error.filename):
                raise  # about something else
            raise _unwritten(target, error) from None
        with uninterrupted(), writing(target):
            _refuse_occupied(target, force)
            _move(partial, target, kept)
            _note(target)


@contextmanager
def growing_directory(
    path: str | Path, more: bool = False, inputs: Iterable[Path] = (), names: Iterable[str] = ()
) -> Iterator[Path]:
    """Claim a directory that is filled file by file, and keeps what it has if the block ends with an error.

    Its parents are made, and removed again if nothing was put there; `more` takes one that holds files.
    Yields a hidden directory in it, for files that are moved to their places once they are whole. Inputs,
    names and errors are as of `output_directory`.
    """
    target, made = Path(path), list[Path]()
    with writing(target):
        _refuse_occupied(target, more)
        _refuse_inputs((target / name for name in names), tuple(inputs))
        _make_parents(target, made)
    try:
        with _claimed(target) as partial:
            _refuse_occupied(target, more)
            partial.mkdir()
            yield partial
    finally:
        for parent in made:
            with suppress(OSError):
                parent.rmdir()


@contextmanager
def output_file(path: str | Path, inputs: Iterable[Path] = (), force: bool = True) -> Iterator[Path]:
    """Yield a file in a hidden directory, which becomes `path` if the block ends without an error.

    The directory of `path` is there; with `force` a file of that name is replaced, one of the inputs never.

    Raise InvalidFile if the file is being written by another process, is there without `force`, is an input,
    or cannot be written.
    """
    target = Path(path)
    if not target.parent.is_dir():
        what = f"cannot be written: there is no directory {target.parent}"
        raise InvalidFile(place_of(target), "output", what)
    if place_of(target) != target:  # it appears with its directory
        with writing(target):
            yield target
        return
    refuse_existing(target, force, inputs)
    with _claimed(target) as partial:
        with writing(target):
            yield partial
        refuse_existing(target, force)  # another run may have written it meanwhile
        with uninterrupted(), writing(target):
            partial.replace(target)
            _note(target)


def write_file(
    path: str | Path,
    content: str | bytes | memoryview,
    inputs: Iterable[Path] = (),
    force: bool = True,
) -> None:
    """Write a file, which appears when it is whole; text in UTF-8.

    Raise InvalidFile as `output_file`.
    """
    with output_file(path, inputs, force) as partial:
        partial.write_bytes(content.encode() if isinstance(content, str) else content)


def refuse_suffix(path: Path, allowed: tuple[str, ...]) -> None:
    """Refuse a file whose name says that it is of another format.

    Raise InvalidFile if the name ends in anything else than what is allowed; no ending is allowed too.
    """
    if path.suffix and path.suffix.lower() not in allowed:
        raise InvalidFile(path, "output", f"must end in {' or '.join(allowed)}, got {path.suffix!r}")


def refuse_existing(path: Path, force: bool, inputs: Iterable[Path] = ()) -> None:
    """Refuse a place where a file cannot go, before the work is done rather than after it.

    Raise InvalidFile if the place is no file's, there is a file and no `force`, or the file is an input.
    """
    if path.is_dir() or not path.absolute().parent.is_dir():
        raise InvalidFile(path, "output", "must be a file in a directory that exists")
    if path.exists() and not path.is_file():
        raise InvalidFile(path, "output", "is a device or pipe; allowed is a new file, or a file to replace")
    if path.exists() and not force:
        raise InvalidFile(path, "output", "exists already; allowed is a new file, or --force")
    _refuse_inputs([path], inputs)


def place_of(path: str | Path) -> Path:
    """Return the final place of a file that is being written: outside the hidden directory."""
    place = Path(path)
    for partial, final in reversed(_places.copy().items()):
        if place.is_relative_to(partial):
            place = final / place.relative_to(partial)
    return place


@contextmanager
def writing(target: Path) -> Iterator[None]:
    """Turn errors of the operating system into those of an output, `InvalidFile` at "output"."""
    try:
        yield
    except (OSError, ValueError) as error:
        if isinstance(error, InvalidParameter):
            raise
        raise _unwritten(target, error) from None


class SavedAsDirectory(ABC):
    """A result of several files."""

    @abstractmethod
    def write(self, directory: Path) -> None:
        """Write the files into a directory that is there."""

    @takes()
    def save(self, directory: str | Path, force: bool = False) -> None:
        """Write the files, see `write`, all of them or none.

        Parameters
        ----------
        directory : str or Path
            A new or empty directory.
        force : bool
            Write into a directory that holds files.

        Raises
        ------
        InvalidFile
            If the directory holds files, or cannot be written.
        """
        with output_directory(directory, force) as place:
            self.write(place)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold Ctrl-C and SIGTERM back until the block ends; they only reach the main thread."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    held: list[int] = []
    handlers: dict[signal.Signals, Any] = {}
    try:
        for number in (signal.SIGINT, signal.SIGTERM):
            if (handler := signal.getsignal(number)) is not None:  # None: not Python's, cannot be put back
                handlers[number] = handler
                signal.signal(number, lambda number, frame: held.append(number))
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        for caught in held:
            signal.raise_signal(caught)


def _note(target: Path) -> None:
    if place_of(target) == target:
        written.append(target)


class _Claim:
    """A place that no other process writes to, and a hidden directory of which nothing is left at the end.

    What is written lies in that directory at `partial`.
    """

    def __init__(self, target: Path) -> None:
        self._target = target
        self._hidden = _hidden(target)
        self._parents: list[Path] = []
        self._lock: int | None = None
        self.partial = self._hidden / ROOM / self._hidden.name.removesuffix(PARTIAL)[1:]

    def take(self) -> None:
        """Claim the place and clear what a killed process left there."""
        _make_parents(self._hidden.parent, self._parents)
        self._lock = _lock(self._hidden, self._target)
        shutil.rmtree(self.partial.parent, ignore_errors=True)
        self.partial.parent.mkdir()
        _places[self.partial] = self._target
        atexit.register(self.release)  # an interrupt may keep the block's end from being reached

    def release(self) -> None:
        """Leave the place; does nothing the second time."""
        _places.pop(self.partial, None)
        if self._lock is not None:
            shutil.rmtree(self.partial.parent, ignore_errors=True)
            file_lock.remove(self._lock, self._hidden / LOCK)
            with suppress(OSError):
                self._hidden.rmdir()
            self._lock = None
            atexit.unregister(self.release)
        for parent in self._parents:
            with suppress(OSError):
                parent.rmdir()


@contextmanager
def _claimed(target: Path) -> Iterator[Path]:
    claim = _Claim(target)
    try:
        try:
            with undone_on_exit(claim.release):  # before a signal that came meanwhile is passed on
                with uninterrupted(), writing(target):
                    claim.take()
                yield claim.partial
        finally:
            with uninterrupted():
                claim.release()
    finally:  # an interrupt may have come before it was held back
        with uninterrupted():
            claim.release()


def _hidden(target: Path) -> Path:
    """Return the directory that claims a place: in an existing directory, else next to the output."""
    place = target.absolute()
    return (place if place.is_dir() else place.parent) / f".{place.name or 'root'}{PARTIAL}"


def _make_parents(directory: Path, made: list[Path]) -> None:
    """Make a directory and its missing parents; `made` gets those made, deepest first."""
    for each in reversed([directory, *directory.parents]):
        if not each.is_dir():
            each.mkdir()
            made.insert(0, each)


def _lock(hidden: Path, target: Path) -> int:
    """Return the open file whose lock claims the hidden directory.

    Raise InvalidFile if another run holds it.
    """
    while True:
        made = not hidden.is_dir()
        hidden.mkdir(exist_ok=not made)
        try:
            lock = os.open(hidden / LOCK, os.O_RDWR | os.O_CREAT, 0o600)
        except FileNotFoundError:  # its owner has just removed it
            continue
        if not _holds(lock, made):
            os.close(lock)
            what = f"another run is writing it; allowed is another place (if none runs, remove {hidden})"
            raise InvalidFile(target, "output", what)
        if file_lock.is_at(lock, hidden / LOCK):
            return lock
        os.close(lock)


def _holds(lock: int, made: bool) -> bool:
    try:
        file_lock.lock(lock)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks: the place is his who made the directory
        return made
    return True


def _refuse_occupied(target: Path, force: bool) -> None:
    if target.exists() and not target.is_dir():
        raise InvalidFile(target, "output", "is a file, a directory is needed")
    hidden = _hidden(target)
    if not force and target.is_dir() and any(item.name != hidden.name for item in target.iterdir()):
        what = "holds files already; allowed is a new or empty directory, or --force"
        raise InvalidFile(target, "output", what)


def _refuse_inputs(places: Iterable[Path], inputs: Iterable[Path]) -> None:
    kept = [each for each in inputs if each.exists()]
    for place in places:
        for each in kept:
            if place.exists() and place.samefile(each):
                what = f"would replace {each}, which is read; allowed is another place"
                raise InvalidFile(place, "output", what)


def _move(partial: Path, target: Path, inputs: tuple[Path, ...]) -> None:
    """Put a directory in its place; into an existing one file by file, once nothing is in the way."""
    if not target.exists():
        partial.rename(target)
        return
    pairs = [(item, target / item.relative_to(partial)) for item in sorted(partial.rglob("*"))]
    _refuse_inputs((place for item, place in pairs if not item.is_dir()), inputs)
    for item, place in pairs:
        if place.exists() and item.is_dir() != place.is_dir():
            raise InvalidFile(place, "output", f"is a {'file' if item.is_dir() else 'directory'} in the way")
    if (partial / PAGE).exists():
        for figure in _outdated_figures(target, {item.name for item, _ in pairs}):
            figure.unlink()
    for item, place in pairs:
        if item.is_dir():
            place.mkdir(exist_ok=True)
        else:
            item.replace(place)


def _outdated_figures(directory: Path, names: Collection[str]) -> list[Path]:
    """Return figures of a former report that the new one, of these files, does not replace."""
    figures = [each for each in directory.glob("*.png") if each.is_file() and each.name not in names]
    return [each for each in figures if FIGURE.encode() in each.read_bytes()[:256]]


def _unwritten(target: Path, error: Exception) -> InvalidFile:
    """Return the error of an output that cannot be written."""
    named = getattr(error, "filename", None)
    if isinstance(named, str) and place_of(named) != Path(named):
        target = Path(named)
    what = f"cannot be written: {getattr(error, 'strerror', None) or error}"
    return InvalidFile(place_of(target), "output", what)


def stems(names: Sequence[str]) -> list[str]:
    """Return different names that files may have.

    >>> stems(["slow", "day 1/slow", "day 1:slow"])
    ['slow', 'day-1-slow', 'day-1-slow-2']
    """
    found: list[str] = []
    for name in names:
        plain = re.sub(r"[^\w.-]+", "-", name).strip(".-") or "unnamed"
        count = 1 + sum(re.fullmatch(rf"{re.escape(plain)}(-\d+)?", other) is not None for other in found)
        found.append(plain if count == 1 else f"{plain}-{count}")
    return found
