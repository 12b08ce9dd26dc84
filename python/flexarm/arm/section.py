r"""Cross-sections of beams.

.. math::
    \text{round}: A = \pi d^2/4, \; I = \pi d^4/64 \qquad
    \text{tube}: A = \pi t (D - t), \; I = \pi (D^4 - (D - 2t)^4)/64                                  (1)

.. math:: \text{rectangle}: A = w h, \; I_y = w h^3/12, \; I_z = h w^3/12                             (2)

with width w along the local y and height h along the local z. I_y resists bending in the x-z plane. A hollow
one loses the inner rectangle. With a wall t, whose middle is b = w - t wide and a = h - t high, Bredt's
formula and the torsion of the wall itself give its torsion constant [EN10210], within 7 % for any wall, and
the energy of the shear flow S(s) V/I its shear area along z,

.. math:: J = 2 t a^2 b^2/(a + b) + 2 t^3 (a + b)/3, \qquad
    A_z = I^2 \Big/ \oint S^2/t \, ds, \quad I = t a^3/6 + t a^2 b/2                                 (3)

.. math:: \oint S^2/t \, ds = t a^2 b^3/24 + 2 t (d^2 a - d a^3/12 + a^5/320), \quad d = a b/4 + a^2/8  (4)

Source: thin walls, as in [Cowper1966], at a Poisson ratio of 0.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from flexarm.tables import Inconsistent, Number, Table, Vector2, to_python, value_in

_THINNEST = 1e-6
"""Wall over the width of a hollow section: a thinner one is lost in the rounding of (1)."""


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
        if self.thickness >= self.outer_diameter / 2:
            raise Inconsistent(
                (
                    ("thickness",),
                    f"must be less than half the outer diameter of {self.outer_diameter:g} m, "
                    f'got {self.thickness:g} m; a solid bar is shape = "round"',
                )
            )
        if self.thickness < _THINNEST * self.outer_diameter:
            raise Inconsistent(
                (
                    ("thickness",),
                    f"must be at least {_THINNEST:g} of the outer diameter of {self.outer_diameter:g} m, "
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
    """A rectangle, width along local y, height along local z: solid, or hollow with a wall."""

    shape: Literal["rectangle"] = "rectangle"
    width: Number = value_in("m", "width along local y", gt=0)
    height: Number = value_in("m", "height along local z", gt=0)
    thickness: Number | None = value_in("m", "wall of a hollow one", None, gt=0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        thinner = min(self.width, self.height)
        if self.thickness is not None and not _THINNEST * thinner <= self.thickness < thinner / 2:
            what = (
                f"must be less than half of {thinner:g} m, and at least {_THINNEST:g} of it, got "
                f"{self.thickness:g} m; leave it out for a solid bar"
            )
            raise Inconsistent((("thickness",), what))
        return self

    @property
    def _inner(self) -> tuple[float, float]:
        """Width and height of the hole [m]."""
        wall = self.thickness
        return (0.0, 0.0) if wall is None else (self.width - 2 * wall, self.height - 2 * wall)

    @property
    def area(self) -> float:
        """Area [m2], eq. (2)."""
        w, h = self._inner
        return self.width * self.height - w * h

    @property
    def second_moments(self) -> tuple[float, float]:
        """(Iy, Iz) [m4], eq. (2)."""
        w, h = self._inner
        return (
            (self.width * self.height**3 - w * h**3) / 12,
            (self.height * self.width**3 - h * w**3) / 12,
        )

    def hollow(self, wall: float) -> tuple[float, tuple[float, float]]:
        """Return torsion constant [m4] and shear areas along y and z [m2] of one with a wall, eq. (3)."""
        b, a = self.width - wall, self.height - wall
        torsion = 2 * wall * a**2 * b**2 / (a + b) + 2 * wall**3 * (a + b) / 3
        return torsion, (_shear_area(b, a, wall), _shear_area(a, b, wall))


def _shear_area(a: float, b: float, t: float) -> float:
    """Return the shear area along the side a of a hollow rectangle [m2], eqs. (3) and (4)."""
    d = a * b / 4 + a**2 / 8
    flow = t * a**2 * b**3 / 24 + 2 * t * (d**2 * a - d * a**3 / 12 + a**5 / 320)
    return (t * a**3 / 6 + t * a**2 * b / 2) ** 2 / flow


def _pair(value: Any) -> Any:
    """Return one number for both planes, or a list [y, z]."""
    value = to_python(value)
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

    .. math:: I = \pi t m (m^2 + t^2)/8, \qquad A = \pi t m                                        (5)
    """
    if section.thickness is None:
        return None
    t, inertia = section.thickness, section.second_moment[0]
    mean = _mean_diameter(t, inertia)
    area = pi * t * mean  # eq. (5)
    if abs(area - section.area) <= 0.01 * area:  # tables print areas to two or three digits
        return None
    solid = min(sqrt(section.area / pi), (4 * inertia / pi) ** 0.25)
    if t > solid:
        return (
            f"wall {t:g} m contradicts area {section.area:g} m2 and second moment {inertia:g} m4: as a "
            f"solid round bar its radius is {solid:.3g} m, and a wall must be less than that"
        )
    from_area = section.area / (pi * t)
    agree = pi * t * from_area * (from_area**2 + t**2) / 8  # eq. (5)
    return (
        f"wall {t:g} m, area {section.area:g} m2 and second moment {inertia:g} m4 contradict one another: "
        f"wall and second moment belong to a tube of outer diameter {1e3 * (mean + t):.2f} mm and area "
        f"{area:.3g} m2; wall and area to one of outer diameter {1e3 * (from_area + t):.2f} mm and second "
        f"moment {agree:.3g} m4"
    )


def _mean_diameter(t: float, inertia: float) -> float:
    """Root m of (5) by Newton's method from above, where the cubic is convex."""
    c = 8 * inertia / (pi * t)
    m: float = c ** (1 / 3)
    for _ in range(60):
        step = (m**3 + t**2 * m - c) / (3 * m**2 + t**2)
        m -= step
        if abs(step) < 1e-15 * m:
            break
    return m
