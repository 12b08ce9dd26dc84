"""Closures: conditions that close a loop in the tree of joints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import hypot
from typing import TYPE_CHECKING, Literal, Self

from pydantic import Field, model_validator

from flexarm.arm.joint import Joint, Origin, coupled_joints
from flexarm.arm.names import Place, link_of
from flexarm.tables import Inconsistent, Name, Table, Vector3, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm

WITHOUT_AXIS = ("spherical", "fixed", "point_on_beam")
"""Types that have no axis."""


SLIDING = ("prismatic", "cylindrical", "point_on_line")
"""Types along whose axis laws of effects act, and not about it."""
PINNED = ("revolute", *SLIDING)
"""Types at whose pin effects act."""


class Closure(Table):
    """A closure: a joint that ties a place on link `a` to a place on link `b` and so closes a loop."""

    name: Name = Field(description="name of the closure")
    """Name, used by results."""
    type: Literal[
        "revolute",
        "spherical",
        "universal",
        "cylindrical",
        "prismatic",
        "fixed",
        "point_on_line",
        "point_on_beam",
    ] = Field(
        description="revolute, spherical, universal, cylindrical, prismatic, fixed, point_on_line or "
        "point_on_beam"
    )
    """Condition between the frames at a and b. The line of `point_on_line` is the axis at a; along the beam a
    of `point_on_beam` the origin at b slides, wherever the beam bends."""
    a: Place = Field(description='"base" or the name of a link')
    b: Place = Field(description='"base" or the name of a link')
    """The base or a link; `link:interface` on a super-element."""
    a_at: Literal["start", "end"] = "start"
    b_at: Literal["start", "end"] = "start"
    """From where on a beam the origin is measured: the link's frame, or its far end."""
    a_origin: Origin = Origin()
    b_origin: Origin = Origin()
    """From there to the frame of the closure. On a beam the frame sits on the section at its projection."""
    axis: Vector3 = value_in("-", "axis of the closure", (0.0, 0.0, 0.0))
    """Axis in the frame at a, any length but zero; of a joint with an axis the frame at b has the same, shape
    (3,)."""
    second_axis: Vector3 | None = value_in("-", "second axis of a universal closure", None)
    """Of a universal closure: the axis in the frame at b that stays across `axis`; default: x, y or z, the
    first that is farthest from the direction of `axis`."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.type not in WITHOUT_AXIS and "axis" not in self.model_fields_set:
            raise Inconsistent((("axis",), f"is missing; {self.type} needs an axis such as [0, 1, 0]"))
        if self.type not in WITHOUT_AXIS and hypot(*self.axis) == 0:
            raise Inconsistent((("axis",), f"must not be zero, got {list(self.axis)}"))
        if self.type != "universal" and self.second_axis is not None:
            raise Inconsistent((("second_axis",), f"belongs to universal closures, this one is {self.type}"))
        if self.second_axis is not None and hypot(*self.second_axis) == 0:
            raise Inconsistent((("second_axis",), f"must not be zero, got {list(self.second_axis)}"))
        return self

    @property
    def across(self) -> tuple[float, float, float]:
        """The second axis, or its default."""
        if self.second_axis is not None:
            return self.second_axis
        farthest = min(range(3), key=lambda i: abs(self.axis[i]))
        x, y, z = (float(i == farthest) for i in range(3))
        return x, y, z


def loop_joints(arm: Arm) -> tuple[str, ...]:
    """Return the moving joints of the loops and those that gears couple to them, in the model's order."""
    found = set().union(*loops(arm))
    return tuple(joint.name for joint in arm.moving_joints if joint.name in found)


def loops(arm: Arm) -> list[set[str]]:
    """Return the joints of the loop that each closure closes, and those that gears couple to them."""
    holder = {link_of(joint.child): joint for joint in arm.joints}
    found = []
    for closure in arm.closures:
        chains = [set(_chain(link_of(place), holder)) for place in (closure.a, closure.b)]
        found.append(coupled_joints(chains[0] ^ chains[1], arm.gears))
    return found


def joints_moved_with(arm: Arm, joint: str) -> set[str]:
    """Return the joints that move when one does: itself, those geared to it, and those of its loops."""
    found, closed = coupled_joints({joint}, arm.gears), loops(arm)
    for _ in closed:  # loops that share joints form a chain of no more of them
        found = found.union(*(loop for loop in closed if loop & found))
    return found


def _chain(link: str, holder: Mapping[str, Joint]) -> Iterable[str]:
    """Yield the joints from a link to the base."""
    while link in holder:
        yield holder[link].name
        link = link_of(holder[link].parent)
