"""Joints between links, and gears between joints."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import hypot
from typing import TYPE_CHECKING, Literal, Self

from pydantic import Field, model_validator

from flexarm.arm.names import Place
from flexarm.tables import Inconsistent, Name, Number, Table, Vector3, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm


class Origin(Table):
    """Pose of a joint's frame in its parent's, URDF convention: R = Rz(yaw) Ry(pitch) Rx(roll)."""

    xyz: Vector3 = value_in("m", "translation", (0.0, 0.0, 0.0))
    rpy: Vector3 = value_in("rad", "roll, pitch, yaw", (0.0, 0.0, 0.0))


class Joint(Table):
    """A joint: the child link moves about or along `axis` of the joint's frame."""

    name: Name = Field(description="name of the joint")
    """Name, used by --joint, drives, effects and signals."""
    type: Literal["revolute", "prismatic", "fixed", "universal", "spherical"] = Field(
        description="revolute, prismatic, fixed, universal or spherical"
    )
    """Universal and spherical ones are hinges when a model is read (`flexarm.arm.crossed_hinges`)."""
    parent: Place = Field(description='"base" or the name of a link')
    child: Place = Field(description="name of a link")
    """The base or a link; `link:interface` on a super-element."""
    at: Literal["start", "end"] = "start"
    """From where on the parent `origin` is measured: its frame, or the far end of a beam, which moves with
    it."""
    origin: Origin = Origin()
    """From there to the joint's frame."""
    axis: Vector3 = value_in("-", "axis of the joint", (0.0, 0.0, 0.0))
    """Axis in the joint's frame, any length but zero; not needed for a fixed joint, shape (3,)."""
    gear_ratio: Number = value_in("-", "motor angle over output angle", 1.0)
    """Motor angle over output angle [-]; a negative one turns the other way."""
    rotor_inertia: Number = value_in("kg m2", "inertia of the rotor, motor side", 0.0, ge=0)
    """Of all that turns with the motor's shaft, motor side [kg m2]."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.type in ("universal", "spherical"):
            axes = (
                "axis and second_axis"
                if self.type == "universal"
                else "no axis: its hinges turn about x, y, z"
            )
            what = f"is {self.type}, and needs {axes}; gears, rotors and drives belong to its hinges"
            raise Inconsistent((("type",), what))
        if self.type != "fixed" and "axis" not in self.model_fields_set:
            raise Inconsistent(
                (("axis",), f"is missing; a {self.type} joint needs an axis such as [0, 1, 0]")
            )
        if self.type != "fixed" and hypot(*self.axis) == 0:
            raise Inconsistent((("axis",), f"must not be zero, got {list(self.axis)}"))
        if self.gear_ratio == 0:
            raise Inconsistent((("gear_ratio",), "must not be zero, got 0; motor angle over output angle"))
        return self

    @property
    def moves(self) -> bool:
        """True if the joint has a coordinate."""
        return self.type != "fixed"


class Gear(Table):
    """Couples two joints: angle of `input` = ratio x angle of `output`, instead of its `gear_ratio`."""

    name: Name = Field(description="name of the gear")
    input: Name = Field(description="name of the joint on the motor's side")
    output: Name = Field(description="name of the joint on the arm's side")
    ratio: Number = value_in("-", "input angle over output angle")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.ratio == 0:
            raise Inconsistent((("ratio",), "must not be zero, got 0; input angle over output angle"))
        if self.input == self.output:
            raise Inconsistent(
                (("output",), f"must be another joint than input, got {self.output!r} for both")
            )
        return self


def coupled_joints(joints: Iterable[str], gears: Sequence[Gear]) -> set[str]:
    """Return these joints and all that gears couple to them."""
    found = set(joints)
    for _ in gears:  # a chain has no more of them
        for gear in gears:
            if found & {gear.input, gear.output}:
                found |= {gear.input, gear.output}
    return found


def shaft_ratio(joint: str | None, gears: Sequence[Gear]) -> float:
    """Return the turns of a joint for one turn of the slowest joint that it drives; 1 if it drives none."""
    found = 1.0
    for k, gear in enumerate(gears):
        if gear.input == joint:
            others = [*gears[:k], *gears[k + 1 :]]
            found = max(found, abs(gear.ratio) * shaft_ratio(gear.output, others))
    return found


def gear_input(arm: Arm, joint: str) -> str:
    """Return the joint whose drive moves a joint: itself, or at the input of its gears."""
    inputs = {gear.output: gear.input for gear in arm.gears}
    while joint in inputs:
        joint = inputs[joint]
    return joint


def motor_ratio(arm: Arm, joint: str) -> float:
    """Return the ratio of a joint's motor: of all gears before it, times that of the joint at their input."""
    before = {gear.output: gear for gear in arm.gears}
    ratio = 1.0
    while joint in before:
        ratio, joint = ratio * before[joint].ratio, before[joint].input
    return ratio * arm.joint(joint).gear_ratio
