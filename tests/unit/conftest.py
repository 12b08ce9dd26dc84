"""A model and a record that are right, for tests to spoil."""

from pathlib import Path

import pytest
from right_files import ENCODER, MODEL, RECORD, TRACKER


@pytest.fixture(scope="session")
def model_text() -> str:
    """A model with every table but gears."""
    return MODEL


@pytest.fixture(scope="session")
def record_files() -> dict[str, str]:
    """The files of a record in degrees and millimetres, with drop-outs and a comment."""
    return {"record.toml": RECORD, "encoder.csv": ENCODER, "tracker.csv": TRACKER}


@pytest.fixture
def model_file(tmp_path: Path) -> Path:
    """The model as a file."""
    path = tmp_path / "arm.toml"
    path.write_text(MODEL)
    return path


@pytest.fixture
def record_dir(tmp_path: Path, record_files: dict[str, str]) -> Path:
    """The record as a directory."""
    directory = tmp_path / "run"
    directory.mkdir()
    for name, text in record_files.items():
        (directory / name).write_text(text)
    return directory
