"""Payloads on links, and the points that sensors see."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from flexarm.arm.inertia import Inertia, impossible
from flexarm.arm.names import Place
from flexarm.tables import Inconsistent, Name, Number, Table, Vector3, value_in


class Payload(Table):
    """A mass that sits rigidly on a link: on a beam, on the section at its projection on the axis.

    `link` is `link:interface` on a super-element, in whose frame position and inertia then are. The inertia
    has three or six numbers; default a point mass.
    """

    name: Name = Field(description="name of the payload")
    link: Place = Field(description="name of a link")
    position: Vector3 = value_in("m", "position in the link's frame")
    mass: Number = value_in("kg", "mass", ge=0)
    inertia: Inertia = value_in("kg m2", "inertia about its own centre", (0.0, 0.0, 0.0))

    @model_validator(mode="after")
    def _check(self) -> Self:
        if why := impossible(self.inertia):
            raise Inconsistent((("inertia",), why))
        return self


class Point(Table):
    """A place that a sensor sees, or a force acts at; `link` and `position` as those of `Payload`."""

    name: Name = Field(description="name of the point")
    link: Place = Field(description="name of a link")
    position: Vector3 = value_in("m", "position in the link's frame")
