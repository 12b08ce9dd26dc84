"""An effect: a named physical mechanism with parameters, at a place, that a model has or has not.

The same object simulates, is written into the TOML and is printed. A new effect is one file in
`flexarm/effects/`, named after the effect, with one subclass of `Effect` (CONTRIBUTING.md, "Add an effect").

A search for missing effects screens one by finite steps, its probes: models with the effect at a plausible
size, one for each direction in which its parameters move the prediction f,

    f(model with probe_i) - f(model without) = d_i                                                    (1)

Least squares of the gap on the d_i give multiples of the probes, which `Effect.sized` turns into parameters
from which a fit of the nonlinear law starts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module, util
from math import exp, inf, log
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, Self, TypeGuard

from pydantic import Field, ValidationError

from flexarm.arm.effect_traits import EffectTraits
from flexarm.arm.joint_units import priors_in
from flexarm.arm.prior import QUANTILE, Prior, Priors, Values
from flexarm.arm.vocabulary import KNOWN_EFFECTS
from flexarm.errors import InvalidParameter
from flexarm.tables import component_names, unit_of
from flexarm.tables.field import Nested
from flexarm.tables.table import Label

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine

Derivative = Literal["smooth", "one-sided", "none"]


class Search(NamedTuple):
    """What a search for an effect starts from."""

    arm: Arm
    stated: Effect | None = None
    """The effect as the model has it."""
    frequencies: Sequence[float] = ()
    """Of the gap [Hz]."""
    softer: Sequence[float] = ()
    """By how much softer springs than typical ones are tried."""


class Trial(NamedTuple):
    """Values of parameters with which a search tries an effect."""

    start: Mapping[str, float] = {}
    """From which a fit starts."""
    fixed: Mapping[str, float] = {}
    """That stay as they are."""


class Probes(NamedTuple):
    """The probes of an effect, and what they are compared with."""

    effects: Sequence[Effect]
    """The effect at plausible sizes."""
    null: Values
    """Values at which it vanishes."""
    stated: Effect | None
    """The effect as the model has it."""
    least: float
    """Part of a probe, where a fit can start, that what cannot be negative has at least."""


class Effect(EffectTraits):
    """Base of all effects. A subclass sets `name` and traits, and has its parameters as fields."""

    name: ClassVar[str]
    """Of the class: its name in the vocabulary."""
    place: ClassVar[str]
    """Of the class: the kind of place that the vocabulary states."""
    at: Label = Field(description='name of a joint, link, payload, point, signal, frame or clock, or "base"')
    """Name of the joint, link, payload, point, signal, frame or clock, or "base"."""

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        if "name" in vars(cls):
            cls.place = KNOWN_EFFECTS[cls.name]
        super().__pydantic_init_subclass__(**kwargs)

    def parameters(self) -> list[tuple[str, float, str]]:
        """Parameters as (name, value, unit), vectors spelt out as `offset.x`, tables as `value.0`.

        Infinite ones, such as a stiffness that was left out, do not appear, nor do names, such as channels.
        """
        found: list[tuple[str, float, str]] = []
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if _is_vector(value):
                found += [
                    (f"{name}.{component}", item, self.unit(name))
                    for component, item in zip(component_names(field, len(value)), value, strict=True)
                ]
            elif isinstance(value, float) and value != inf:
                found.append((name, value, self.unit(name)))
        return found

    def value_of(self, key: str) -> float:
        """Return a parameter, named as `parameters` spells it."""
        name, _, component = key.partition(".")
        found = getattr(self, name)
        return float(found[self._components(name).index(component)] if component else found)

    def with_parameters(self, values: Mapping[str, float]) -> Self:
        """Return the effect with other values, named as `parameters` spells them, such as `offset.x`.

        Raise InvalidParameter if there is no such parameter, or its value is not allowed.
        """
        changes: dict[str, Any] = {}
        for key, value in values.items():
            name, _, component = key.partition(".")
            old = changes.get(name, getattr(self, name, None))
            whole = isinstance(old, float) and name in type(self).model_fields
            if _is_vector(old) and component in self._components(name):
                k = self._components(name).index(component)
                changes[name] = (*old[:k], value, *old[k + 1 :])
            elif whole and not component:
                changes[name] = value
            else:
                there = ", ".join(found for found, _, _ in self.parameters())
                raise InvalidParameter(f"{self.name} has no parameter {key!r}; it has {there}")
        return self.replace(**changes)

    def unit(self, name: str) -> str:
        """Return the unit of a field about a revolute joint."""
        return unit_of(type(self).model_fields[name])

    def _components(self, name: str) -> tuple[str, ...]:
        return component_names(type(self).model_fields[name], len(getattr(self, name)))

    # ------------------------------------------------------------------ mechanics

    def patch(self, machine: Machine) -> None:
        """Change the machine's data as the effect does; effects of sensors leave it as it is."""

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Return pairs of key and sentence for what keeps it from acting in an arm that has its place."""
        there = (e for e in arm.effects_at(self.at) if e.name == self.requires)
        if self.requires is None or not all(effect.inert for effect in there):
            return []
        why = (
            f"{self.name} needs a {self.requires} with a stiffness at the same {self.place}, and {self.at!r} "
            f'is rigid; add [[effects]] name = "{self.requires}", at = "{self.at}", stiffness = ...'
        )
        return [("at", why)]

    # ------------------------------------------------------------ what is known before

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Plausible values of every parameter, named as `parameters` spells them."""
        return {}

    def stated_priors(self, arm: Arm) -> dict[str, Prior]:
        """Return priors about this effect as a model states it, in place of those of other machines."""
        return {}

    def derivative(self, parameter: str) -> Derivative:
        """Return which derivative predictions have with respect to a parameter.

        "one-sided" where left and right derivative differ at this value, "none" where there is neither.
        """
        return "smooth"

    # -------------------------------------------------------- what a search must know

    @property
    def inert(self) -> bool:
        """Return True if it leaves any model as it is, such as a spring that is rigid."""
        return False

    @property
    def travel(self) -> tuple[float, float]:
        """Return the range [rad, m] within which its place can be driven."""
        return -inf, inf

    @classmethod
    def acts_through_spring(cls) -> bool:
        """Return True if it moves nothing in a joint that is rigid, where a drive turns that."""
        return cls.torque_at == "output" or (cls.place == "joint" and cls.requires is not None)

    @classmethod
    def forms_families(cls) -> bool:
        """Return True if one cause may give it to all joints or sensors at once: what these are made like.

        Waves have phases of their own, and fits that need many starts, or another effect, need them apart.
        """
        return cls.place in ("joint", "signal") and not (cls.is_wave or cls.multistart or cls.requires)

    @classmethod
    def typical(cls, at: str, arm: Arm) -> Self:
        """Return the effect with the typical values of its priors."""
        required: dict[str, Any] = {
            key: 1.0 for key, field in cls.model_fields.items() if field.is_required() and key != "at"
        }
        effect = cls.model_construct(at=at, **required)
        values: dict[str, Any] = {}
        for _ in range(2):  # some typical values follow from others
            values = {}
            for key, prior in priors_in(effect, arm).items():
                name, _, axis = key.partition(".")
                values[name] = [*values.get(name, ()), prior.typical] if axis else prior.typical
            effect = cls.model_construct(at=at, **values)
        return cls.model_validate({"at": at, **values})

    @classmethod
    def variants(cls, at: str, arm: Arm, stated: Effect | None) -> Sequence[Self]:
        """Return the forms in which a search tries it with typical values; that of a stated one, if any."""
        return [cls.typical(at, arm)]

    def null(self, arm: Arm) -> dict[str, float]:
        """Return the value of each parameter at which a model without the effect stays as it is."""
        return {name: 1.0 if name == "scale" else 0.0 for name, _, _ in self.parameters()}

    def trials(self, search: Search) -> Iterable[Trial]:
        """Return values that are tried one after the other, as a fit would not find them from one start."""
        return [Trial()]

    def probes(
        self, stated: Effect | None, free: Sequence[str], null: Values, priors: Priors
    ) -> Iterable[Self]:
        """Return the effect at plausible sizes, one for each direction of the prediction, eq. (1)."""
        sized = [key for key in free if key not in self.shape]
        rest = {key: null[key] for key in sized}
        return [self.with_parameters({**rest, key: _plausible(priors[key], null[key])}) for key in sized]

    def sized(self, multiples: Sequence[float], probed: Probes) -> dict[str, float]:
        """Return parameters of a sum of multiples of its probes."""
        values: dict[str, float] = {}
        for name, zero in probed.null.items():
            moves = [probe.value_of(name) - zero for probe in probed.effects]
            if name in self.shape or not any(moves):
                continue
            values[name] = zero + sum(a * m for a, m in zip(multiples, moves, strict=True))
            if name in self.non_negative:
                values[name] = max(values[name], probed.least * max(abs(m) for m in moves))
            elif zero > 0:
                values[name] = max(values[name], 0.3 * zero)
        return values

    def shapes(self) -> Iterable[Mapping[str, float]]:
        """Return values of `shape` from which a search frees these parameters, where it leaves a gap."""
        return []

    def acting_as(
        self, other: Effect, other_stated: Effect | None, stated: Effect | None
    ) -> dict[str, float] | None:
        """Return parameters with which it plays the part of another effect; None where it cannot."""
        return None

    def model_key(self, parameter: str) -> str:
        """Return the key of the model's parameter that moves the prediction alike, for a sensitivity."""
        return f"effects.{self.name}.{self.at}.{parameter}"

    # ------------------------------------------------------------------------- as text

    def to_plain(self) -> dict[str, Any]:
        """Return the effect's table in the TOML file."""
        return {"name": self.name, **super().to_plain()}

    def __str__(self) -> str:
        return self.told(self.parameters())

    def told(self, parameters: Iterable[tuple[str, float, str]]) -> str:
        """Name, place and such parameters, in a line."""
        values = [f"{name} = {value:g} {unit}" for name, value, unit in parameters]
        return f"{self.name} at {self.at}" + (f": {', '.join(values)}" if values else "")


