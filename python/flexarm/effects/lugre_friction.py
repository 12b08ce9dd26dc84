r"""Friction in the output bearing by the LuGre model: it sticks, gives way, and then holds less.

.. math:: T \leftarrow T - \sigma_0 z - \sigma_1 \dot z - \sigma_2 \dot\theta, \qquad
   \dot z = \dot\theta - \sigma_0 |\dot\theta| z / g(\dot\theta)                                        (1)
.. math:: g(v) = F_c + (F_s - F_c) \exp(-(v/v_s)^2)                                                     (2)

\theta [rad] is the link's angle, z [rad] the mean bending of the bristles between the surfaces, zero at the
equilibrium from which the motion starts [CanudasDeWit1995]_. Beside `coulomb_friction` (Dahl's law, without
rate) for joints whose friction depends on the rate, and for stick-slip.

References
----------
.. [CanudasDeWit1995] C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, "A new model for control of
   systems with friction", IEEE Transactions on Automatic Control 40(3), 1995.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

from pydantic import model_validator

from flexarm.arm.closure import PINNED
from flexarm.arm.effect import Effect
from flexarm.arm.prior import Prior
from flexarm.tables import Inconsistent, Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class LugreFriction(Effect):
    """LuGre friction at the output bearing.

    `coulomb` is F_c, `breakaway` F_s and `stribeck_rate` v_s of (2); `bristle_stiffness` is sigma_0,
    `bristle_damping` sigma_1 and `viscous` sigma_2 of (1).
    """

    name = "lugre_friction"
    competes = False
    torque_at = "output"
    at_closures = PINNED
    varies_with = "rate"
    coulomb: Number = value_in("N m", "torque of the friction while it slips", gt=0)
    breakaway: Number = value_in("N m", "torque at which it gives way, at least coulomb", gt=0)
    bristle_stiffness: Number = value_in("N m/rad", "stiffness while it sticks", gt=0)
    bristle_damping: Number = value_in("N m s/rad", "damping while it sticks", 0.0, ge=0)
    viscous: Number = value_in("N m s/rad", "viscous friction", 0.0, ge=0)
    stribeck_rate: Number = value_in("rad/s", "rate between sticking and slipping", 1e-2, gt=0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.breakaway < self.coulomb:
            raise Inconsistent(
                (
                    ("breakaway",),
                    f"must not be below coulomb = {self.coulomb:g} N m, got {self.breakaway:g} N m",
                )
            )
        return self

    def patch(self, machine: Machine) -> None:
        """Add the LuGre law at the output bearing, eqs. (1), (2)."""
        from flexarm import _core

        machine.drive_trains[self.at].bearing.append(
            _core.LugreFriction(
                bristle_stiffness=self.bristle_stiffness,
                bristle_damping=self.bristle_damping,
                viscous=self.viscous,
                coulomb=self.coulomb,
                breakaway=self.breakaway,
                stribeck_rate=self.stribeck_rate,
            )
        )

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Torques as of dry friction; bristles that bend by 1e-5 to 1e-3 rad before they slip.

        Those of starting and of the bristles go with the torque while it slips, below which none may start.
        """
        torques = (
            "engineering judgement: running torques of cross-roller bearings and slewing rings with seals"
        )
        starting = "engineering judgement: starting torques are 1 to 2 times running torques"
        bristles = "engineering judgement: a joint creeps by 1e-5 to 1e-3 rad before it slips"
        rates = "Armstrong-Helouvry et al., Automatica 30(7), 1994: 1e-5 to 0.1 m/s, at radii of some 0.1 m"
        slip = self.coulomb
        return {
            "coulomb": Prior(0.2, 200.0, 8.0, "log", "N m", torques),
            "breakaway": Prior(1.05 * slip, 2.0 * slip, 1.25 * slip, "log", "N m", starting),
            "bristle_stiffness": Prior(1e3 * slip, 1e5 * slip, 1e4 * slip, "log", "N m/rad", bristles),
            "bristle_damping": Prior(slip, 1e3 * slip, 30 * slip, "log", "N m s/rad", bristles),
            "viscous": Prior(0.2, 300.0, 10.0, "log", "N m s/rad", "as viscous_friction"),
            "stribeck_rate": Prior(1e-4, 1.0, 1e-2, "log", "rad/s", rates),
        }
