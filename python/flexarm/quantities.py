"""Quantities: SI unit, place of measurement and number of channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

PlaceKind = Literal["joint", "point", "link", "payload"]


@dataclass(frozen=True)
class Quantity:
    """One row of the table of quantities."""

    units: tuple[str, ...]
    """SI units; the second one is for prismatic joints."""
    places: tuple[PlaceKind, ...]
    """Kinds of place, one of which a signal names."""
    channels: int | None = 1
    """Number of channels; None: one for each of `axes`."""
    has_side: bool = False
    """True if measured before (motor) or after (output) the reducer."""
    one_axis: bool = False
    """True if it needs exactly one entry in `axes`."""
    only_static: bool = False
    """True if it belongs to records of poses only."""


QUANTITIES: dict[str, Quantity] = {
    "joint_angle": Quantity(("rad", "m"), ("joint",), has_side=True),
    "joint_rate": Quantity(("rad/s", "m/s"), ("joint",), has_side=True),
    "joint_command": Quantity(("rad", "m"), ("joint",)),
    "motor_torque": Quantity(("N m", "N"), ("joint",), has_side=True),
    "motor_voltage": Quantity(("V",), ("joint",)),
    "position": Quantity(("m",), ("point",), channels=None),
    "orientation": Quantity(("1",), ("point",), channels=4),
    "inclination": Quantity(("rad",), ("point",), one_axis=True),
    "angular_rate": Quantity(("rad/s",), ("point",), channels=None),
    "acceleration": Quantity(("m/s2",), ("point",), channels=None),
    "strain": Quantity(("1",), ("link",)),
    "deflection": Quantity(("m",), ("point", "link"), channels=None),
    "force": Quantity(("N",), ("point",), channels=None),
    "payload_mass": Quantity(("kg",), ("payload",), only_static=True),
}

FRAMED = ("position", "orientation")
"""Quantities that a frame of measurement places."""

CURRENT, TORQUE = "motor_current", "motor_torque"
"""A motor's current is told as its torque, by a torque constant."""

QuantityName = Literal[
    "joint_angle",
    "joint_rate",
    "joint_command",
    "motor_torque",
    "motor_current",
    "motor_voltage",
    "position",
    "orientation",
    "inclination",
    "angular_rate",
    "acceleration",
    "strain",
    "deflection",
    "force",
    "payload_mass",
]


def channel_names(quantity: str, axes: Sequence[str] | None) -> tuple[str, ...]:
    """Return names of the channels of a signal: its axes, x, y, z, w of a quaternion, "" of a scalar."""
    if quantity == "orientation":
        return ("x", "y", "z", "w")
    return tuple(axes or ("x", "y", "z")) if QUANTITIES[quantity].channels is None else ("",)


DRIVES = ("joint_angle", "joint_command", "motor_torque", "motor_voltage")
"""Quantities that can drive a simulation."""
