"""Fields of a table with their units, where one stands, and errors of values that contradict one another."""

from __future__ import annotations

import inspect
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel, Field, ValidationError
from pydantic.fields import FieldInfo

Path = tuple[str | int, ...]


class Inconsistent(ValueError):
    """Values that are fine alone and impossible together: a list of (place, what is wrong)."""

    def __init__(self, *problems: tuple[Path, str]) -> None:
        self.problems = problems
        super().__init__("; ".join(what for _, what in problems))


class Nested(ValueError):
    """The error of a table that a registry checks, with its class and what was checked."""

    def __init__(self, table: type[BaseModel], error: ValidationError, data: Any) -> None:
        super().__init__(str(error))
        self.table, self.error, self.data = table, error, data


COMPONENTS = ("x", "y", "z", "xy", "xz", "yz")
"""Names of the components of a vector; three more are those of an inertia."""


def value_in(
    unit: str, description: str, default: Any = ..., *, numbered: bool = False, **limits: Any
) -> Any:
    """Return a field with a unit: `value_in("kg", "mass of the payload", ge=0)`.

    The components of a `numbered` one are counted from 0; those of others are named x, y, z.
    """
    extra: dict[str, Any] = {"unit": unit} | ({"numbered": True} if numbered else {})
    return Field(default, description=description, json_schema_extra=extra, **limits)


def component_names(field: FieldInfo, size: int) -> tuple[str, ...]:
    """Return the names of the components of a field that holds `size` numbers."""
    extra = field.json_schema_extra
    numbered = isinstance(extra, dict) and extra.get("numbered")
    return tuple(map(str, range(size))) if numbered else COMPONENTS[:size]


def documented(table: type[BaseModel]) -> str:
    """Return the docstring of a table with its fields as parameters, unless it states them itself."""
    doc = inspect.cleandoc(table.__doc__ or "")
    if "Parameters\n---" in doc or not table.model_fields:
        return doc
    lines = [doc, "", "Parameters", "----------"]
    for name, field in table.model_fields.items():
        said = "" if field.is_required() else f", default {field.default!r}"
        lines.append(f"{name} : {_type_words(field.annotation)}{said}")
        if says := field.description:
            unit = f" [{unit_of(field)}]" if unit_of(field) else ""
            lines.append(f"    {says[:1].upper()}{says[1:]}{unit}.")
    return "\n".join(lines)


def signature_of(table: type[BaseModel]) -> inspect.Signature:
    """Return how a table is made, as `help` and editors show it: fields by name, with types in words."""
    required: list[inspect.Parameter] = []
    others: list[inspect.Parameter] = []
    for name, field in table.model_fields.items():
        one = inspect.Parameter(
            name,
            inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if field.is_required() else field.get_default(),
            annotation=_Words(_type_words(field.annotation)),
        )
        (required if field.is_required() else others).append(one)
    return inspect.Signature([*required, *others])


class _Words(str):
    """A text that a signature shows without quotes."""

    def __repr__(self) -> str:
        return str(self)


def _type_words(annotation: Any) -> str:
    """Return a type as docstrings say it: `float`, `(3,)`, `{"start", "end"}`."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _type_words(inner[0])
    if origin is Literal:
        return f"{{{', '.join(map(repr, inner))}}}"
    if origin is tuple:
        return f"tuple of {_type_words(inner[0])}" if inner[-1] is ... else f"({len(inner)},)"
    if inner and origin is not dict:
        return " or ".join(_type_words(each) for each in inner if each is not type(None))
    return str(getattr(annotation, "__name__", annotation))


def unit_of(field: FieldInfo) -> str:
    """Return unit that `value_in` gave a field, empty if none."""
    extra = field.json_schema_extra
    return str(extra.get("unit", "")) if isinstance(extra, dict) else ""
