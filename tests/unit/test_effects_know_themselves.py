"""The diagnosis knows effects by their traits alone: none is named in it."""

import ast
from pathlib import Path

import pytest

import flexarm.diagnosis
from flexarm.arm.vocabulary import KNOWN_EFFECTS

PLAIN_ENGLISH = {"outliers", "saturation"}
"""Names of effects that are words of sentences too."""
QUANTITIES = {"payload_mass"}
"""Names of effects that are quantities of records too."""
FILES = sorted(Path(flexarm.diagnosis.__file__).parent.rglob("*.py"))


def named_in(source: str) -> set[str]:
    """Return the effects that strings of the code name, docstrings left out."""
    tree = ast.parse(source)
    texts = {
        id(node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    words = {
        word.strip(".,:")
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in texts
        for word in node.value.replace(".", " ").split()
    }
    return words & set(KNOWN_EFFECTS) - PLAIN_ENGLISH


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_no_effect_is_named_in(file):
    assert named_in(file.read_text()) - QUANTITIES == set()


def test_a_name_within_a_longer_string_is_found():
    assert named_in('SPRINGS = frozenset("joint_compliance base_compliance".split())') == {
        "joint_compliance",
        "base_compliance",
    }
