"""One sentence for each kind of error that pydantic finds: what is wrong, the value, what is allowed."""

from __future__ import annotations

from typing import Any

from pydantic.fields import FieldInfo

from flexarm.tables.field import unit_of

_LIMITS = {
    "greater_than": ("gt", "greater than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}
_TYPES = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "a text in quotes",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "tuple_type": "a list",
    "list_type": "a list",
    "dict_type": "a table",
    "mapping_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "finite_number": "a finite number",
}


def sentence(error: dict[str, Any], field: FieldInfo | None, allowed: list[str]) -> str:
    """Return the message for one entry of `ValidationError.errors()`."""
    kind, value, context = error["type"], error.get("input"), error.get("ctx", {})
    unit = unit_of(field) if field else ""
    unit = "" if unit in ("unit", "SI") else unit  # that of the place, which the message does not know
    got = f"got {shown(value)}" + (f" {unit}" if unit not in ("", "-") and _is_number(value) else "")
    if kind == "missing":
        return "is missing; needed is " + _needed(field, unit)
    if kind == "extra_forbidden":
        return f"unknown key; allowed are {', '.join(allowed)}{_meant(str(error['loc'][-1]), allowed)}"
    if kind in _LIMITS:
        limit = context[_LIMITS[kind][0]]
        must = "positive" if kind == "greater_than" and limit == 0 else f"{_LIMITS[kind][1]} {limit:g}"
        return f"must be {must}, {got}"
    if kind == "float_type" and _is_number(value):
        return f"must be a number that a double can hold, {got}"
    if kind in ("list_type", "tuple_type") and isinstance(value, dict):
        return f"must be a list of tables, {got}; write each as [[{error['loc'][-1]}]]"
    if kind in _TYPES:
        return f"must be {_TYPES[kind]}" + (f" [{unit}]" if unit not in ("", "-") else "") + f", {got}"
    if kind == "literal_error":
        return f"must be {context['expected']}, {got}"
    if kind == "union_tag_invalid":
        return f"must be one of {context['expected_tags']}, got {context['tag']!r}"
    if kind == "union_tag_not_found":
        return "is missing; it tells which kind of table this is"
    if kind == "value_error":
        return str(context["error"])
    return f"{error['msg']}, {got}"


def shown(value: Any, limit: int = 60) -> str:
    """Return the text of a value: numbers short, texts quoted, at most `limit` characters."""
    if isinstance(value, float):
        return f"{value:.9g}"
    try:
        text = repr(value) if not isinstance(value, bool) else str(value).lower()
    except ValueError:  # Python prints no integer of more digits
        text = "a whole number of thousands of digits"
    except RecursionError:
        text = "tables nested hundreds deep"
    return text if len(text) <= limit else text[: limit - 3] + "..."


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _needed(field: FieldInfo | None, unit: str) -> str:
    if field is None or not field.description:
        return "a value"
    return field.description + (f" [{unit}]" if unit not in ("", "-") else "")


def _meant(key: str, allowed: list[str]) -> str:
    from difflib import get_close_matches  # only on the way to an error

    if key in ("sign", "inverted", "invert", "reversed") and "scale" in allowed:
        return "; scale = -1 turns the sign over"
    close = get_close_matches(key, allowed, n=1)
    return f"; did you mean {close[0]!r}?" if close else ""
