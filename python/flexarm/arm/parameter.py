"""Parameters of a model: numbers that have a name, a unit and a value, and can be changed one by one.

A key is a dotted path with names, as in `[uncertainty]`: `links.rod.material.youngs_modulus`,
`payloads.load.mass`, `effects.backlash.hinge.gap`. A component of a vector ends in .x, .y or .z, as in
`points.tip.position.z`, one of a table in its number from 0, as in `effects.tabulated_law.hinge.value.3`; a
vector without one means all its components.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import isinf
from typing import TYPE_CHECKING, Any

from flexarm.arm.effect import Effect
from flexarm.arm.joint_units import priors_in, unit_at
from flexarm.arm.link import Beam, bends_alike
from flexarm.arm.uncertainty import owner_of
from flexarm.errors import InvalidParameter
from flexarm.tables import Table, component_names, unit_of
from flexarm.tables.field import COMPONENTS

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm

_STEP = 3e-5
"""Step of differences in parts of the parameter's size: its square and 1e-16 over it are both near 1e-9."""


@dataclass(frozen=True)
class Parameter:
    """One number of a model."""

    key: str
    """Its path, with the component of a vector."""
    value: float
    """Its value in the model [unit]."""
    unit: str
    one_sided: bool = False
    """Whether what the model predicts has different derivatives to its left and right."""
    drives: bool = False
    """Whether it is a part of a change of a run's drive, and no number of the arm."""

    def __str__(self) -> str:
        return f"{self.key} = {self.value:g} {self.unit}"


@dataclass(frozen=True)
class Path:
    """Where a key leads: the entry of a table of the arm, the fields inside, and the component."""

    table: str
    index: int
    fields: tuple[str, ...]
    component: int | None

    def owner(self, arm: Arm) -> Table:
        """Return the table that holds the value."""
        found: Any = getattr(arm, self.table)[self.index]
        for name in self.fields[:-1]:
            found = getattr(found, name)
        return found  # type: ignore[no-any-return]

    def get(self, arm: Arm) -> float:
        """Return the value."""
        whole = getattr(self.owner(arm), self.fields[-1])
        return float(whole if self.component is None else whole[self.component])

    def put(self, arm: Arm, value: float) -> Arm:
        """Return a copy of the arm with another value, of which only the tables that hold it are checked."""
        return put_all(arm, [(self, value)])


def put_all(arm: Arm, changes: Sequence[tuple[Path, float]]) -> Arm:
    """Return a copy of the arm with other values of one table, which is checked with all of them.

    A beam whose section comes to bend differently in its two planes states the axes that it had.
    """
    first, new = changes[0][0], dict[str, Any]()
    for path, value in changes:
        name, k = path.fields[-1], path.component
        old = new.get(name, getattr(path.owner(arm), name))
        new[name] = value if k is None else (*old[:k], value, *old[k + 1 :])

    def changed(table: Table, fields: Sequence[str]) -> Table:
        if not fields:
            return table.replace(**new)
        values: dict[str, Any] = {fields[0]: changed(getattr(table, fields[0]), fields[1:])}
        if isinstance(table, Beam) and "section" in values and not bends_alike(values["section"]):
            values["up"] = table.lean
        return table.replace(**values)

    entries, k = getattr(arm, first.table), first.index
    entry = changed(entries[k], first.fields[:-1])
    return arm.model_copy(update={first.table: (*entries[:k], entry, *entries[k + 1 :])})


def parameters(arm: Arm, keys: Iterable[str]) -> tuple[Parameter, ...]:
    """Return the parameters that keys mean, vectors spelt out.

    Raise InvalidParameter if a key means nothing in this arm, or the model's predictions have no derivative
    by it.
    """
    found: dict[str, Parameter] = {}
    for key in [keys] if isinstance(keys, str) else keys:
        for parameter in _parameters(arm, key):
            found.setdefault(parameter.key, parameter)
    return tuple(found.values())


def stated_sigma(arm: Arm, key: str) -> float | None:
    """Return 1 sigma of a parameter from `[uncertainty]`: of the value itself or of its vector, or None.

    `key` is such as "points.tip.position.x"; the model's own key may end in a unit.
    """
    for given in arm.uncertainty:
        if key in {parameter.key for parameter in parameters(arm, given)}:
            _, sigma = arm.sigma(given)
            component = path_of(arm, key).component or 0
            return float(sigma[component] if isinstance(sigma, tuple) else sigma) or None
    return None


def numbers_at(arm: Arm, key: str) -> tuple[tuple[Parameter, Path], ...]:
    """Return the numbers that a key means, vectors spelt out, each with its path.

    There need be no derivative by them, and what was left out may be infinite.

    Raise InvalidParameter if the key means nothing in this arm.
    """
    return tuple((Parameter(name, path.get(arm), _unit(arm, path)), path) for name, path in _paths(arm, key))


def path_of(arm: Arm, key: str) -> Path:
    """Return the path of the key of a `Parameter`."""
    return _paths(arm, key)[0][1]


