"""Records that commands are given: their names, what looks wrong in them, the file that an error is of."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from flexarm.cli.options import blame, load_arm, warn
from flexarm.cli.progress import progress
from flexarm.errors import InvalidFile, InvalidParameter, NotConverged

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.calibration.result import Calibration
    from flexarm.diagnosis.result import Diagnosis
    from flexarm.record import Record

Found = TypeVar("Found", "Calibration", "Diagnosis")


def record_names(paths: list[Path]) -> dict[str, Path]:
    """Name of records: of their directories, with parents as far as two would be the same.

    Raise InvalidFile if a record is given twice; what is held out must not be fitted to.
    """
    places = [(path.parent if path.name == "record.toml" else path).resolve() for path in paths]
    for i, place in enumerate(places):
        if place in places[:i]:
            what = "is given twice; a record counts once, or is held out and not fitted to"
            raise InvalidFile(paths[i], "RECORD", what)
    parts = 1
    while len({place.parts[-parts:] for place in places}) < len(places):
        parts += 1
    return {"/".join(place.parts[-parts:]): path for place, path in zip(places, paths, strict=True)}


def load_record(path: Path, arm: Arm) -> Record:
    """Return a record; what looks wrong in it goes to standard error."""
    from flexarm.record import Record

    record = Record.load(path).with_units_of(arm)
    warn(path, [*record.check(arm), *record.check_against(arm)])
    return record


def fitted(
    model: Path,
    records: list[Path],
    hold_out: Path | None,
    out: Path,
    force: bool,
    fit: Callable[..., Found],
    json: bool = False,
) -> Found:
    """Fit a model to records but the one held out, and write what is found, traced to its files."""
    arm = load_arm(model)
    names = record_names([*records, *([] if hold_out is None else [hold_out])])
    read = {name: load_record(path, arm) for name, path in names.items()}
    held_out = None if hold_out is None else list(read.values())[-1]
    training = dict(list(read.items())[: len(records)])
    from flexarm.input_files import hashes, input_files
    from flexarm.output import output_directory

    inputs = input_files(model, arm, read)
    whole = output_directory(out, force, inputs.values(), ["updated.toml"])
    with whole as directory, progress(json) as tell:
        with blame_one_of(model, names, read, arm):
            found = fit(arm, training, hold_out=held_out, progress=tell)
        tell(1.0, "writing")
        found = replace(found, provenance={**found.provenance, "inputs_sha256": hashes(inputs)})
        found.write(directory, model)
    return found


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
