"""Links: beams, rigid bodies, super-elements."""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING, Annotated, Literal, Self

from pydantic import Field, model_validator

from flexarm.arm.inertia import Inertia, impossible
from flexarm.arm.part_files import load_part
from flexarm.arm.rotation import IDENTITY, Vector, dot
from flexarm.arm.section import Section
from flexarm.material import Material
from flexarm.tables import Inconsistent, Name, Number, Table, Vector3, value_in
from flexarm.tables.table import Whole

if TYPE_CHECKING:
    from flexarm.superelement import SuperElement


WEIGHTLESS = "must be 0 where the density is 0, got {ratio:g}; a ratio is of a vibration, which needs mass"


class Beam(Table):
    """A straight elastic link of constant section."""

    name: Name = Field(description="name of the link")
    type: Literal["beam"] = "beam"
    end: Vector3 = value_in("m", "far end in the link's frame")
    """From the link's frame to its far end [m]; local x runs along it, shape (3,)."""
    up: Vector3 | None = value_in("-", "direction that local z leans to", None)
    """Direction in the link's frame whose part normal to `end` is local z; needed only where Iy differs from
    Iz."""
    section: Section = Field(
        description='a table such as { shape = "tube", outer_diameter = 0.06, thickness = 0.003 }'
    )
    material: Material = Field(description="a table with youngs_modulus, poisson_ratio, density")
    theory: Literal["timoshenko", "euler-bernoulli"] = "timoshenko"
    """With shear and rotary inertia, or with neither."""
    elements: Whole = value_in("-", "number of elements", 4, ge=1, le=100_000)
    damping_ratio: Number = value_in("-", "damping ratio of the first clamped mode", 0.0, ge=0, lt=1)
    """Of the link alone in its first clamped mode, without payload; stiffness-proportional."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.length == 0:
            raise Inconsistent((("end",), f"a beam must have a length, got end = {list(self.end)} m"))
        if self.damping_ratio > 0 and self.material.density == 0:
            raise Inconsistent((("damping_ratio",), WEIGHTLESS.format(ratio=self.damping_ratio)))
        if self.up is None:
            if not bends_alike(self.section):
                iy, iz = self.section.second_moments
                raise Inconsistent(
                    (
                        ("up",),
                        f"is missing; the section bends differently in its two planes (Iy = {iy:.4g}, "
                        f"Iz = {iz:.4g} m4), so say where local z points",
                    )
                )
        elif _sine(self.up, self.end) < 1e-6:
            raise Inconsistent(
                (("up",), f"must not be zero or along end = {list(self.end)}, got {list(self.up)}")
            )
        return self

    @property
    def length(self) -> float:
        """Length [m]."""
        return hypot(*self.end)

    @property
    def lean(self) -> Vector:
        """`up`, or where it is left out the axis of the link's frame that is farthest from the beam."""
        return self.up or min(IDENTITY, key=lambda axis: abs(dot(axis, self.end)))


def bends_alike(section: Section) -> bool:
    """Return True if Iy is Iz, so that a beam needs no `up`."""
    iy, iz = section.second_moments
    return abs(iy - iz) <= 1e-9 * max(iy, iz)


class RigidLink(Table):
    """A rigid body; its inertia is in the axes of the link, three or six numbers."""

    name: Name = Field(description="name of the link")
    type: Literal["rigid"] = "rigid"
    mass: Number = value_in("kg", "mass", ge=0)
    com: Vector3 = value_in("m", "centre of mass in the link's frame", (0.0, 0.0, 0.0))
    inertia: Inertia = value_in("kg m2", "inertia about the centre of mass", (0.0, 0.0, 0.0))

    @model_validator(mode="after")
    def _check(self) -> Self:
        if why := impossible(self.inertia):
            raise Inconsistent((("inertia",), why))
        return self


class SuperElementLink(Table):
    """A part reduced to its interfaces and internal modes, such as `flexarm reduce` makes from a mesh.

    A model file names the file from where it lies itself. The damping ratio is that of the part alone in its
    lowest mode, proportional to the stiffness, in place of the damping in the file.
    """

    name: Name = Field(description="name of the link")
    type: Literal["superelement"] = "superelement"
    file: str = Field(description="name of the file with the reduced matrices", min_length=1)
    damping_ratio: Number = value_in("-", "damping ratio, held at the first interface", 0.0, ge=0, lt=1)

    @property
    def part(self) -> SuperElement:
        """The matrices.

        Raise InvalidFile if the file cannot be read.
        """
        return load_part(self.file)


Link = Annotated[Beam | RigidLink | SuperElementLink, Field(discriminator="type")]


def _sine(a: Vector3, b: Vector3) -> float:
    """Sine of the angle between two vectors, 0 if one is zero."""
    cross = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    lengths = hypot(*a) * hypot(*b)
    return hypot(*cross) / lengths if lengths else 0.0
