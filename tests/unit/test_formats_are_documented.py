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
from flexarm.diagnosis import report_file
from flexarm.quantities import QUANTITIES
from flexarm.record import CarriedPayload, Clock, Frame
from flexarm.record.table import RecordTable, SignalTable
from flexarm.tables import Table

TEXT = (Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")
WORDS = {word for code in re.findall(r"`([^`]+)`", TEXT) for word in re.findall(r"\w+", code)}
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
]


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.__name__)
def test_every_key_of_the_formats_is_documented(table: type[Table]) -> None:
    assert [name for name in table.model_fields if name not in WORDS] == []


def test_every_quantity_is_documented() -> None:
    assert [name for name in QUANTITIES if name not in WORDS] == []


def test_every_key_of_a_report_is_documented() -> None:
    entries = [each for each in vars(report_file).values() if hasattr(each, "model_fields")]
    keys = {name for each in entries for name in each.model_fields}
    assert len(keys) > 40
    assert sorted(keys - WORDS) == []
