"""Inputs and outputs of a linear model by name."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

from flexarm.arm import Arm
from flexarm.arm.sensor import Sensor
from flexarm.assembly import following_joints
from flexarm.errors import InvalidParameter

KINDS = ("angle", "acceleration", "torque", "free", "locked", "force")
"""Kinds of inputs; "force" belongs to a point, the others to a joint."""
Asked = Mapping[str, str] | Iterable[tuple[str, str]]


@dataclass(frozen=True)
class Port:
    """One input."""

    kind: str
    """One of "drive" (angle or acceleration, as is proper), "angle", "acceleration", "torque" and "force"."""
    place: str
    """Name of the joint or point."""
    axis: int = 0
    """Of a force: 0, 1, 2 for the base's x, y, z."""
    slides: bool = False
    """True if the joint is prismatic."""

    def named(self) -> str:
        """Name of the input in the model."""
        return (
            f"{self.place}.force.{'xyz'[self.axis]}" if self.kind == "force" else f"{self.place}.{self.kind}"
        )

    def unit(self) -> str:
        """Return its unit."""
        turns = {"angle": "rad", "acceleration": "rad/s2", "torque": "N m", "force": "N"}
        slides = {"angle": "m", "acceleration": "m/s2", "torque": "N", "force": "N"}
        return (slides if self.slides else turns)[self.kind]


def ports(arm: Arm, asked: Asked | None, held: Iterable[str] = ()) -> tuple[list[Port], set[str]]:
    """Return the inputs in their order, and the joints whose motors are held without being one.

    `asked` has the kind of input at joints and points; joints left out are locked. Default: the drive of
    every moving joint, without outputs of gears. Joints of loops that are neither asked nor `held` follow.

    Raise InvalidParameter if there is no such joint, point or kind, or one is asked twice.
    """
    moving = {joint.name: joint.type == "prismatic" for joint in arm.moving_joints}
    geared = {gear.output for gear in arm.gears}
    if asked is None:
        left_out = geared | set(following_joints(arm, (), held))
        return [Port("drive", name, slides=moving[name]) for name in moving if name not in left_out], set()
    pairs = list(asked.items()) if isinstance(asked, Mapping) else list(asked)
    found: list[Port] = []
    told: set[str] = set()
    for name, kind in pairs:
        points = [point.name for point in arm.points]
        allowed = KINDS[:-1] * (name in moving) + KINDS[-1:] * (name in points) or KINDS
        if kind not in allowed:
            raise InvalidParameter(
                f"must be one of {', '.join(allowed)}, got {kind!r}", where=f"inputs.{name}"
            )
        places = points if kind == "force" else list(moving)
        if name not in places:
            what = "point" if kind == "force" else "moving joint"
            raise InvalidParameter(
                f"there is no {what} {name!r}; there are {', '.join(places) or 'none'}", where="inputs"
            )
        if kind == "force":
            new = [Port("force", name, axis) for axis in range(3)]
        else:
            new = [] if kind in ("free", "locked") else [Port(kind, name, slides=moving[name])]
            if name in told:
                raise InvalidParameter("is given twice", where=f"inputs.{name}")
            if kind != "locked":
                told.add(name)
        if new and new[0] in found:
            raise InvalidParameter("is given twice", where=f"inputs.{name}")
        found += new
    stand = {name for name, kind in pairs if kind not in ("free", "force")} | set(held)
    told |= set(following_joints(arm, (), stand))
    return found, {name for name in moving if name not in told | _behind_gears(arm, told)}


def _behind_gears(arm: Arm, told: Collection[str]) -> set[str]:
    """Return joints without a motor of their own: outputs of gears, and inputs whose output is given."""
    reached = set(told)
    for _ in arm.gears:  # as often as there are gears, for trains of them
        reached |= {gear.input for gear in arm.gears if gear.output in reached}
    return reached | {gear.output for gear in arm.gears}


def motor_of(arm: Arm, joint: str) -> tuple[str, float]:
    """Return the joint whose motor sets this one's angle through gears, and the ratio of the two angles."""
    factor, inputs = 1.0, {gear.output: gear for gear in arm.gears}
    while joint in inputs:
        factor *= inputs[joint].ratio
        joint = inputs[joint].input
    return joint, factor


def outputs(arm: Arm, asked: Iterable[str | Sensor] | None) -> list[Sensor]:
    """Return the sensors that are the outputs.

    `asked` has sensors, or names of the model's sensors, of points (their position) and of joints (the link's
    angle). Default: the model's sensors; without sensors all joints that move, and all points.

    Raise InvalidParameter if there is no such name.
    """
    known = {point.name: _position(point.name) for point in arm.points}
    known |= {joint.name: _angle(joint.name) for joint in arm.moving_joints}
    measured = {sensor.name: sensor for sensor in arm.sensors if sensor.quantity not in _NOT_MECHANICAL}
    if asked is None:
        by_default = [_angle(joint.name) for joint in arm.moving_joints]
        by_default += [_position(point.name) for point in arm.points]
        return list(measured.values()) or by_default
    found = []
    for each in asked:
        if isinstance(each, Sensor):
            found.append(each)
        elif each in known | measured:
            found.append((known | measured)[each])
        else:
            raise InvalidParameter(
                f"there is no sensor, point or moving joint {each!r} with a reading; there are "
                f"{', '.join(known | measured) or 'none'}",
                where="outputs",
            )
    return found


_NOT_MECHANICAL = ("joint_command", "motor_voltage")
"""Quantities of controllers and amplifiers, which are no part of a linear model of the arm."""


def _position(point: str) -> Sensor:
    return Sensor(name=point, quantity="position", point=point, rate_hz=1.0)


def _angle(joint: str) -> Sensor:
    return Sensor(name=joint, quantity="joint_angle", joint=joint, side="output", rate_hz=1.0)


def channel_names(arm: Arm, sensors: Iterable[Sensor]) -> tuple[list[str], list[str]]:
    """Name and SI unit of every channel."""
    names, units = [], []
    for sensor in sensors:
        channels = [f"{sensor.name}.{axis}" for axis in sensor.directions] or [sensor.name]
        names += channels
        units += [unit_of_channels(arm, sensor)] * len(channels)
    return names, units


def unit_of_channels(arm: Arm, sensor: Sensor) -> str:
    """Return the SI unit of a sensor's channels; a slide's motor turns, whatever its output does."""
    slides = sensor.joint is not None and arm.joint(sensor.joint).type == "prismatic"
    turns = sensor.quantity == "motor_torque" and sensor.side == "motor"
    return sensor.spec.units[-1 if slides and not turns else 0]
