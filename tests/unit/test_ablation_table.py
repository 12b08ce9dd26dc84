"""The table of benchmarks/ablation.py counts changed answers and missing ones apart."""

import json
import sys
from pathlib import Path
from types import SimpleNamespace

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))

from ablation import ACTED, DEFAULT, PROPOSING, Recorded, answer_of, table, variants

from flexarm.diagnosis.policy import MOVES, SelectionPolicy

NOTHING = {"verdict": "adequate", "names": [], "right": False, "cpu": 4.0, "acted": ["pairs", "singles"]}
SPRING = {
    "verdict": "effects",
    "names": [["joint_compliance", "hinge"]],
    "right": True,
    "cpu": 9.0,
    "acted": ["pairs", "singles", "swap"],
}


def test_a_case_without_an_answer_is_not_counted_as_unchanged():
    [name, changes] = variants(["strong_evidence"])[1]
    text = table({"default": [NOTHING, SPRING, None], name: [None, NOTHING, None]}, {name: changes})
    assert text.splitlines()[-1].endswith("| 1 | 1 | 1 | 1 | 1 -> 0 | 9 -> 4 | 2 |")


def test_changes_are_counted_where_a_move_acted():
    name, changes = next(each for each in variants(["moves"]) if each[0] == "swap off")
    text = table({"default": [NOTHING, SPRING], name: [NOTHING, NOTHING]}, {name: changes})
    assert text.splitlines()[-1].endswith("| off | on | 2 | 1 | 1 | 1 | 1 -> 0 | 9 -> 4 | 0 |")


def test_an_answer_without_a_move_that_did_nothing_is_that_of_the_default(tmp_path):
    spec = SimpleNamespace(name="case")
    (tmp_path / "default").mkdir()
    (tmp_path / "default" / "case.json").write_text(json.dumps(NOTHING))
    changes = {"moves": [move for move in MOVES if move != "swap"]}
    assert answer_of("swap off", changes, spec, tmp_path, 1.0) == NOTHING


def test_moves_that_ask_the_policy_are_recorded():
    ACTED.clear()
    policy = Recorded(moves=("pairs", "swap"))
    assert policy.allows("swap") and not policy.allows("backward") and policy.allows("pairs")
    assert {"swap"} == ACTED
    assert set(MOVES) >= PROPOSING - {"singles"}


def test_each_field_is_halved_and_doubled_and_each_move_left_out():
    found = variants([])
    assert found[0] == DEFAULT
    numbers = len(SelectionPolicy.__dataclass_fields__) - 1
    assert len(found) == 1 + 2 * numbers + len(MOVES)
