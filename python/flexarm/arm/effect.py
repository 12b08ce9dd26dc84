"""An effect: a named physical mechanism with parameters, at a place, that a model has or has not.

The same object simulates, is written into the TOML and is printed. A new effect is one file in
`flexarm/effects/`, named after the effect, with one subclass of `Effect`.
"""

from __future__ import annotations

from importlib import import_module, util
from math import inf
from typing import Any, ClassVar

from pydantic import ValidationError

from flexarm.errors import InvalidParameter
from flexarm.tables import Table, unit_of
from flexarm.tables.table import Nested

KNOWN_EFFECTS: dict[str, str] = {
    **dict.fromkeys(
        (
            "joint_compliance",
            "joint_stiffening",
            "joint_hysteresis",
            "backlash",
            "coulomb_friction",
            "viscous_friction",
            "motor_friction",
            "transmission_error",
            "gear_ratio",
            "cable_torque",
        ),
        "joint",
    ),
    **dict.fromkeys(("payload_mass", "payload_offset", "payload_inertia"), "payload"),
    **dict.fromkeys(("link_stiffness", "link_mass", "link_length", "link_damping", "link_bow"), "link"),
    **dict.fromkeys(("base_tilt", "base_compliance", "external_vibration"), "base"),
    **dict.fromkeys(
        (
            "encoder_offset",
            "encoder_scale",
            "encoder_eccentricity",
            "encoder_quantisation",
            "dead_channel",
            "sign_error",
            "unit_error",
            "saturation",
            "outliers",
            "sensor_offset",
        ),
        "signal",
    ),
    **dict.fromkeys(("time_delay", "clock_drift"), "signal or clock"),
    **dict.fromkeys(("frame_registration", "frame_drift"), "frame"),
    "reflector_offset": "point",
}
"""Every name of the shared vocabulary, and the kind of place it acts at."""


class Effect(Table):
    """Base of all effects. A subclass sets `name` and `place`, and has its parameters as fields.

    Attributes
    ----------
    at : str
        Name of the joint, link, payload, point, signal, frame or clock, or "base".
    """

    name: ClassVar[str]
    place: ClassVar[str]
    at: str

    def parameters(self) -> list[tuple[str, float, str]]:
        """Parameters as (name, value, unit), vectors spelt out as `offset.x`, `offset.y`, `offset.z`.

        Infinite ones, such as a stiffness that was left out, do not appear.
        """
        found: list[tuple[str, float, str]] = []
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if isinstance(value, tuple):
                found += [
                    (f"{name}.{axis}", item, unit_of(field)) for axis, item in zip("xyz", value, strict=False)
                ]
            elif name != "at" and value != inf:
                found.append((name, value, unit_of(field)))
        return found

    def coupling_laws(self, core: Any) -> list[Any]:
        """Laws between motor and link, on phi - theta; `core` is the compiled core that makes them."""
        return []

    def bearing_laws(self, core: Any) -> list[Any]:
        """Laws at the output bearing, on theta."""
        return []

    def motor_laws(self, core: Any) -> list[Any]:
        """Laws on the motor's angle phi, output-referred."""
        return []

    def to_plain(self) -> dict[str, Any]:
        """The effect's table in the TOML file."""
        return {"name": self.name, **super().to_plain()}

    def __str__(self) -> str:
        values = ", ".join(f"{name} = {value:g} {unit}" for name, value, unit in self.parameters())
        return f"{self.name} at {self.at}: {values}"


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
