"""Text with pieces cut out and put in, for tests that a reader refuses what it cannot read."""

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

Changes = list[tuple[float, int, str]]
"""Where, as a share of the text's length, how many characters go, and what comes."""


def edits(pieces: list[str]) -> st.SearchStrategy[Changes]:
    """One to four changes that put in one of the pieces, or any short text."""
    piece = st.one_of(st.sampled_from(pieces), st.text(max_size=5))
    return st.lists(st.tuples(st.floats(0, 1), st.integers(0, 12), piece), min_size=1, max_size=4)


def edited(text: str, changes: Changes) -> bytes:
    """The text after the changes."""
    for place, length, piece in changes:
        at = int(place * len(text))
        text = text[:at] + piece + text[at + length :]
    return text.encode("utf-8", "surrogatepass")


def fuzzed(examples: int) -> settings:
    """So many examples, the same ones in every run; the files of one test are overwritten by each."""
    return settings(
        max_examples=examples,
        deadline=None,
        derandomize=True,
        suppress_health_check=[HealthCheck.function_scoped_fixture],
    )
