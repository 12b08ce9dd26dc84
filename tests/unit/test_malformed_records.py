"""Every mistake in a record ends as one line with the file, the place, the value and what is allowed."""

# ruff: noqa: E501 (a mistake a line, as a table)

from pathlib import Path

import pytest

from flexarm import Record
from flexarm.errors import InvalidFile

# file, what is replaced, by what, which file is blamed, where, what it says besides
TOML, ENC, TRK = "record.toml", "encoder.csv", "tracker.csv"
MISTAKES = {
    "unknown key": (TOML, 'unit = "mm"', 'units = "mm"', TOML, "signals.tip.units", "did you mean 'unit'?"),
    "unknown drive": (TOML, 'drive = "hinge"', 'drive = "hing"', TOML, "drive", "there are hinge, tip"),
    "drive that is none": (TOML, 'drive = "hinge"', 'drive = "tip"', TOML, "drive", "is a position"),
    "drive given twice": (TOML, 'drive = "hinge"', 'drive = ["hinge", "hinge"]', TOML, "drive", "both drive joint"),
    "driven joint at rest": (TOML, "wrist = 0.3", "hinge = 0.3", TOML, "joints.hinge", "is driven by signal"),
    "unknown clock": (TOML, 'clock = "tracker"', 'clock = "watch"', TOML, "signals.tip.clock", "controller, tracker"),
    "negative sigma": (TOML, "controller = 0.0", "controller = -1", TOML, "clocks.controller", "at least 0, got -1 s"),
    "clock of words": (TOML, "controller = 0.0", 'controller = "good"', TOML, "clocks.controller", '"unknown"'),
    "unknown reference": (TOML, "controller = 0.0", 'controller = "unknown"', TOML, "clocks.controller", "reference"),
    "unknown frame": (TOML, 'frame = "tracker"', 'frame = "lab"', TOML, "signals.tip.frame", "there are base, tracker"),
    "frame of a number": (TOML, "tracker = { tra", "other = 3\ntracker = { tra", TOML, "frames.other", "got 3"),
    "frame of an angle": (TOML, 'side = "motor"', 'frame = "tracker"', TOML, "signals.hinge.frame", "has no frame"),
    "negative payload": (TOML, "mass = 5.0", "mass = -5.0", TOML, "payloads.load.mass", "must be at least 0"),
    "missing file": (TOML, "tracker.csv", "trakcer.csv", TOML, "signals.tip.file", "there are encoder.csv, tracker.csv"),
    "endless file name": (TOML, '"tracker.csv"', f'"{"x" * 5000}.csv"', TOML, "signals.tip.file", "there is no file"),
    "missing column": (TOML, "tip_x_mm", "tip_y_mm", TOML, "signals.tip.channels",
                       "there are time_s, tip_x_mm, tip_z_mm in tracker.csv"),
    "missing time": (TOML, 'time = "time_s"', 'time = "t"', TOML, "signals.hinge.time", "there are time_s, encoder_deg"),
    "no time": (TOML, 'time = "time_s"\n', "", TOML, "signals.hinge.time", "is missing"),
    "channels and axes": (TOML, '["x", "z"]', '["x", "y", "z"]', TOML, "signals.tip.channels", "must be 3 for axes"),
    "channel twice": (TOML, '"tip_z_mm"]', '"tip_x_mm"]', TOML, "signals.tip.channels", "named twice"),
    "unit of another kind": (TOML, 'unit = "deg"', 'unit = "kg"', TOML, "signals.hinge.unit", "rad, mrad"),
    "time in metres": (TOML, 'unit = "deg"', 'unit = "deg"\ntime_unit = "m"', TOML, "signals.hinge.time_unit", "ms"),
    "signal twice": (TOML, 'name = "tip"', 'name = "hinge"', TOML, "signals.hinge.name", "used twice"),
    "unknown quantity": (TOML, '"position"', '"positon"', TOML, "signals.tip.quantity", "got 'positon'"),
    "unknown side": (TOML, 'side = "motor"', 'side = "left"', TOML, "signals.hinge.side", "'motor' or 'output'"),
    "wrong kind": (TOML, 'drive = "hinge"', 'kind = "poses"', TOML, "kind", "'motion', 'static' or 'frequency_response', got 'poses'"),
    "time in a static record": (TOML, 'drive = "hinge"', 'kind = "static"', TOML, "signals.hinge.time", "use pose"),
    "no signals": (TOML, "[[signals]]", "[[signal]]", TOML, "signal", "did you mean 'signals'?"),
    "wrong format": (TOML, "flexarm-record/1", "flexarm-arm/1", TOML, "format", "allowed is 'flexarm-record/1'"),
    "not TOML": (TOML, "drive = ", "drive : ", TOML, "line 3, column 7", "not valid TOML"),
    "text for number": (ENC, "20.0", "abc", ENC, "line 4, column encoder_deg", "must be a number, got 'abc'"),
    "decimal comma": (ENC, "20.0", '"20,0"', ENC, "line 4, column encoder_deg", "got '20,0'"),
    "infinite value": (ENC, "20.0", "inf", ENC, "line 4, column encoder_deg", "got an infinite number"),
    "repeated time": (ENC, "0.2,", "0.1,", ENC, "line 5, column time_s", "0.1 repeats 0.1 of line 4"),
    "backward time": (ENC, "0.2,", "0.05,", ENC, "line 5, column time_s", "0.05 goes back behind 0.1 of line 4"),
    "row without time": (ENC, "0.1,", ",", ENC, "line 4, column time_s", "a row needs a time"),
    "long row": (ENC, "20.0", "20.0,7", ENC, "line 4", "has 3 cells, the header has 2"),
    "cut row": (TRK, "0.25,nan,nan", "0.25,n", TRK, "line 4", "has 2 cells, the header has 3"),
    "column twice": (TRK, "tip_z_mm", "tip_x_mm", TRK, "header", "column 'tip_x_mm' stands there twice"),
    "no rows": (ENC, "0.0,10.0\n0.1,20.0\n0.2,30.0\n", "", ENC, "line 3", "has a header and no rows"),
    "semicolons": (ENC, "time_s,encoder_deg", "time_s;encoder_deg", ENC, "header", "cells are separated by ';'"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_in_a_record_is_named_with_file_and_place(
    mistake: str, record_dir: Path, record_files: dict[str, str]
) -> None:
    spoiled, old, new, blamed, where, what = MISTAKES[mistake]
    assert old in record_files[spoiled]
    (record_dir / spoiled).write_text(record_files[spoiled].replace(old, new, 1))

    with pytest.raises(InvalidFile) as caught:
        Record.load(record_dir)

    lines = caught.value.lines()
    assert [line for line in lines if f": {where}" in line and what in line], lines
    assert all(line.startswith(f"{record_dir / blamed}: ") for line in lines)


@pytest.mark.parametrize(("file", "content", "what"), [
    (ENC, b"", "has no header"),
    (ENC, b"# only a comment\n", "has no header"),
    (ENC, b"\x00\x01\x02\xff\xfe", "not a text in UTF-8"),
    (ENC, b"time_s,encoder_deg\n\x00,\x01\n", "line 2, column time_s: must be a number"),
    (TOML, b"\xff\xfe", "not a text in UTF-8"),
])  # fmt: skip
def test_garbage_in_a_record_is_told(file: str, content: bytes, what: str, record_dir: Path) -> None:
    (record_dir / file).write_bytes(content)
    with pytest.raises(InvalidFile, match=what) as caught:
        Record.load(record_dir)
    assert caught.value.file == str(record_dir / file)


def test_a_directory_without_record_toml_is_no_record(tmp_path: Path) -> None:
    with pytest.raises(InvalidFile, match=r"record\.toml: file: there is no such file"):
        Record.load(tmp_path)


def test_a_path_that_does_not_exist_is_no_record(tmp_path: Path) -> None:
    with pytest.raises(InvalidFile, match="there is no such directory; a record is a directory"):
        Record.load(tmp_path / "nowhere")


def test_a_directory_in_place_of_a_csv_file_is_told(record_dir: Path) -> None:
    (record_dir / ENC).unlink()
    (record_dir / ENC).mkdir()
    with pytest.raises(InvalidFile, match="is a directory, a file is needed"):
        Record.load(record_dir)