def _is_vector(value: Any) -> TypeGuard[tuple[float, ...]]:
    return isinstance(value, tuple) and len(value) > 0 and all(isinstance(item, float) for item in value)


def _plausible(prior: Prior, null: float) -> float:
    """Return a plausible value other than the null one: typical, or one sigma above."""
    if prior.typical != null:
        return prior.typical
    if prior.scale == "log":
        return exp(log(null) + (log(prior.high) - log(prior.typical)) / QUANTILE)
    return null + (prior.high - prior.typical) / QUANTILE


def effect_class(name: str) -> type[Effect]:
    """Return the class of an effect, found by its name.

    Raise InvalidParameter if there is no such effect, or it is known and cannot be simulated yet.
    """
    module = f"flexarm.effects.{name}"
    if name.isidentifier() and util.find_spec(module) is not None:
        for found in vars(import_module(module)).values():
            if isinstance(found, type) and issubclass(found, Effect) and getattr(found, "name", None) == name:
                return found
    if name in KNOWN_EFFECTS:
        simulated = ", ".join(each for each in KNOWN_EFFECTS if util.find_spec(f"flexarm.effects.{each}"))
        what = f"the effect {name!r} is known but cannot be simulated yet; simulated are {simulated}"
        raise InvalidParameter(what)
    from difflib import get_close_matches  # only on the way to an error

    close = get_close_matches(name, KNOWN_EFFECTS, n=1)
    hint = f" (did you mean {close[0]!r}?)" if close else ""
    raise InvalidParameter(f"unknown effect {name!r}{hint}; known are {', '.join(KNOWN_EFFECTS)}")


def read_effect(table: Any) -> Effect:
    """Return an effect from its table in the TOML file; an effect object is returned as it is."""
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
