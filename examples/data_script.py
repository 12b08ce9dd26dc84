"""What the scripts beside measured data share: their command line, how files are read, `flexarm diagnose`."""

from __future__ import annotations

import argparse
import csv
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexarm import InvalidFile, InvalidParameter


def command_line(description: str, data: str, force: bool = False) -> argparse.ArgumentParser:
    """DATA_DIR, which holds `data`, OUT_DIR and, where asked for, --force; a script may add options."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("data", type=Path, metavar="DATA_DIR", help=f"holds {data}")
    parser.add_argument("out", type=Path, metavar="OUT_DIR", help="a new or empty directory")
    if force:
        parser.add_argument("--force", action="store_true", help="write into a directory that holds files")
    return parser


def exit_code(work: Callable[[], int | None]) -> int:
    """Does the work. Its exit code, 0 if it has none; 2 and a line on stderr if the input is at fault."""
    try:
        return work() or 0
    except InvalidParameter as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


def check_folder(data: Path, needed: str) -> None:
    """Refuses a DATA_DIR that is none.

    Raises
    ------
    InvalidFile
        If it is no directory.
    """
    if not data.is_dir():
        raise InvalidFile(data, "DATA_DIR", f"is not a directory; it must hold {needed}")


def read_text(path: Path) -> str:
    """The text of a file.

    Raises
    ------
    InvalidFile
        If it cannot be read, or is no text.
    """
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise InvalidFile(path, "file", f"cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InvalidFile(path, "file", "is not text in UTF-8") from None


def read_numbers(path: Path, headings: Sequence[str]) -> NDArray[np.float64]:
    """The rows of a CSV file with these headings, all of them numbers; empty lines are passed over.

    Raises
    ------
    InvalidFile
        With the line of what is wrong.
    """
    lines = list(csv.reader(read_text(path).splitlines()))
    if not lines or [cell.strip() for cell in lines[0]] != list(headings):
        raise InvalidFile(path, "line 1", f"must be {','.join(headings)!r}")
    rows = [_row(path, number, cells, len(headings)) for number, cells in enumerate(lines[1:], 2) if cells]
    if not rows:
        raise InvalidFile(path, "file", "holds no readings")
    return np.array(rows)


def _row(path: Path, number: int, cells: list[str], count: int) -> list[float]:
    try:
        found = [float(cell) for cell in cells]
    except ValueError:
        found = []
    if len(found) != count or not np.isfinite(found).all():
        raise InvalidFile(path, f"line {number}", f"must be {count} numbers, got {','.join(cells)[:60]!r}")
    return found


def diagnosed(model: Path, training: Path, held_out: Path, page: Path) -> int:
    """`flexarm diagnose` as from a shell; its exit code."""
    words = ["diagnose", model, training, "--hold-out", held_out, "--out", page]
    return subprocess.run([sys.executable, "-m", "flexarm", *map(str, words)], check=False).returncode
