"""Zeros of sensors that are uncertain.

The zero of an encoder was set by somebody, that of an inclinometer depends on its mounting. The offset of
each one that is evidence is fitted as a nominal value of 0,

    offset ~ N(0, sigma^2),    sigma = `zero_std` of the signal, else `SelectionPolicy.zero` of an angle  (1)

unless the model or the record states it; it is an effect only beyond that. Drives are left out unless their
signals state `zero_std`, since the angles of the model are counted from them. Other quantities have a zero
only where `zero_std` is stated.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf
from typing import TYPE_CHECKING

from flexarm.arm import Arm
from flexarm.arm.joint_units import unit_at
from flexarm.arm.parameter import with_value
from flexarm.arm.uncertainty import with_unit
from flexarm.comparison.poses import is_input
from flexarm.effects.encoder_offset import EncoderOffset
from flexarm.effects.sensor_offset import SensorOffset
from flexarm.record import Record
from flexarm.record.compatibility import with_encoders

if TYPE_CHECKING:
    from flexarm.diagnosis.policy import SelectionPolicy
    from flexarm.named_effects import Refined
    from flexarm.record import Signal

ANGLES = ("joint_angle", "inclination")
"""Quantities that are counted from a zero which somebody set."""


def with_zeros(arm: Arm, records: Mapping[str, Record], policy: SelectionPolicy) -> Arm:
    """Return the model with offsets of 0 that are uncertain by (1), of those sensors that have none yet.

    It knows which encoders measure joints that slide.
    """
    arm = with_encoders(arm, records.values())
    sigmas: dict[str, float] = {}
    units: dict[str, str] = {}
    for record in records.values():
        for signal in record.signals.values():
            if (sigma := _sigma(record, signal, policy)) > 0:
                sigmas[signal.name] = min(sigma, sigmas.get(signal.name, inf))
                units[signal.name] = signal.unit
    drives = {name for record in records.values() for name in record.drive}
    for name, sigma in sigmas.items():
        kind = EncoderOffset if name in drives else SensorOffset
        if any(arm.effect(each.name, name) is not None for each in (EncoderOffset, SensorOffset)):
            continue
        effect = kind(at=name)
        unit = unit_at(effect, arm, "offset", units[name])
        key = with_unit(f"effects.{kind.name}.{name}.offset", unit)
        arm = arm.with_effect(effect).replace(uncertainty={**arm.uncertainty, key: sigma})
    return arm


def set_zeros(arm: Arm, refined: Iterable[Refined], stated: Arm) -> tuple[Arm, tuple[Refined, ...]]:
    """Return the model with the refined zeros that `with_zeros` gave to a `stated` one alone, and these.

    A zero is no physics: it is taken along also where no model explains the rest.
    """
    own = {(effect.name, effect.at) for effect in stated.effects}
    kept = [each for each in refined if is_zero(each.parameter) and _place(each.parameter) not in own]
    for each in kept:
        arm = with_value(arm, each.parameter, each.value)
    return arm, tuple(kept)


def _place(key: str) -> tuple[str, str]:
    """Return name and place of the effect of a parameter."""
    _, name, at, *_ = key.split(".")
    return name, at


def is_zero(key: str) -> bool:
    """Return True if a parameter is the zero of an encoder or sensor."""
    return key.startswith(tuple(f"effects.{kind.name}." for kind in (EncoderOffset, SensorOffset)))


def without_idle_zeros(arm: Arm, stated: Arm) -> Arm:
    """Return a model without the offsets of 0 that `with_zeros` gave to a `stated` one, and that stayed.

    Encoders are left that effects act at.
    """
    own = {(effect.name, effect.at) for effect in stated.effects}
    idle = {
        (effect.name, effect.at)
        for effect in arm.effects
        if isinstance(effect, EncoderOffset | SensorOffset)
        and (effect.name, effect.at) not in own
        and not effect.offset
    }
    kept = {
        key: sigma for key, sigma in arm.uncertainty.items() if not (is_zero(key) and _place(key) in idle)
    }
    effects = tuple(effect for effect in arm.effects if (effect.name, effect.at) not in idle)
    named = {effect.at for effect in effects} | set(stated.encoders)
    encoders = {name: joint for name, joint in arm.encoders.items() if name in named}
    return arm.replace(effects=effects, uncertainty=kept, encoders=encoders)


def of_model(refined: Iterable[Refined], arm: Arm) -> tuple[Refined, ...]:
    """Return refined values but the zeros of sensors that a model is left without."""
    return tuple(
        r for r in refined if not is_zero(r.parameter) or arm.effect(*_place(r.parameter)) is not None
    )


def _sigma(record: Record, signal: Signal, policy: SelectionPolicy) -> float:
    """Return 1 sigma of the zero of a signal (1); 0 where it has none."""
    if signal.zero_std is not None:
        return signal.zero_std
    given = signal.name in record.drive or (record.kind == "static" and is_input(record, signal))
    return policy.zero if signal.quantity in ANGLES and not given else 0.0
