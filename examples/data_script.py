"""What the scripts beside measured data share: their command line, how files are read, how pages are made."""

from __future__ import annotations

import argparse
import csv
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm import Arm, InvalidFile, InvalidParameter, Record

if TYPE_CHECKING:
    from flexarm.diagnosis.result import Diagnosis


def command_line(description: str, data: str, force: bool = False) -> argparse.ArgumentParser:
    """DATA_DIR, which holds `data`, OUT_DIR and, where asked for, --force; a script may add options."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("data", type=Path, metavar="DATA_DIR", help=f"holds {data}")
    parser.add_argument("out", type=Path, metavar="OUT_DIR", help="a new or empty directory")
    if force:
        parser.add_argument("--force", action="store_true", help="write into a directory that holds files")
    return parser


def page_command_line(description: str, data: str) -> argparse.ArgumentParser:
    """That of the scripts that make pages: DATA_DIR, OUT_DIR, --jobs, --force."""
    parser = command_line(description, data, force=True)
    parser.add_argument("--jobs", type=_count, metavar="N", help="simulations at once; default one a core")
    return parser


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number from 1 on, got {text!r}")
    return int(text)


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


def diagnosed(
    model: Path, training: Sequence[Path], held_out: Path, page: Path, jobs: int | None
) -> Diagnosis:
    """The diagnosis of records, saved as a page: as `flexarm diagnose` makes it, told from start to end."""
    import flexarm
    from flexarm.cli.progress import progress
    from flexarm.cli.records import record_names

    *names, held = record_names([*training, held_out])
    print(f"diagnosing {model.name} with {', '.join(names)}; held out: {held}", file=sys.stderr)
    records = {name: Record.load(folder) for name, folder in zip(names, training, strict=True)}
    began = time.process_time()
    with progress() as tell:
        found: Diagnosis = flexarm.diagnose(
            Arm.from_toml(model), records, hold_out=Record.load(held_out), n_jobs=jobs, progress=tell
        )
    found.save(page)
    print(f"{found}\n\n{page.name}/report.html: {time.process_time() - began:.0f} s of CPU\n")
    return found
