"""Uncertainty of nominal values: which value a key means, and 1 sigma in SI.

A key is a dotted path with names, `links.rod.material.youngs_modulus`; its number is relative. With a unit at
the end, `points.tip.position_m`, the number is absolute. Either holds for each component of a vector; places
have absolute ones only, and so has what is nominally zero.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from flexarm.arm.effect import Effect
from flexarm.arm.joint_units import ALONG, joint_of_signal, unit_at
from flexarm.tables.field import Inconsistent, Path, unit_of
from flexarm.tables.messages import shown
from flexarm.tables.ranges import out_of_range
from flexarm.tables.table import Table

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm

_SUFFIXES = {
    "m": "m",
    "rad": "rad",
    "kg": "kg",
    "kgm2": "kg m2",
    "Pa": "Pa",
    "kg_m3": "kg/m3",
    "m2": "m2",
    "m4": "m4",
    "m3": "m3",
    "m3_rad": "m3/rad",
    "Nm_rad": "N m/rad",
    "Nms_rad": "N m s/rad",
    "Nm": "N m",
    "N": "N",
    "N_m": "N/m",
    "N_m3": "N/m3",
    "Ns_m": "N s/m",
    "Nm_rad3": "N m/rad3",
    "V": "V",
    "m_s": "m/s",
    "m_s2": "m/s2",
    "rad_s": "rad/s",
    "Hz": "Hz",
    "s": "s",
    "s_s": "s/s",
    "1": "-",
}
"""Units at the end of keys; a `1` is that of numbers without a unit."""
_SCALED = ("m2", "m4", "kg m2")
"""Units of vectors whose components are known relative to themselves; places and directions are not."""
_TABLES = ("links", "joints", "gears", "payloads", "points", "closures", "motors", "effects")


def sigma_of(arm: Arm, key: str) -> tuple[Any, Any]:
    """Return the nominal value that a key of `[uncertainty]` means, and its 1 sigma in the value's own unit.

    A relative sigma of a vector is one number for each component, an absolute one a single number for all.

    Raise ValueError if the key means nothing in this model.
    """
    place = owner_of(arm, key)
    nominal = getattr(place.owner, place.field)
    given = arm.uncertainty[key]
    if place.unit:
        return nominal, given
    if isinstance(nominal, tuple):
        return nominal, tuple(abs(component) * given for component in nominal)
    return nominal, abs(nominal) * given


def with_unit(key: str, unit: str) -> str:
    """Return the key of an absolute uncertainty of a value in this unit.

    >>> with_unit("effects.encoder_offset.se1.offset", "rad")
    'effects.encoder_offset.se1.offset_rad'
    """
    return (
        f"{key}_{next(suffix for suffix, known in _SUFFIXES.items() if known in (unit, '-' * (unit == '1')))}"
    )


def uncertainty_problems(arm: Arm) -> Iterable[tuple[Path, str]]:
    """Yield keys that mean nothing, and sigmas that are negative."""
    for key, sigma in arm.uncertainty.items():
        if sigma < 0:
            yield ("uncertainty", key), f"1 sigma must not be negative, got {sigma:g}"
        elif wrong := out_of_range(sigma, "", size=True):
            yield ("uncertainty", key), f"1 sigma {wrong}"
        try:
            place = owner_of(arm, key)
        except ValueError as error:
            yield ("uncertainty", key), str(error)
            continue
        owner, field, unit = place.owner, place.field, place.unit
        allowed = _units(arm, owner, field)
        value = getattr(owner, field)
        if not unit and sigma > 0 and allowed and _is_zero(value, owner):
            keys = [f"{field}_{s}" for s, u in _SUFFIXES.items() if u in allowed]
            more = ", ..." if len(keys) > 2 else ""
            yield (
                ("uncertainty", key),
                f"{field} is 0, and 1 sigma relative to it is nothing; add the unit for an absolute one: "
                f"write {' or '.join(keys[:2])}{more}",
            )
            continue
        measure = unit_of(type(owner).model_fields[field])
        if not unit and not (isinstance(getattr(owner, field), float) or measure in _SCALED):
            options = " or ".join(f"{field}_{s}" for s, u in _SUFFIXES.items() if u == measure)
            yield (
                ("uncertainty", key),
                (
                    f"{field} is not one number, so 1 sigma cannot be relative; "
                    + (f"write {options}" if options else "it cannot have an uncertainty")
                ),
            )


def _is_zero(value: Any, owner: Table) -> bool:
    """Return True for a number that is zero, and for a vector of an effect that is."""
    vector = isinstance(value, tuple) and isinstance(owner, Effect)
    return not any(value) if vector else isinstance(value, float) and value == 0


def _units(arm: Arm, owner: Table, field: str) -> tuple[str, ...]:
    """Return the units of a value: along a slide other ones, of a signal's value those of its quantity."""
    unit = unit_of(type(owner).model_fields[field])
    if not isinstance(owner, Effect):
        return (unit,) if unit in _SUFFIXES.values() else ()
    if unit == "SI":
        sensor = next((sensor for sensor in arm.sensors if sensor.name == owner.at), None)
        named = tuple(_SUFFIXES.values()) if sensor is None else sensor.spec.units
    elif owner.place == "signal" and joint_of_signal(arm, owner.at) is None:  # only a record knows
        named = (unit_at(owner, arm, field, unit), ALONG.get(unit, unit))
    else:
        named = (unit_at(owner, arm, field, unit),)
    plain = ("-" if unit == "1" else unit for unit in named)
    return tuple(unit for unit in plain if unit in _SUFFIXES.values())


