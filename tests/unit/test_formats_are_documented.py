"""A key that is not documented is an error, so every key is documented."""

import re
from pathlib import Path

import pytest

from flexarm.arm import (
    Arm,
    Beam,
    Cascade,
    Gear,
    General,
    Joint,
    Material,
    Motor,
    Origin,
    Payload,
    Point,
    Rectangle,
    RigidLink,
    Round,
    Sensor,
    StateFeedback,
    Tube,
)
from flexarm.campaigns.study import Keep, Sampling, Study, Vary
from flexarm.quantities import QUANTITIES
from flexarm.record import CarriedPayload, Clock, Frame, Record
from flexarm.record.file_table import RecordTable, SignalTable
from flexarm.report.calibration import CalibrationFile
from flexarm.report.report_file import ReportFile
from flexarm.tables import Table

TEXT = (Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")
PROSE = re.sub(r"```.*?```", "", TEXT, flags=re.S)
WORDS = {word for code in re.findall(r"`([^`]+)`", PROSE) for word in re.findall(r"\w+", code)}
MODEL = [Arm, Joint, Gear, Beam, RigidLink, Material, Origin, Payload, Point, Sensor, Motor, Cascade]
TABLES = [
    *MODEL,
    StateFeedback,
    Round,
    Tube,
    Rectangle,
    General,
    CarriedPayload,
    Clock,
    Frame,
    RecordTable,
    SignalTable,
    Study,
    Sampling,
    Vary,
    Keep,
]


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.__name__)
def test_every_key_of_the_formats_is_documented(table: type[Table]) -> None:
    assert [name for name in table.model_fields if name not in WORDS] == []


def test_every_quantity_is_documented() -> None:
    assert [name for name in QUANTITIES if name not in WORDS] == []


@pytest.mark.parametrize(("file", "least"), [(ReportFile, 40), (CalibrationFile, 35)])
def test_every_key_of_a_report_is_documented(file, least: int) -> None:
    schema = file.model_json_schema()
    keys = {name for each in (schema, *schema["$defs"].values()) for name in each["properties"]}
    assert len(keys) > least
    assert sorted(keys - WORDS) == []


def test_the_record_that_is_shown_is_one(tmp_path):
    """The block of the page, with the two CSV files that stand side by side below it."""
    blocks = [block.removeprefix("toml").lstrip() for block in TEXT.split("```")[1::2]]
    (shown,) = [block for block in blocks if "flexarm-record/1" in block]
    (tables,) = [block for block in blocks if block.startswith("t_ms")]
    (tmp_path / "record.toml").write_text(shown)
    for name, column in (("encoder.csv", 0), ("tracker.csv", 1)):
        cells = [line.split()[column] for line in tables.strip().splitlines()]
        (tmp_path / name).write_text("\n".join(cells) + "\n")
    record = Record.load(tmp_path)
    assert record.drive == ("hinge",)
    assert record.signals["tip"].values[0] == pytest.approx([-5.2041, 1.2037, 2.498])
    assert not record.signals["tip"].valid[1]  # a cell is empty
    assert record.signals["hinge"].time == pytest.approx([0.0, 0.004])
