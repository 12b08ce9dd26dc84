"""Writing TOML text: lists of tables as `[[name]]`, tables at the top as `[name]`, deeper ones inline.

Nothing is kept of an older text, so that a writer of its own is shorter than a call of one that could.
Source: TOML v1.0.0.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def toml_text(data: Mapping[str, Any]) -> str:
    """The text of a document.

    >>> print(toml_text({"joints": {"hinge": 0.5}, "signals": [{"name": "tip"}], "format": "record"}))
    format = "record"
    <BLANKLINE>
    [joints]
    hinge = 0.5
    <BLANKLINE>
    [[signals]]
    name = "tip"
    <BLANKLINE>
    """
    top = {key: value for key, value in data.items() if not _has_header(value)}
    parts = [_lines(top)] if top else []
    for key, value in data.items():
        if isinstance(value, Mapping):
            parts.append(f"[{_key(key)}]\n{_lines(value)}")
        elif _has_header(value):
            parts += [f"[[{_key(key)}]]\n{_lines(item)}" for item in value]
    return "\n".join(parts)


def _has_header(value: Any) -> bool:
    """Whether a value at the top stands below a header of its own, hence after all that do not."""
    return isinstance(value, Mapping) or (
        isinstance(value, list) and bool(value) and all(isinstance(item, Mapping) for item in value)
    )


def _lines(table: Mapping[str, Any]) -> str:
    return "".join(f"{_key(key)} = {_value(value)}\n" for key, value in table.items())


def _key(key: str) -> str:
    return key if _BARE_KEY.fullmatch(key) else _text(key)


def _value(value: Any) -> str:
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return repr(value)
    if isinstance(value, float):  # also 1e-05, inf and nan: Python and TOML write them alike
        return repr(float(value))  # NumPy's floats, which are floats too, have a repr of their own
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    raise TypeError(f"TOML has no form for {value!r}")


def _text(text: str) -> str:
    """A basic string: TOML has the escapes of JSON, and one more character that must be escaped."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
