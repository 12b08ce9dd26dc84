"""The base of all tables: frozen, no unknown keys, numbers that are numbers and have a unit."""

from __future__ import annotations

import re
from collections.abc import Hashable
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, Literal, NoReturn, Self, TypeVar, get_origin

from annotated_types import Ge, Gt
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Strict,
    ValidationError,
    ValidationInfo,
    field_validator,
)

from flexarm.errors import InvalidParameter
from flexarm.tables.check import parameter_error
from flexarm.tables.field import documented, signature_of, unit_of
from flexarm.tables.ranges import NEVER_ZERO_ALONE, out_of_range

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)

Key = TypeVar("Key", bound=Hashable)
Value = TypeVar("Value")


class FrozenDict(dict[Key, Value]):
    """A dictionary that cannot be changed, so that a frozen table really is, and can be hashed."""

    def _refuse(self, *args: Any, **kwargs: Any) -> NoReturn:
        raise TypeError("this dictionary belongs to a frozen object; make a changed copy with replace()")

    __setitem__ = __delitem__ = clear = pop = popitem = setdefault = update = _refuse
    __ior__ = _refuse

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(frozenset(self.items()))

    def __reduce__(self) -> tuple[type[Self], tuple[dict[Key, Value]]]:
        return type(self), (dict(self),)


def to_python(value: Any) -> Any:
    """Return NumPy scalars and arrays as Python numbers and lists, anything else unchanged."""
    return value.tolist() if hasattr(value, "tolist") else value


def one_or_more(value: Any) -> Any:
    """Return a text that stands without brackets as one of a tuple, anything else unchanged."""
    return (value,) if isinstance(value, str) else value


def _list_of(count: int) -> BeforeValidator:
    def check(value: Any) -> Any:
        value = to_python(value)
        if not isinstance(value, list | tuple) or len(value) != count:
            raise ValueError(f"must be a list of {count} numbers, got {value!r}")
        return tuple(value)

    return BeforeValidator(check)


_FORBIDDEN_IN_NAME = re.compile(r"[\s.:=,\"'\[\]{}#/\\\x00-\x1f\x7f]")


def check_label(label: str) -> str:
    """Return `label` if it can name something: all its characters can be seen, and they are not too many.

    Control characters cannot, nor marks that turn the direction of writing.
    """
    hidden = next((letter for letter in label if not letter.isprintable()), None)
    if not label or hidden or label != label.strip():
        why = "is empty" if not label else f"contains {hidden!r}" if hidden else "has blanks at its ends"
        raise ValueError(f"name {label[:40]!r} {why}; allowed are characters that can be seen")
    if len(label) > 100:  # names of URDF files, which join words, stay below 70
        raise ValueError(f"name {label[:40]!r}... has {len(label)} characters; allowed are 100")
    return label


def check_name(name: str) -> str:
    """`name` if it is one: no spaces and none of the characters that have a meaning in files and options."""
    found = _FORBIDDEN_IN_NAME.search(name)
    if found or not name:
        why = f"contains {found.group()!r}" if found else "is empty"
        raise ValueError(f"name {name[:40]!r} {why}; allowed are letters, digits, '_' and '-'")
    return check_label(name)


Number = Annotated[float, Strict(), BeforeValidator(to_python)]
Whole = Annotated[int, Strict(), BeforeValidator(to_python)]
Name = Annotated[str, AfterValidator(check_name)]
Label = Annotated[str, AfterValidator(check_label)]
Numbers = Annotated[tuple[Number, ...], BeforeValidator(to_python)]
Vector2 = Annotated[tuple[Number, Number], _list_of(2)]
Vector3 = Annotated[tuple[Number, Number, Number], _list_of(3)]
Texts = Annotated[tuple[str, ...], BeforeValidator(one_or_more)]


@cache
def _measure(table: type[Table], name: str) -> tuple[str, bool]:
    """Return the unit of a field, and True if its value cannot be negative, hence is no coordinate."""
    field = table.model_fields[name]
    unit = unit_of(field)
    return unit, unit in NEVER_ZERO_ALONE or Gt(0) in field.metadata or Ge(0) in field.metadata


class _Listed(ModelMetaclass):
    """Classes of tables, of which `dir` and so `help` and completion list what a table has of its own."""

    def __dir__(cls) -> list[str]:
        return [name for name in super().__dir__() if not _is_pydantics(cls, name)]


def _is_pydantics(kind: type, name: str) -> bool:
    """Return True for a name that pydantic gives a class."""
    given = "__pydantic", "__private_attributes__", "__class_vars__", "__signature__", "model_config"
    owner = next((each for each in kind.__mro__ if name in vars(each)), None)
    return owner is BaseModel or name.startswith(given)


class Table(BaseModel, metaclass=_Listed):
    """A frozen table. Made wrongly in Python, it raises `InvalidParameter`.

    Every number must lie in the range of its unit, `flexarm.tables.ranges`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        super().__pydantic_init_subclass__(**kwargs)
        if cls.__doc__:  # Python -OO has none
            cls.__doc__ = documented(cls)
        cls.__signature__ = signature_of(cls)

    @field_validator("*", mode="after")
    @classmethod
    def _in_range(cls, value: Any, info: ValidationInfo) -> Any:
        if isinstance(value, float | tuple | dict):
            unit, size = _measure(cls, str(info.field_name))
            if wrong := out_of_range(value, unit, size=size):
                raise ValueError(wrong)
        return value

    def __dir__(self) -> list[str]:
        return [name for name in super().__dir__() if not _is_pydantics(type(self), name)]

    def __init__(self, *unnamed: Any, **values: Any) -> None:
        """Check the values, each given by its name."""
        if unnamed:
            fields = ", ".join(f"{name}=" for name in type(self).model_fields)
            raise InvalidParameter(
                f"{type(self).__name__} takes values by name, {fields}; got {unnamed[0]!r} without one"
            )
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise parameter_error(type(self), error, values) from None

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuse to change a field."""
        if name in type(self).model_fields:
            kind = type(self).__name__
            raise InvalidParameter(f"{kind} is frozen; replace({name}=...) makes a changed copy", where=name)
        super().__setattr__(name, value)

    # Tells pydantic that nested tables need not pass through this __init__, so that a file's error keeps its
    # place.
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]

    def to_plain(self) -> dict[str, Any]:
        """Plain dictionary for TOML: what differs from the defaults, and the keys that tell the kind."""
        out: dict[str, Any] = {}
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            tells_kind = get_origin(field.annotation) is Literal and field.default == value
            if value is not None and (tells_kind or field.is_required() or value != field.get_default()):
                out[name] = _to_plain(value)
        return out

    def replace(self, **changes: Any) -> Self:
        """Return a changed copy, checked like a new one.

        Raise InvalidParameter if the changed table is not allowed.
        """
        unknown = sorted(set(changes) - set(type(self).model_fields))
        if unknown:
            allowed = ", ".join(type(self).model_fields)
            raise InvalidParameter(f"{type(self).__name__} has no {unknown[0]!r}; it has {allowed}")
        fields = {name: getattr(self, name) for name in self.model_fields_set}  # defaults stay defaults
        return type(self)(**{**fields, **changes})


def _to_plain(value: Any) -> Any:
    if isinstance(value, Table):
        return value.to_plain()
    if isinstance(value, dict):
        return {key: _to_plain(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [_to_plain(item) for item in value]
    return value
