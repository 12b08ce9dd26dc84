"""The files of a model and its records: what a report is traced to, and what no output may replace."""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Mapping
from os.path import relpath
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record


def input_files(model: Path, arm: Arm, records: Mapping[str, Record]) -> dict[str, Path]:
    """Return the files of the model, and the files of every record as `NAME/record.toml`.

    Records that were not read from a directory have no files.
    """
    files = {file.name: file for file in model_files(model, arm)}
    for name, record in records.items():
        if record.path is not None:
            files |= {f"{name}/{relpath(file, record.path)}": file for file in record.files}
    return {name: file for name, file in files.items() if file.is_file()}


def model_files(model: Path, arm: Arm) -> list[Path]:
    """Return the model file, the URDF that it names, and its super-elements."""
    named = tomllib.loads(model.read_text(encoding="utf-8")).get("urdf") if model.suffix == ".toml" else None
    return [model, *([model.parent / named] if named else []), *arm.part_files]


def hashes(files: Mapping[str, Path]) -> dict[str, str]:
    """SHA-256 of each file."""
    return {name: sha256(file) for name, file in files.items()}


def sha256(file: Path) -> str:
    """Return the hash of a file's bytes."""
    with file.open("rb") as opened:
        return hashlib.file_digest(opened, "sha256").hexdigest()
