"""The directory of a campaign while it runs: batches of rows, each a file that appears when it is whole.

`results.parts/` holds one file for each batch, so that a process that is killed loses nothing but the batches
under way. Once all rows are there they become `results.nc`, part by part.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from flexarm.arrays import Floats
from flexarm.campaigns.job import Row
from flexarm.errors import InvalidFile
from flexarm.output import writing
from flexarm.reading import reading

PARTS, RESULTS = "results.parts", "results.nc"


class Part(NamedTuple):
    """A batch as it is stored: arrays by variable, and what is no array of a fixed shape."""

    samples: Any
    seconds: Floats
    reasons: Sequence[str]
    arrays: dict[str, Floats]
    """By variable, one row for each sample; NaN where a run failed."""
    others: Sequence[dict[str, Any]]
    """By sample: texts, and numbers with units, of which each run has its own."""


class Store:
    """Rows of a campaign on disk.

    `room` is a directory on the same file system, in which files are written before they appear.
    """

    def __init__(self, directory: Path, room: Path) -> None:
        self.directory, self.room = directory, room
        self.parts = directory / PARTS

    @property
    def results(self) -> Path:
        """The file of results, which is there once all rows are."""
        return self.directory / RESULTS

    def put(self, rows: Sequence[Row]) -> None:
        """Keep rows; those of one batch appear together. Raise InvalidFile as `write`."""
        if not rows:
            return
        with writing(self.parts):
            self.parts.mkdir(exist_ok=True)
        content = BytesIO()
        np.savez(content, **_packed(rows))
        self.write(self.parts / f"{rows[0].sample:09d}-{len(rows)}.npz", content.getbuffer())

    def write(self, path: Path, content: bytes | memoryview) -> None:
        """Write a file, which appears when it is whole. Raise InvalidFile if it cannot be written."""
        written = self.room / path.name
        with writing(path):
            written.write_bytes(content)
            written.replace(path)

    def files(self) -> list[Path]:
        """Return the files of all batches, in the order of their first samples."""
        return sorted(self.parts.glob("*.npz"))

    def read(self) -> Iterator[Part]:
        """Yield all batches."""
        for file in self.files():
            yield _unpacked(file)

    def done(self) -> set[int]:
        """Return the samples that are there."""
        found: set[int] = set()
        for file in self.files():
            with reading(file, "a part of a campaign"), np.load(file, allow_pickle=False) as part:
                found.update(part["samples"].tolist())
        return found

    def clear(self) -> None:
        """Remove the batches."""
        shutil.rmtree(self.parts, ignore_errors=True)


def _packed(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the arrays of a file; those of variables begin with a colon."""
    shapes: dict[str, tuple[int, ...]] = {}
    for row in rows:
        for name, value in (row.outcome or {}).items():
            if not isinstance(value, str | tuple):
                shapes[name] = np.shape(value)
    packed: dict[str, Any] = {
        "samples": np.array([row.sample for row in rows]),
        "seconds": np.array([row.seconds for row in rows]),
        "reasons": np.array(json.dumps([None if row.outcome is not None else row.reason for row in rows])),
        "others": np.array(
            json.dumps(
                [{k: v for k, v in (row.outcome or {}).items() if isinstance(v, str | tuple)} for row in rows]
            )
        ),
    }
    for name, shape in shapes.items():
        nothing = np.full(shape, np.nan)
        packed[f":{name}"] = np.stack([np.asarray((row.outcome or {}).get(name, nothing)) for row in rows])
    return packed


def _unpacked(file: Path) -> Part:
    with reading(file, "a part of a campaign"), np.load(file, allow_pickle=False) as part:
        return Part(
            part["samples"],
            part["seconds"],
            ["" if reason is None else reason or "unknown" for reason in json.loads(str(part["reasons"]))],
            {name[1:]: part[name] for name in part.files if name.startswith(":")},
            json.loads(str(part["others"])),
        )


def refuse_gaps(file: Path, n: int, done: set[int]) -> None:
    """Refuse parts that are of another campaign.

    Raise InvalidFile if there are samples that the study has not.
    """
    if done and max(done) >= n:
        what = f"there is {max(done)}, and the study has {n}; remove the directory"
        raise InvalidFile(file, "sample", what)
