r"""A law that a table gives: windup of a joint, or torque at its output bearing, of a state of the joint.

.. math:: T = T_s(d + w(y)), \qquad d = \psi - \theta                                                   (1)
.. math:: T \leftarrow T - f(y)                                                                       (2)

A `windup` w [rad] is added to the deflection d of the reducer's spring T_s, eq. (1), and so turns the link
forward: a table w = -c T makes a spring of stiffness k one of 1/(1/k + c). A `torque` f [N m] is lost by T as
friction is, eq. (2). The table is a function of y: of the `angle` \theta [rad] of the link, of its `rate`
[rad/s], of the `motor_angle` \varphi over the gear ratio [rad], or, a windup alone, of the `torque` T_s
[N m].

Between knots the table is a monotone cubic [Fritsch1984]_, beyond them it holds its first and last value. A
windup of the torque is solved within the spring; of the motor's angle it is a part of the teeth's map, as
`transmission_error` is. Without `joint_compliance` a windup moves the drive: of the motor's angle exactly,
else on a spring of 1e9 N m/rad. The spring's damper acts on \psi' - \theta'.

References
----------
.. [Fritsch1984] F. N. Fritsch, J. Butland, "A method for constructing local monotone piecewise cubic
   interpolants", SIAM Journal on Scientific and Statistical Computing 5(2), 1984.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import TYPE_CHECKING, ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, model_validator

from flexarm.arm.effect import Effect
from flexarm.arm.prior import Prior
from flexarm.effects.joint_compliance import JointCompliance
from flexarm.tables import Inconsistent, Numbers, value_in
from flexarm.tables.field import Path

if TYPE_CHECKING:
    from flexarm import _core
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine

NEARLY_RIGID = 1e9
"""Stiffness of a joint without compliance that winds up by a table [N m/rad]: 1 microradian per kN m."""
OF_UNIT = {"angle": "rad", "rate": "rad/s", "torque": "N m", "motor_angle": "rad"}
"""Unit of x by what it is a table of."""
UNIT = {"windup": "rad", "torque": "N m"}
"""Unit of the values by quantity."""
ACTS = {"windup": ("angle", "rate", "torque", "motor_angle"), "torque": ("angle", "rate", "motor_angle")}
"""What the quantities that can be simulated may be tables of."""


class TabulatedLaw(Effect):
    """A table of a joint's windup or lost torque.

    `quantity` "windup" is w of (1), "torque" f of (2); `x` and `value` are the table of y.
    """

    name: ClassVar[str] = "tabulated_law"
    competes = False
    at_closures = True
    quantity: Literal["windup", "torque", "curvature", "force"] = Field(description='"windup" or "torque"')
    of: Literal["angle", "rate", "torque", "motor_angle"] = Field(
        description='"angle", "rate", "torque" or "motor_angle"'
    )
    x: Numbers = value_in("SI", "knots, rising", numbered=True)
    value: Numbers = value_in("SI", "values at the knots", numbered=True)
    direction: str | None = Field(None, description="left out: a joint has one direction")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if problems := list(self._problems()):
            raise Inconsistent(*problems)
        return self

    def _problems(self) -> Iterable[tuple[Path, str]]:
        if self.of not in ACTS.get(self.quantity, ()):
            known = "; ".join(f"{quantity} of {', '.join(of)}" for quantity, of in ACTS.items())
            key = "of" if self.quantity in ACTS else "quantity"
            yield ((key,), f"{self.quantity} of {self.of} cannot be simulated; at a joint there are: {known}")
        if self.direction is not None:
            what = f"must be left out at a joint, which has one direction, got {self.direction!r}"
            yield ("direction",), what
        if len(self.x) < 2:
            yield ("x",), f"must be two knots or more, got {len(self.x)}"
        if len(self.value) != len(self.x):
            yield (("value",), f"must have as many numbers as x, {len(self.x)}, got {len(self.value)}")
        for before, knot in pairwise(self.x):
            if not knot > before:
                yield ("x",), f"must rise from knot to knot, got {knot:g} after {before:g}"
                break

    def __call__(self, y: ArrayLike) -> NDArray[np.float64]:
        """Return the table at y [rad, rad/s or N m], shape of y."""
        sign = -1.0 if self.quantity == "windup" else 1.0
        return sign * np.asarray(self.table()(np.asarray(y, float)))

    def table(self) -> _core.MonotoneCubic:
        """Return the table as the core takes it: it counts by what a windup leaves the link behind, -w."""
        from flexarm import _core

        behind = self.quantity == "windup"
        return _core.MonotoneCubic(self.x, [-each for each in self.value] if behind else self.value)

    def patch(self, machine: Machine) -> None:
        """Add the table to the teeth, the spring or the output bearing, eqs. (1), (2)."""
        from flexarm import _core

        train = machine.drive_trains[self.at]
        if self.quantity == "torque":
            train.bearing.append(_core.TabulatedTorque(_core.Of[self.of], self.table()))  # eq. (2)
        elif self.of == "motor_angle":
            train.teeth().windup = self.table()
        else:
            train.windup = (self.of, self.table())  # eq. (1)
            train.stiffness = min(train.stiffness, NEARLY_RIGID)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Refuse windups that would turn the output back, or leave the spring without stiffness."""
        if self.quantity == "windup" and self.at in [closure.name for closure in arm.closures]:
            yield "quantity", f'must be "torque" at a closure, which has no spring, got "{self.quantity}"'
        if self.quantity != "windup" or self.of not in ("motor_angle", "torque"):
            return
        low, high = self.table().slopes()
        if self.of == "motor_angle" and max(-low, high) >= 1:
            yield (
                "value",
                f"must change by less than 1 rad per rad of the motor's angle, else the output turns back; "
                f"the table reaches {max(-low, high):.3g}",
            )
        spring = arm.effect(JointCompliance.name, self.at)
        k = NEARLY_RIGID if spring is None or spring.inert else spring.value_of("stiffness")
        if self.of == "torque" and -low * k >= 1:
            yield (
                "value",
                f"must not rise with the torque by 1/stiffness = {1 / k:.3g} rad/(N m) or more, which would "
                f"leave the spring none; the table rises by {-low:.3g}",
            )

    def parameters(self) -> list[tuple[str, float, str]]:
        """Values at the knots as (name, value, unit); knots stay where they are."""
        return [found for found in super().parameters() if found[0].startswith("value.")]

    def unit(self, name: str) -> str:
        """Return the unit of x or of the values about a revolute joint."""
        return {"x": OF_UNIT[self.of], "value": UNIT[self.quantity]}.get(name, super().unit(name))

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Return sizes of what no law of the vocabulary explains: wide, and about zero."""
        size = {"windup": 1e-3, "torque": 100.0}[self.quantity]
        source = "engineering judgement: as large as compliance and friction of a joint"
        prior = Prior(-size, size, 0.0, "linear", UNIT[self.quantity], source)
        return {name: prior for name, _, _ in self.parameters()}

    @classmethod
    def typical(cls, at: str, arm: Arm) -> Self:
        """Return a windup that grows most where the torque changes sign: teeth that are not pressed home."""
        return cls(
            at=at,
            quantity="windup",
            of="torque",
            x=(-400.0, -40.0, 40.0, 400.0),
            value=(4e-4, 2e-4, -2e-4, -4e-4),
        )
