"""The table of benchmarks/ablation.py counts changed answers and missing ones apart."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))

from ablation import DEFAULT, table, variants

from flexarm.diagnosis.policy import MOVES, SelectionPolicy

NOTHING = {"verdict": "adequate", "names": []}
SPRING = {"verdict": "effects", "names": [["joint_compliance", "hinge"]]}


def test_a_case_without_an_answer_is_not_counted_as_unchanged():
    [name, changes] = variants(["strong_evidence"])[1]
    text = table({"default": [NOTHING, SPRING, None], name: [None, NOTHING, None]}, {name: changes})
    assert text.splitlines()[-1].endswith("| 1 | 1 | 1 | 2 |")


def test_each_field_is_halved_and_doubled_and_each_move_left_out():
    found = variants([])
    assert found[0] == DEFAULT
    numbers = len(SelectionPolicy.__dataclass_fields__) - 1
    assert len(found) == 1 + 2 * numbers + len(MOVES)
