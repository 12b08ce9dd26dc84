"""Records that commands are given: their names, what looks wrong in them, the file that an error is of."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from flexarm.cli.options import blame, warn
from flexarm.errors import InvalidFile, InvalidParameter, NotConverged

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record


def record_names(paths: list[Path]) -> dict[str, Path]:
    """Name of records: of their directories, with parents as far as two would be the same.

    Raises
    ------
    InvalidFile
        If a record is given twice; what is held out must not be fitted to.
    """
    places = [(path.parent if path.name == "record.toml" else path).resolve() for path in paths]
    for i, place in enumerate(places):
        if place in places[:i]:
            raise InvalidFile(
                paths[i], "RECORD", "is given twice; a record counts once, or is held out and not fitted to"
            )
    parts = 1
    while len({place.parts[-parts:] for place in places}) < len(places):
        parts += 1
    return {"/".join(place.parts[-parts:]): path for place, path in zip(places, paths, strict=True)}


def load_record(path: Path, arm: Arm) -> Record:
    """Return a record; what looks wrong in it goes to standard error."""
    from flexarm.record import Record

    record = Record.load(path)
    warn(path, [*record.check(arm), *record.check_against(arm)])
    return record


@contextmanager
def blame_one_of(model: Path, files: dict[str, Path], records: dict[str, Record], arm: Arm) -> Iterator[None]:
    """Name the file in an error about a model or a record: that of the first record that fails alone."""
    try:
        yield
    except InvalidFile:
        raise
    except InvalidParameter:
        from flexarm.comparison.aligned_record import simulate_record

        for name, record in records.items():
            with blame(model, files[name]), suppress(NotConverged):
                simulate_record(arm, record)
        with blame(model):
            raise
