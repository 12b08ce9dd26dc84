"""The worked example of docs/importing.md, done as the page says."""

import re
from pathlib import Path

import pytest

import flexarm
from flexarm import Arm, compare
from flexarm.cli.run import run
from flexarm.importing.map_file import Dialect, MapTable, SignalMap

PAGE = (Path(__file__).parents[2] / "docs" / "importing.md").read_text(encoding="utf-8")


def test_the_worked_example_is_true(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(["example", "tryout"]) == 0
    (script,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.S)
    exec(compile(script, "docs/importing.md", "exec"), {})
    guess = ["import", "--guess", "run7", "tracker.txt", "--model", "tryout/arm.toml", "--out", "guess.toml"]
    assert run(guess) == 0
    assert "# without names: their speed goes with the model's point" in Path("guess.toml").read_text()
    (text,) = [t for t in re.findall(r"```toml\n(.*?)```", PAGE, flags=re.S) if "run 7" in t]
    Path("run7.map.toml").write_text(text)
    record = flexarm.import_record("run7.map.toml")
    assert (len(record.signals["hinge"]), len(record.signals["tip"])) == (4501, 181)
    found = compare(Arm.from_toml("tryout/arm.toml"), record)
    assert found.to_json_dict()["signals"]["tip"]["rms"]["tangential"] == pytest.approx(7.1e-4, rel=0.02)
    assert "2026-05-28 20:26:40 UTC" in PAGE and "2026-05-28 20:26:40 UTC" in str(record.notes[0])


def test_every_key_of_a_map_is_documented():
    prose = re.sub(r"```.*?```", "", PAGE, flags=re.S)
    words = {word for code in re.findall(r"`([^`]+)`", prose) for word in re.findall(r"\w+", code)}
    keys = {key for table in (MapTable, SignalMap, Dialect) for key in table.model_fields}
    assert sorted(keys - words - {"signals"}) == []
