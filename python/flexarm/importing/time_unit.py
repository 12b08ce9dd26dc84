"""Units of time as logs spell them."""

from __future__ import annotations

import re

_SECONDS = {
    "": 1.0,
    "milli": 1e-3,
    "micro": 1e-6,
    "nano": 1e-9,
    "m": 1e-3,
    "u": 1e-6,
    "µ": 1e-6,
    "μ": 1e-6,
    "n": 1e-9,
}
"""Prefix of a second, the micro sign and the Greek letter among them -> seconds."""
_LONGER = {"mins?|minutes?": 60.0, "h|hrs?|hours?": 3600.0, "d|days?": 86400.0}
"""Words of longer units -> seconds."""


def last_word(name: str) -> str:
    """Return the last word of a name, empty if it is a single letter, which may mean anything.

    >>> last_word("stamp_ns"), last_word("timeMs"), last_word("t_h")
    ('ns', 'Ms', '')
    """
    word = re.split(r"[\W_]|(?<=[a-z])(?=[A-Z])", name)[-1]
    return word if len(word) > 1 else ""


def seconds_of(unit: str) -> float | None:
    """Return the seconds of a unit of time as logs spell it; None if it is none.

    >>> seconds_of("[msec]"), seconds_of("hours since 1970-01-01"), seconds_of("deg")
    (0.001, 3600.0, None)
    """
    word = (unit.lower().strip("[]() ").split() or [""])[0].rstrip(".")
    if second := re.fullmatch(f"({'|'.join(_SECONDS)})(?:s|secs?|seconds?)", word):
        return _SECONDS[second[1]]
    return next((seconds for words, seconds in _LONGER.items() if re.fullmatch(words, word)), None)
