"""Answers of diagnoses are those that were frozen: a few quick cases; `freeze.py --check` compares all of
them."""

import json

import pytest
from freeze import HERE, ROOT, blind_case, differences, shared_case

SEED = 25
QUICK = ("none-hinged-0-25000", "fault-planar-dead_channel-base-0-25000", "none-hinged-0-25002")
SHARED = ROOT.parent / "shared" / "cases"


def frozen(file: str) -> dict:
    return json.loads((HERE / file).read_text())


@pytest.mark.parametrize("name", [name for name in frozen(f"seed_{SEED}.json") if name in QUICK])
def test_the_answer_to_a_blind_case_is_the_frozen_one(name):
    assert differences(frozen(f"seed_{SEED}.json")[name], blind_case(name, SEED), name) == []


@pytest.mark.skipif(not SHARED.exists(), reason="the shared cases are not here")
@pytest.mark.parametrize("name", ["case_01", "case_15"])
def test_the_answer_to_a_shared_case_is_the_frozen_one(name):
    assert differences(frozen("shared_cases.json")[name], shared_case(SHARED / name), name) == []


def test_a_changed_probability_is_a_difference():
    answer = frozen("shared_cases.json")["case_01"]
    changed = json.loads(json.dumps(answer))
    changed["effects"][0]["probability"] *= 0.99
    assert len(differences(answer, changed)) == 1
