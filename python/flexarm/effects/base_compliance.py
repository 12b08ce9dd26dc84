r"""A base that gives way: everything that stands on it turns about its origin.

.. math:: k \psi + c \dot\psi = M                                                                    (1)

\psi [rad] is the angle about the axis of the first joint that turns (of the joints nearest to the base the
first in the file, at q = 0), and M [N m] the moment of the arm about that axis through the base's origin.
With two stiffnesses the base turns about its x and y instead, by (1) about each, as on soft ground. The base
itself has no mass. Where the arm has one joint, at the base's origin, statics cannot tell this from a
compliance of the joint by the tip; by what stands on the base beside the joint they can.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import hypot, inf
from typing import TYPE_CHECKING, ClassVar, Self

from flexarm.arm.prior import Prior
from flexarm.arm.spring_effect import Damping, SpringEffect, Stiffness
from flexarm.arm.weight import base_axis, first_turning_joint
from flexarm.tables import value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arm.effect import Effect
    from flexarm.arm.rotation import Vector
    from flexarm.assembly.machine import Machine


class BaseCompliance(SpringEffect):
    """Linear spring and damper under the base.

    `stiffness` is k of (1) about the first joint's axis, or about the base's x and y; 1e12 about one of the
    two is rigid. `damping` is c, one number for both axes or two.
    """

    name = "base_compliance"
    typical_stiffness: ClassVar[float] = 3e6
    """Of a machine bolted to a floor [N m/rad]."""
    upright: ClassVar[float] = 0.9
    """Cosine between the first axis and z above which a search tries a base that gives about x and y too."""
    stiffness: Stiffness = value_in("N m/rad", "stiffness of the base, or [about x, about y]", inf)
    damping: Damping = value_in("N m s/rad", "damping of the base, or [about x, about y]", 0.0)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """There must be an axis to turn about."""
        if first_turning_joint(arm) is None and not isinstance(self.stiffness, tuple):
            yield (
                "at",
                "the base turns about the axis of the first revolute joint, and the model has none; "
                "stiffness = [about x, about y] needs no joint",
            )

    def patch(self, machine: Machine) -> None:
        """Add springs and dampers, eq. (1)."""
        if isinstance(self.stiffness, tuple):
            axes: list[Vector] = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
        else:
            axes = [base_axis(machine.arm)]
        machine.base.hinge(self.soft_about(axes))  # eq. (1)

    def first_stiffness(self, arm: Arm) -> float:
        """Return the typical one where the model states springs of joints, else that of a joint.

        In a model of rigid joints a base may stand for all that gives way below it.
        """
        stated = any(each.is_spring and each.place == "joint" and not each.inert for each in arm.effects)
        typical = self.typical_stiffness if stated else SpringEffect.typical_stiffness
        return typical * self.heavier(arm)

    @classmethod
    def variants(cls, at: str, arm: Arm, stated: Effect | None) -> list[Self]:
        """Return one about the first joint's axis and, where that stands upright, one about x and y."""
        one = cls.typical(at, arm)
        two = one.replace(stiffness=(one.softest, one.softest))
        if isinstance(stated, cls):
            return [stated if isinstance(stated.stiffness, tuple) else one]
        axis = base_axis(arm)
        if first_turning_joint(arm) is None:
            return [two]
        return [one, two] if abs(axis[2]) > cls.upright * hypot(*axis) else [one]

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From a frame on a floor of wood to a plate on bedrock; damping in proportion."""
        typical = self.typical_in(arm)
        stiffness = typical if self.inert else self.softest
        where = (
            "engineering judgement: frames bolted to a floor from 1e5, plates grouted into concrete to 1e8"
        )
        loss = "engineering judgement: 0.1 to 10 % of critical for an arm that swings on it at a few Hz"
        spring = Prior(1e5, 1e8 * self.heavier(arm), typical, "log", "N m/rad", where)
        damper = Prior(1e-4 * stiffness, 1e-2 * stiffness, 1e-3 * stiffness, "log", "N m s/rad", loss)
        return {**dict.fromkeys(self.stiffnesses, spring), **dict.fromkeys(self._keyed("damping"), damper)}