def with_value(arm: Arm, key: str, value: float) -> Arm:
    """Return a copy of the arm in which one parameter has another value.

    Raise InvalidParameter if the key means nothing or several numbers, or the value is not allowed.
    """
    (name, path), *others = _paths(arm, key, "key")
    if others:
        names = ", ".join(each for each, _ in [(name, path), *others])
        raise InvalidParameter(f"must name one number, got {key!r}, which are {names}", where="key")
    return path.put(arm, float(value))


def neighbours(
    arm: Arm, parameter: Parameter, step: float | None = None, part: float = _STEP
) -> tuple[tuple[Arm, float], tuple[Arm, float]]:
    """Return the arm with the parameter changed up and down, each with the change.

    The change is `step`, or `part` of the size of the parameter. At a limit one arm is the given one, with a
    change of zero.
    """
    if parameter.drives:
        size = _STEP if step is None else step
        return (arm, size), (arm, -size)
    path = path_of(arm, parameter.key)
    arm = _with_fixed_axes(arm, path)
    size = part * _size(arm, parameter, path) if step is None else step

    def moved(change: float) -> tuple[Arm, float]:
        value = parameter.value + change
        try:
            return path.put(arm, value), value - parameter.value
        except InvalidParameter:
            return arm, 0.0

    return moved(size), moved(-size)


def _parameters(arm: Arm, key: str) -> list[Parameter]:
    found = []
    for name, path in _paths(arm, key):
        owner = path.owner(arm)
        rule = "smooth"
        if isinf(path.get(arm)):
            what = f"{key} was left out and is infinite: there is no derivative by it; give it a value"
            raise InvalidParameter(what, where="sensitivities")
        if isinstance(owner, Effect):
            rule = owner.derivative(name.split(".", 3)[3])
        if rule == "none":
            what = f"{key} has no derivative: the law jumps with it; change its value in finite steps instead"
            raise InvalidParameter(what, where="sensitivities")
        found.append(Parameter(name, path.get(arm), _unit(arm, path), rule == "one-sided"))
    return found


def _unit(arm: Arm, path: Path) -> str:
    """Return the unit of the number at a path."""
    owner, field = path.owner(arm), path.fields[-1]
    if isinstance(owner, Effect):
        return unit_at(owner, arm, field, owner.unit(field))
    return unit_of(type(owner).model_fields[field])


def _paths(arm: Arm, key: str, where: str = "sensitivities") -> list[tuple[str, Path]]:
    """Full keys and paths; several for a vector without a component."""
    stem, _, last = key.rpartition(".")
    component = last if (last in COMPONENTS or last.isdigit()) and stem.count(".") >= 2 else None
    try:
        place = owner_of(arm, key if component is None else stem)
    except ValueError as error:
        raise InvalidParameter(str(error), where=where) from None
    value = getattr(place.owner, place.field)
    size = len(value) if isinstance(value, tuple) else None
    stem = ".".join((*place.prefix, place.field))
    if size is None and component is not None:
        raise InvalidParameter(f"{key}: {stem} has no components", where=where)
    if size is None and not isinstance(value, float):
        what = f"{key} = {value!r} is not a real number that can change"
        raise InvalidParameter(what, where=where)
    if size is None:
        return [(stem, Path(place.table, place.index, place.fields, None))]
    names = component_names(type(place.owner).model_fields[place.field], size)
    if component is not None and component not in names:
        raise InvalidParameter(f"{key}: {stem} has {size} components", where=where)
    return [
        (f"{stem}.{name}", Path(place.table, place.index, place.fields, k))
        for k, name in enumerate(names)
        if component in (None, name)
    ]


def _with_fixed_axes(arm: Arm, path: Path) -> Arm:
    """Return the arm in which a beam whose end moves keeps the axes of its section.

    Without `up` the axes lean to the base direction that is furthest from the beam.
    """
    owner = path.owner(arm)
    if not isinstance(owner, Beam) or path.fields[-1] != "end" or owner.up is not None:
        return arm
    links = tuple(link.replace(up=owner.lean) if link is owner else link for link in arm.links)
    return arm.model_copy(update={"links": links})


def _size(arm: Arm, parameter: Parameter, path: Path) -> float:
    """Return the scale of a parameter: its value, its vector, a plausible value, or one unit."""
    owner = path.owner(arm)
    whole = getattr(owner, path.fields[-1])
    if path.component is not None and not (isinstance(owner, Effect) and owner.is_spring):
        length = sum(item * item for item in whole) ** 0.5
        if length > 0:
            return float(length)
    if parameter.value != 0:
        return abs(parameter.value)
    if isinstance(owner, Effect):
        prior = priors_in(owner, arm).get(parameter.key.split(".", 3)[3])
        if prior is not None and prior.typical != 0:
            return abs(prior.typical)
        if prior is not None:
            return max(abs(prior.low), abs(prior.high))
    return 1.0
