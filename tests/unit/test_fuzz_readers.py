"""Whatever a file holds, reading it gives an object or an `InvalidFile`: nothing else ever comes out."""

from pathlib import Path

import pytest
from fuzzing import Changes, edited, edits, fuzzed
from hypothesis import given
from hypothesis import strategies as st

from flexarm import Arm, Record
from flexarm.errors import InvalidFile

PIECES = [
    "",
    "0",
    "-1",
    "1e999",
    "nan",
    "inf",
    '"x"',
    "[]",
    "[[]]",
    "{}",
    "true",
    "[[joints]]\n",
    "[links]\n",
    "=",
    "\n",
    '"',
    "#",
    ",",
    ",,",
    "1979-05-27",
    "\x00",
    "é",
    "e",
    "999999999999999999999999",
    "base",
    "rod",
    "0x10",
    "1_000",
    '"unknown"',
    'type = "superelement"\n',
    'kind = "static"\n',
    "; ",
    "\t",
]
SPOILED = edits(PIECES)


@fuzzed(250)
@given(changes=SPOILED)
def test_a_spoiled_model_is_read_or_refused(model_text: str, tmp_path: Path, changes: Changes) -> None:
    file = tmp_path / "arm.toml"
    file.write_bytes(edited(model_text, changes))
    try:
        arm = Arm.from_toml(file)
    except InvalidFile as error:
        assert str(error).startswith(f"{file}: ")
        assert all(problem.where and problem.what for problem in error.problems)
    else:
        arm.summary()
        list(arm.warnings)


@fuzzed(250)
@given(changes=SPOILED, which=st.sampled_from(["record.toml", "encoder.csv", "tracker.csv"]))
def test_a_spoiled_record_is_read_or_refused(
    record_files: dict[str, str], tmp_path: Path, changes: Changes, which: str
) -> None:
    for name, text in record_files.items():
        (tmp_path / name).write_bytes(edited(text, changes) if name == which else text.encode())
    try:
        record = Record.load(tmp_path)
    except InvalidFile as error:
        assert str(tmp_path) in error.file
        assert all(problem.where and problem.what for problem in error.problems)
    else:
        record.check()
        repr(record)


@pytest.mark.parametrize("reader", [Arm.from_toml, Record.load])
@fuzzed(250)
@given(content=st.binary(max_size=200))
def test_random_bytes_are_refused(reader: object, tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "record.toml"
    file.write_bytes(content)
    with pytest.raises(InvalidFile):
        reader(file)  # type: ignore[operator]
