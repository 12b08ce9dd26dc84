"""Hashes of the files that a diagnosis was made from, so that a report can be traced to them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record


def hashes(model: Path, arm: Arm, records: Mapping[str, Record]) -> dict[str, str]:
    """SHA-256 of the model file, its super-elements, and the files of every record.

    Parameters
    ----------
    model : Path
        The model's file.
    arm : Arm
        What was read from it.
    records : dict of str to Record
        By name; those that were not read from a directory have no files.

    Returns
    -------
    dict of str to str
        By file, those of records as `NAME/record.toml`.
    """
    files = {model.name: model}
    files |= {Path(link.file).name: Path(link.file) for link in arm.links if link.type == "superelement"}
    for name, record in records.items():
        if record.path is not None:
            parts = dict.fromkeys(["record.toml", *(s.file for s in record.signals.values() if s.file)])
            files |= {f"{name}/{part}": record.path / part for part in parts}
    return {name: sha256(file) for name, file in files.items() if file.is_file()}


def sha256(file: Path) -> str:
    """The hash of a file's bytes."""
    with file.open("rb") as opened:
        return hashlib.file_digest(opened, "sha256").hexdigest()
