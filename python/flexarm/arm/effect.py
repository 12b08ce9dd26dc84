"""An effect: a named physical mechanism with parameters, at a place, that a model has or has not.

The same object simulates, is written into the TOML and is printed. A new effect is one file in
`flexarm/effects/`, named after the effect, with one subclass of `Effect`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib import import_module, util
from math import inf
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self, TypeGuard

from pydantic import Field, ValidationError

from flexarm.arm.prior import Prior
from flexarm.arm.vocabulary import KNOWN_EFFECTS
from flexarm.errors import InvalidParameter
from flexarm.tables import Table, unit_of
from flexarm.tables.field import Nested
from flexarm.tables.table import Label

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine

Derivative = Literal["smooth", "one-sided", "none"]


class Effect(Table):
    """Base of all effects. A subclass sets `name`, and has its parameters as fields.

    Attributes
    ----------
    at : str
        Name of the joint, link, payload, point, signal, frame or clock, or "base".
    name : str
        Of the class: its name in the vocabulary.
    place : str
        Of the class: the kind of place that the vocabulary states.
    """

    name: ClassVar[str]
    place: ClassVar[str]
    at: Label = Field(description='name of a joint, link, payload, point, signal, frame or clock, or "base"')

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        if "name" in vars(cls):
            cls.place = KNOWN_EFFECTS[cls.name]

    def parameters(self) -> list[tuple[str, float, str]]:
        """Parameters as (name, value, unit), vectors spelt out as `offset.x`, `offset.y`, `offset.z`.

        Infinite ones, such as a stiffness that was left out, do not appear, nor do names, such as channels.
        """
        found: list[tuple[str, float, str]] = []
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if _is_vector(value):
                found += [
                    (f"{name}.{axis}", item, unit_of(field)) for axis, item in zip("xyz", value, strict=False)
                ]
            elif isinstance(value, float) and value != inf:
                found.append((name, value, unit_of(field)))
        return found

    def with_parameters(self, values: Mapping[str, float]) -> Self:
        """The effect with other values, named as `parameters` spells them, such as `offset.x`.

        Raises
        ------
        InvalidParameter
            If there is no such parameter, or its value is not allowed.
        """
        changes: dict[str, Any] = {}
        for key, value in values.items():
            name, _, axis = key.partition(".")
            old = changes.get(name, getattr(self, name, None))
            whole = isinstance(old, float) and name in type(self).model_fields
            if axis in ("x", "y", "z") and _is_vector(old) and "xyz".index(axis) < len(old):
                k = "xyz".index(axis)
                changes[name] = (*old[:k], value, *old[k + 1 :])
            elif whole and not axis:
                changes[name] = value
            else:
                there = ", ".join(found for found, _, _ in self.parameters())
                raise InvalidParameter(f"{self.name} has no parameter {key!r}; it has {there}")
        return self.replace(**changes)

    # ------------------------------------------------------------------ mechanics

    def patch(self, machine: Machine) -> None:
        """Changes the machine's data as the effect does; effects of sensors leave it as it is."""

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Pairs of key and sentence for what keeps the effect from acting in an arm that has its place."""
        return ()

    # ------------------------------------------------------------ what is known before

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Plausible values of every parameter, named as `parameters` spells them."""
        return {}

    def derivative(self, parameter: str) -> Derivative:
        """Whether what the model predicts has a derivative by a parameter.

        Returns
        -------
        {"smooth", "one-sided", "none"}
            "one-sided" where left and right derivative differ at this value, "none" where there is neither.
        """
        return "smooth"

    def to_plain(self) -> dict[str, Any]:
        """The effect's table in the TOML file."""
        return {"name": self.name, **super().to_plain()}

    def __str__(self) -> str:
        return self.told(self.parameters())

    def told(self, parameters: Iterable[tuple[str, float, str]]) -> str:
        """Name, place and such parameters, in a line."""
        values = [f"{name} = {value:g} {unit}" for name, value, unit in parameters]
        return f"{self.name} at {self.at}" + (f": {', '.join(values)}" if values else "")


def _is_vector(value: Any) -> TypeGuard[tuple[float, ...]]:
    return isinstance(value, tuple) and len(value) > 0 and all(isinstance(item, float) for item in value)


def effect_class(name: str) -> type[Effect]:
    """The class of an effect, found by its name.

    Raises
    ------
    InvalidParameter
        If there is no such effect, or it is known and cannot be simulated yet.
    """
    module = f"flexarm.effects.{name}"
    if name.isidentifier() and util.find_spec(module) is not None:
        for found in vars(import_module(module)).values():
            if isinstance(found, type) and issubclass(found, Effect) and getattr(found, "name", None) == name:
                return found
    if name in KNOWN_EFFECTS:
        raise InvalidParameter(f"the effect {name!r} is known but cannot be simulated yet; {_simulated()}")
    from difflib import get_close_matches  # only on the way to an error

    close = get_close_matches(name, KNOWN_EFFECTS, n=1)
    hint = f", did you mean {close[0]!r}?" if close else ""
    raise InvalidParameter(f"unknown effect {name!r}{hint}; known are {', '.join(KNOWN_EFFECTS)}")


def _simulated() -> str:
    names = [name for name in KNOWN_EFFECTS if util.find_spec(f"flexarm.effects.{name}")]
    return f"simulated are {', '.join(names)}"


def read_effect(table: Any) -> Effect:
    """An effect from its table in the TOML file; an effect object is returned as it is."""
    if isinstance(table, Effect):
        return table
    if not isinstance(table, dict):
        raise ValueError(f"must be a table, got {table!r}")
    name = table.get("name")
    if not isinstance(name, str):
        raise ValueError("name is missing; needed is the name of an effect, such as 'joint_compliance'")
    kind = effect_class(name)
    values = {key: value for key, value in table.items() if key != "name"}
    try:
        return kind.model_validate(values)
    except ValidationError as error:
        raise Nested(kind, error, values) from None
