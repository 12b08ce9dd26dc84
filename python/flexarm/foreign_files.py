"""Kinds of files that flexarm does not read as its own, by their first bytes."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path

LOGS = {
    b"#ROSBAG V": "a ROS 1 bag",
    b"\x89MCAP0\r\n": "an MCAP file, such as a ROS 2 bag",
    b"SQLite format 3\0": "an SQLite file, such as a ROS 2 bag",
    b"MATLAB 5.0 MAT-file": "a MATLAB file",
    b"MATLAB 7.3 MAT-file": "a MATLAB file (v7.3)",
    b"\x89HDF\r\n\x1a\n": "an HDF5 file",
    b"CDF\x01": "a NetCDF file",
    b"CDF\x02": "a NetCDF file",
    b"CDF\x05": "a NetCDF file",
    b"PAR1": "a Parquet file",
    b"ARROW1": "a Feather file",
    b"FEA1": "a Feather file",
    b"TDSm": "a TDMS file",
    b"MDF     ": "an MDF file",
    b"UnFinMF ": "an MDF file",
    b"\xd0\xcf\x11\xe0": "an Excel file",
}
"""First bytes of logs that `flexarm import` reads."""
OTHERS = {
    b"PK\x03\x04": "a zip archive",
    b"\x1f\x8b": "a gzip archive",
    b"\x7fELF": "a program",
    b"\x89PNG": "a picture (PNG)",
    b"\xff\xd8\xff": "a picture (JPEG)",
    b"%PDF": "a PDF file",
}
"""First bytes of what no command reads."""
TAGS = {
    "robot": "is a robot in URDF; its name must end in .urdf",
    "mujoco": "is a robot in MJCF, as MuJoCo reads it; allowed are TOML and URDF (docs/formats.md). "
    "`flexarm export MODEL --mjcf FILE` writes the joints of a model into it",
    "sdf": "is a robot or world in SDF; allowed are TOML and URDF",
    "COLLADA": "is a mesh in COLLADA, which URDF may name",
}
"""What XML is, by its first tag."""
SHEETS = (".xlsx", ".xlsm", ".xlsb", ".ods")
"""Endings of spreadsheets, which are zip archives."""
ADVICE = "`flexarm import --guess` proposes a map for it, which `flexarm import` reads (docs/importing.md)"


def log_kind(path: Path) -> str | None:
    """Return what kind of binary log a file or directory is, or None."""
    with suppress(OSError, ValueError):  # a name that no file can have
        if path.is_dir():
            return "a ROS 2 bag" if (path / "metadata.yaml").is_file() else None
    start = _start(path)
    if start[:4] == b"PK\x03\x04" and path.suffix.lower() in SHEETS:
        return "an Excel file" if path.suffix.lower() != ".ods" else "a spreadsheet"
    if start[1:2] == b"\x50" and path.suffix.lower() == ".c3d":
        return "a C3D file"
    if re.match(rb"\*?[14]1[\d.]{4}[+-]\w{8}", start):
        return "a GSI file of Leica"
    return next((kind for magic, kind in LOGS.items() if start.startswith(magic)), None)


def foreign_kind(path: Path) -> str | None:
    """Return a sentence on what a file is, with the command that reads it, or None where it may be ours."""
    if kind := log_kind(path):
        return f"is {kind}; {ADVICE}"
    start = _start(path)
    kind = next((kind for magic, kind in OTHERS.items() if start.startswith(magic)), None)
    return f"is {kind}, which flexarm does not read" if kind else None


def table_of_text(text: str) -> str | None:
    """Return a sentence on a text that is a table of numbers, or None."""
    lines = [line for line in text[:20000].splitlines() if line.strip() and line[0] not in "#%"]
    rows = [_numbers(line) for line in lines[1:-1] or lines]
    if len(rows) < 2 or sum(count > 1 for count in rows) < 0.8 * len(rows):
        return None
    return f"is a table of numbers, such as CSV; {ADVICE}"


def markup(text: str) -> str | None:
    """Return a sentence on a text in XML, by its first tag, or None."""
    tag = re.match(r"(?:\s|<\?.*?\?>|<!--.*?-->|<![^>]*>)*<([\w:.-]+)", text, re.DOTALL)
    if tag is None:
        return None
    return TAGS.get(tag[1], f"is XML, <{tag[1]}>, which flexarm does not read")


def prose(text: str) -> str | None:
    """Return a sentence on a text without a key or a table of TOML, or None."""
    if any("=" in line or line.lstrip().startswith("[") for line in text.splitlines()):
        return None
    return "is a plain text, without a key or a table of TOML"


def _numbers(line: str) -> int:
    count = 0
    for cell in line.replace(",", " ").replace(";", " ").split():
        try:
            float(cell)
        except ValueError:
            continue
        count += 1
    return count if "=" not in line else 0


def _start(path: Path) -> bytes:
    with suppress(OSError, ValueError):
        if path.is_file():  # a pipe might never end
            with path.open("rb") as file:
                return file.read(32)
    return b""
