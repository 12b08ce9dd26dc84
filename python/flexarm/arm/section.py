r"""Cross-sections of beams.

.. math::
    \text{round}: A = \pi d^2/4, \; I = \pi d^4/64 \qquad
    \text{tube}: A = \pi t (D - t), \; I = \pi (D^4 - (D - 2t)^4)/64                                  (1)

.. math:: \text{rectangle}: A = w h, \; I_y = w h^3/12, \; I_z = h w^3/12                             (2)

with width w along the local y and height h along the local z. I_y resists bending in the x-z plane.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from flexarm.tables import Inconsistent, Number, Table, Vector2, value_in


class Round(Table):
    """A solid round bar."""

    shape: Literal["round"] = "round"
    diameter: Number = value_in("m", "diameter", gt=0)

    @property
    def area(self) -> float:
        """Area [m2], eq. (1)."""
        return pi * self.diameter**2 / 4

    @property
    def second_moments(self) -> tuple[float, float]:
        """(Iy, Iz) [m4], eq. (1)."""
        return (pi * self.diameter**4 / 64,) * 2


class Tube(Table):
    """A round tube."""

    shape: Literal["tube"] = "tube"
    outer_diameter: Number = value_in("m", "outer diameter", gt=0)
    thickness: Number = value_in("m", "wall", gt=0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        thinnest = 1e-6  # wall over outer diameter of a tube: a thinner one is lost in the rounding of (1)
        if self.thickness >= self.outer_diameter / 2:
            raise Inconsistent(
                (
                    ("thickness",),
                    f"must be less than half the outer diameter of {self.outer_diameter:g} m, "
                    f'got {self.thickness:g} m; a solid bar is shape = "round"',
                )
            )
        if self.thickness < thinnest * self.outer_diameter:
            raise Inconsistent(
                (
                    ("thickness",),
                    f"must be at least {thinnest:g} of the outer diameter of {self.outer_diameter:g} m, "
                    f"got {self.thickness:g} m",
                )
            )
        return self

    @property
    def area(self) -> float:
        """Area [m2], eq. (1)."""
        return pi * self.thickness * (self.outer_diameter - self.thickness)

    @property
    def second_moments(self) -> tuple[float, float]:
        """(Iy, Iz) [m4], eq. (1)."""
        inner = self.outer_diameter - 2 * self.thickness
        return (pi * (self.outer_diameter**4 - inner**4) / 64,) * 2


class Rectangle(Table):
    """A solid rectangle: width along local y, height along local z."""

    shape: Literal["rectangle"] = "rectangle"
    width: Number = value_in("m", "width along local y", gt=0)
    height: Number = value_in("m", "height along local z", gt=0)

    @property
    def area(self) -> float:
        """Area [m2], eq. (2)."""
        return self.width * self.height

    @property
    def second_moments(self) -> tuple[float, float]:
        """(Iy, Iz) [m4], eq. (2)."""
        return self.width * self.height**3 / 12, self.height * self.width**3 / 12


def _pair(value: Any) -> Any:
    """Return one number for both planes, or a list [y, z]."""
    value = value.tolist() if hasattr(value, "tolist") else value
    return value if isinstance(value, list | tuple) else (value, value)


Pair = Annotated[Vector2, BeforeValidator(_pair)]


class General(Table):
    """A section given by its numbers; without a shear area it is rigid in shear.

    The wall of a round tube is only used to check the other numbers against one another.
    """

    shape: Literal["general"] = "general"
    area: Number = value_in("m2", "area", gt=0)
    second_moment: Pair = value_in("m4", "second moment of area, one number or [Iy, Iz]")
    torsion_constant: Number = value_in("m4", "torsion constant", gt=0)
    shear_area: Pair | None = value_in("m2", "shear factor times area, one number or [y, z]", None)
    thickness: Number | None = value_in("m", "wall, a check only", None, gt=0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if min(self.second_moment) <= 0:
            raise Inconsistent((("second_moment",), f"must be positive, got {list(self.second_moment)} m4"))
        if self.shear_area and min(self.shear_area) <= 0:
            raise Inconsistent(
                (
                    ("shear_area",),
                    f"must be positive, got {list(self.shear_area)} m2; "
                    "leave it out for a section rigid in shear",
                )
            )
        return self

    @property
    def second_moments(self) -> tuple[float, float]:
        """(Iy, Iz) [m4]."""
        return self.second_moment


Section = Annotated[Round | Tube | Rectangle | General, Field(discriminator="shape")]


def contradiction(section: General) -> str | None:
    r"""Return a sentence on contradicting numbers of a section; None if they agree.

    Wall t and second moment I of a round tube give its mean diameter m and so its area:

    .. math:: I = \pi t m (m^2 + t^2)/8, \qquad A = \pi t m                                        (3)
    """
    if section.thickness is None:
        return None
    t, inertia = section.thickness, section.second_moment[0]
    mean = _mean_diameter(t, inertia)
    area = pi * t * mean  # eq. (3)
    if abs(area - section.area) <= 0.01 * area:  # tables print areas to two or three digits
        return None
    solid = min(sqrt(section.area / pi), (4 * inertia / pi) ** 0.25)
    if t > solid:
        return (
            f"wall {t:g} m contradicts area {section.area:g} m2 and second moment {inertia:g} m4: as a "
            f"solid round bar its radius is {solid:.3g} m, and a wall must be less than that"
        )
    from_area = section.area / (pi * t)
    agree = pi * t * from_area * (from_area**2 + t**2) / 8  # eq. (3)
    return (
        f"wall {t:g} m, area {section.area:g} m2 and second moment {inertia:g} m4 contradict one another: "
        f"wall and second moment belong to a tube of outer diameter {1e3 * (mean + t):.2f} mm and area "
        f"{area:.3g} m2; wall and area to one of outer diameter {1e3 * (from_area + t):.2f} mm and second "
        f"moment {agree:.3g} m4"
    )


def _mean_diameter(t: float, inertia: float) -> float:
    """Root m of (3) by Newton's method from above, where the cubic is convex."""
    c = 8 * inertia / (pi * t)
    m: float = c ** (1 / 3)
    for _ in range(60):
        step = (m**3 + t**2 * m - c) / (3 * m**2 + t**2)
        m -= step
        if abs(step) < 1e-15 * m:
            break
    return m
