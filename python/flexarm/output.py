"""Output that is whole or not there: written beside its place, moved there at the end."""

from __future__ import annotations

import re
import shutil
import tempfile
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from flexarm.errors import InvalidFile
from flexarm.leaving import undone_on_leaving


@contextmanager
def output_directory(path: str | Path, force: bool = False) -> Iterator[Path]:
    """A directory to write into, which becomes `path` when the block ends well and vanishes when it does not.

    Parameters
    ----------
    path : str or Path
        Where the output shall be; parents are made.
    force : bool
        Write into a directory that holds files. Files of the same name are replaced, others stay.

    Yields
    ------
    Path
        A hidden directory beside `path`.

    Raises
    ------
    InvalidFile
        If `path` is a file, holds files without `force`, or cannot be written.

    Examples
    --------
    >>> with output_directory("results") as directory:  # doctest: +SKIP
    ...     (directory / "summary.json").write_text("{}")
    """
    target = Path(path)
    _refuse_occupied(target, force)
    made = _make_parents(target)
    try:
        partial = Path(
            tempfile.mkdtemp(prefix=f".{target.resolve().name}.partial-", dir=target.resolve().parent)
        )
    except OSError as error:
        _remove_empty(made)
        raise InvalidFile(path, "output", f"cannot be written: {error.strerror}") from None

    def undo() -> None:
        shutil.rmtree(partial, ignore_errors=True)
        _remove_empty(made)

    try:
        partial.chmod(0o755)
        with undone_on_leaving(undo):
            yield partial
            _move(partial, target, path)
    except BaseException:
        undo()
        raise


@contextmanager
def output_file(path: str | Path) -> Iterator[Path]:
    """A file to write, which becomes `path` when the block ends well and vanishes when it does not.

    Parameters
    ----------
    path : str or Path
        Where the output shall be, in a directory that is there; a file of that name is replaced.

    Yields
    ------
    Path
        A hidden file beside `path`, with the same ending.

    Raises
    ------
    InvalidFile
        If it cannot be written.
    """
    target = Path(path)
    if not target.parent.is_dir():
        raise InvalidFile(path, "output", f"cannot be written: there is no directory {target.parent}")
    partial = target.with_name(f".{target.stem}.partial{target.suffix}")
    try:
        with undone_on_leaving(lambda: partial.unlink(missing_ok=True)):
            yield partial
            partial.replace(target)
    except OSError as error:
        raise InvalidFile(path, "output", f"cannot be written: {error.strerror or error}") from None
    finally:
        partial.unlink(missing_ok=True)


class SavedAsDirectory(ABC):
    """A result of several files."""

    @abstractmethod
    def write(self, directory: Path) -> None:
        """Writes the files into a directory that is there."""

    def save(self, directory: str | Path, force: bool = False) -> None:
        """Writes the files, see `write`, all of them or none.

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


def _refuse_occupied(target: Path, force: bool) -> None:
    try:
        if target.exists() and not target.is_dir():
            raise InvalidFile(target, "output", "is a file, a directory is needed")
        if target.is_dir() and not force and next(target.iterdir(), None) is not None:
            raise InvalidFile(
                target, "output", "holds files already; allowed is a new or empty directory, or --force"
            )
    except (OSError, ValueError) as error:
        if isinstance(error, InvalidFile):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise InvalidFile(target, "output", f"cannot be written: {reason}") from None


def _make_parents(target: Path) -> list[Path]:
    """Makes the missing parents; returns those made, deepest first."""
    missing = [parent for parent in target.resolve().parents if not parent.exists()]
    try:
        target.resolve().parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        _remove_empty(missing)
        raise InvalidFile(target, "output", f"cannot be written: {error.strerror}") from None
    return missing


def _remove_empty(directories: list[Path]) -> None:
    for directory in directories:
        try:
            directory.rmdir()
        except OSError:
            return


def _move(partial: Path, target: Path, named: str | Path) -> None:
    """Puts the finished directory in its place; into an existing one file by file."""
    try:
        if not target.exists():
            partial.rename(target)
            return
        for item in sorted(partial.rglob("*")):
            place = target / item.relative_to(partial)
            if item.is_dir():
                place.mkdir(exist_ok=True)
            else:
                item.replace(place)
        shutil.rmtree(partial)
    except OSError as error:
        raise InvalidFile(named, "output", f"cannot be written: {error.strerror}") from None


def stems(names: Sequence[str]) -> list[str]:
    """Names that files may have, whatever the things are called, no two alike.

    >>> stems(["slow", "day 1/slow", "day 1:slow"])
    ['slow', 'day-1-slow', 'day-1-slow-2']
    """
    found: list[str] = []
    for name in names:
        plain = re.sub(r"[^\w.-]+", "-", name).strip(".-") or "unnamed"
        count = 1 + sum(re.fullmatch(rf"{re.escape(plain)}(-\d+)?", other) is not None for other in found)
        found.append(plain if count == 1 else f"{plain}-{count}")
    return found
