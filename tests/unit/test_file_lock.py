"""A lock on a file keeps others away, on POSIX and, with the calls of Windows stood in for, there."""

import errno
import importlib.util
import os
import sys
import types
from pathlib import Path

import pytest

from flexarm import file_lock


class Windows(types.ModuleType):
    """`msvcrt.locking` on one table of locked files: a second lock is refused, closing does not show here."""

    LK_NBLCK = 2

    def __init__(self) -> None:
        super().__init__("msvcrt")
        self.locked: set[int] = set()

    def locking(self, file: int, mode: int, length: int) -> None:
        assert (mode, length) == (self.LK_NBLCK, 1)
        inode = os.fstat(file).st_ino
        if inode in self.locked:
            raise PermissionError(errno.EACCES, "Permission denied")
        self.locked.add(inode)


def as_on_windows(monkeypatch: pytest.MonkeyPatch) -> types.ModuleType:
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setitem(sys.modules, "msvcrt", Windows())
    spec = importlib.util.spec_from_file_location("lock_of_windows", file_lock.__file__)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("system", ["this one", "Windows"])
def test_a_second_opener_is_refused_and_nothing_is_left(
    system: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = file_lock if system == "this one" else as_on_windows(monkeypatch)
    path = tmp_path / "lock"
    first, second = (os.open(path, os.O_RDWR | os.O_CREAT) for _ in range(2))
    module.lock(first)
    with pytest.raises(BlockingIOError):
        module.lock(second)
    assert module.is_at(first, path)
    module.remove(first, path)
    assert not path.exists()
    with pytest.raises(OSError):
        os.fstat(first)  # closed
    os.close(second)


def test_a_lock_on_a_removed_file_is_told(tmp_path: Path) -> None:
    file = os.open(tmp_path / "lock", os.O_RDWR | os.O_CREAT)
    file_lock.lock(file)
    (tmp_path / "lock").unlink()
    assert not file_lock.is_at(file, tmp_path / "lock")
    (tmp_path / "lock").touch()  # another owner's
    assert not file_lock.is_at(file, tmp_path / "lock")
    os.close(file)


def test_windows_lets_go_before_it_removes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = as_on_windows(monkeypatch)
    file = os.open(tmp_path / "lock", os.O_RDWR | os.O_CREAT)
    order: list[str] = []
    close, unlink = os.close, Path.unlink
    monkeypatch.setattr(os, "close", lambda number: (order.append("close"), close(number)))
    monkeypatch.setattr(Path, "unlink", lambda path: (order.append("unlink"), unlink(path)))
    module.remove(file, tmp_path / "lock")
    assert order == ["close", "unlink"]
