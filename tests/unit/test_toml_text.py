"""Claims about TOML text: tomllib, the standard's own reader, finds in it what was written."""

import tomllib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexarm.tables import toml_text

# Quotes, escapes, control characters, a character outside the basic plane, and what bare keys may hold.
text = st.text("\"'\\\n\t\r\x00\x1f\x7f #=.[]{}é漢𝛼aZ0_-", max_size=6)
number = st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False)
inline = st.recursive(
    st.booleans() | number | text,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(text, inner, max_size=3),
    max_leaves=6,
)
tables = st.lists(st.dictionaries(text, inline, max_size=3), min_size=1, max_size=3)


@settings(derandomize=True, deadline=None)
@given(st.dictionaries(text, inline | tables, max_size=5))
def test_a_document_reads_back_as_it_was_written(document):
    assert tomllib.loads(toml_text(document)) == document


def test_keys_at_the_top_stand_before_all_headers_wherever_they_came():
    data = {
        "links": [{"name": "rod", "section": {"width": 0.1}}],
        "gravity": [0.0, 0.0, -9.81],
        "name": "arm",
    }
    expected = """gravity = [0.0, 0.0, -9.81]
name = "arm"

[[links]]
name = "rod"
section = {width = 0.1}
"""
    assert toml_text(data) == expected


def test_numpy_numbers_are_written_like_others_and_what_is_no_number_is_infinite_or_nan():
    assert (
        toml_text(
            {"a": np.float64(0.1), "b": float("nan"), "c": -np.inf, "d": np.int64(3), "e": np.bool_(True)}
        )
        == "a = 0.1\nb = nan\nc = -inf\nd = 3\ne = true\n"
    )


def test_what_toml_cannot_say_is_refused():
    with pytest.raises(TypeError, match="NoneType"):
        toml_text({"a": None})