def flat_keys(given: Any) -> Any:
    """Refuse tables within `[uncertainty]`, which TOML makes of dots without quotes.

    Raise Inconsistent for every number in such a table.
    """
    if not isinstance(given, Mapping):
        return given
    nested = {key: value for key, value in given.items() if isinstance(value, Mapping)}
    if nested:
        raise Inconsistent(*(_in_quotes(path, value) for path, value in _leaves(nested)))
    return given


def _leaves(table: Mapping[str, Any], above: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    for key, value in table.items():
        if isinstance(value, Mapping) and value:
            yield from _leaves(value, (*above, key))
        else:
            yield (*above, key), value


def _in_quotes(path: tuple[str, ...], value: Any) -> tuple[Path, str]:
    whole = path[-1].partition(".")[0] in _TABLES  # a key in quotes that stands below the wrong header
    key = path[-1] if whole else ".".join(path)
    what = (
        f"stands in a table of its own, got {shown(value)}; write the key in quotes, in one piece, under "
        f'[uncertainty]: "{key}" = {shown(value)}'
    )
    return path, what


@dataclass(frozen=True)
class Owner:
    """The table that holds the value of a key."""

    table: str
    index: int
    """Of the arm, and the entry in it."""
    prefix: tuple[str, ...]
    """Words of the key before the value's own name."""
    fields: tuple[str, ...]
    """Names of the fields from the entry down to the value."""
    owner: Table
    unit: str
    """Unit at the end of the key; empty: relative."""

    @property
    def field(self) -> str:
        """Name of the value in its owner."""
        return self.fields[-1]


def owner_of(arm: Arm, key: str) -> Owner:
    """Return the location of the value of a key.

    Raise ValueError if the key means nothing in this model.
    """
    words = key.split(".")
    if len(words) < 3 or words[0] not in _TABLES:
        raise ValueError(f"must read TABLE.NAME.VALUE with TABLE one of {', '.join(_TABLES)}, got {key!r}")
    index, rest = _entry(arm, words)
    owner: Table = getattr(arm, words[0])[index]
    for step in rest[:-1]:
        inner = getattr(owner, step, None) if step in type(owner).model_fields else None
        if not isinstance(inner, Table):
            raise ValueError(
                f"there is no {step!r} in {key!r}; there are {', '.join(type(owner).model_fields)}"
            )
        owner = inner
    field, unit = _field(arm, owner, rest[-1])
    return Owner(words[0], index, tuple(words[:-1]), (*rest[:-1], field), owner, unit)


def _entry(arm: Arm, words: list[str]) -> tuple[int, list[str]]:
    """Return the index of the entry in its table, and the words after its name."""
    table, name, *rest = words
    names = [_name(table, entry) for entry in getattr(arm, table)]
    if table == "effects" and rest:
        name, rest = f"{name}.{rest[0]}", rest[1:]
    if name not in names or not rest:
        raise ValueError(f"there is no {name!r} in {table}; there are {', '.join(names) or 'none'}")
    return names.index(name), rest


def _name(table: str, entry: Any) -> str:
    """Return the name of an entry in keys."""
    if table == "effects":
        return f"{entry.name}.{entry.at}"
    return str(entry.joint if table == "motors" else entry.name)


def _field(arm: Arm, owner: Table, word: str) -> tuple[str, str]:
    fields = type(owner).model_fields
    if word in fields and unit_of(fields[word]):
        if getattr(owner, word) is None:
            raise ValueError(f"{word} is not given in the model")
        return word, ""
    for suffix, unit in _SUFFIXES.items():
        stem = word.removesuffix(f"_{suffix}")
        if stem != word and stem in fields and unit in _units(arm, owner, stem):
            return stem, unit
    if isinstance(inner := getattr(owner, word, None) if word in fields else None, Table):
        within = " or ".join(f"'{word}.{name}'" for name in type(inner).model_fields)
        raise ValueError(f"{word!r} is a table; write {within}")
    uncertain = [name for name in fields if unit_of(fields[name])]
    raise ValueError(
        f"there is no value {word!r}; there are {', '.join(uncertain)}, each also with its unit at the end"
    )
