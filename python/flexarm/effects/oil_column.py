r"""Oil column of a hydraulic cylinder: the oil on both sides of the piston gives way as a spring.

.. math:: T = k(\varphi) (\varphi - \theta) + c (\dot\varphi - \dot\theta), \qquad
   k(\varphi) = \beta \left(\frac{A^2}{V_0 + A s} + \frac{a^2}{V_0 + a (S - s)}\right), \quad
   s = \varphi - \varphi_0                                                                            (1)

T [N] is the force on the piston, \varphi [m] the stroke that the valve has set, \theta the stroke of the
piston, \varphi_0 that at which it is retracted, S the whole stroke. A and a are the areas of its two sides,
of a vane motor the volumes per radian. V_0 is the dead volume of each side with its hoses, and \beta the
bulk modulus of the oil with its air and its hoses. The column is softest near the middle of the stroke.
Beyond its ends k stays as it is there [Merritt1967]_.

References
----------
.. [Merritt1967] H. E. Merritt, "Hydraulic Control Systems", Wiley, 1967.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, ClassVar, Self

from flexarm.arm.effect import Effect, Probes, Search, Trial
from flexarm.arm.joint_units import priors_in
from flexarm.arm.prior import Prior, Priors, Values
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class OilColumn(Effect):
    """Oil on both sides of a piston, between valve and rod.

    `bulk_modulus` is beta, `piston_area` A, `ring_area` a (0: oil on one side only), `dead_volume` V_0,
    `stroke` S, `retracted` phi_0 and `damping` c of (1).
    """

    name = "oil_column"
    softer: ClassVar[float] = 1.5
    """Factor by which the oil is probed softer than stated."""
    stated_only = True
    priors_along = True
    shape = ("damping",)
    in_motion = ("damping",)
    varies_with = "torque"
    bulk_modulus: Number = value_in("Pa", "bulk modulus of the oil with air and hoses", gt=0)
    piston_area: Number = value_in("m3/rad", "area of the piston", gt=0)
    ring_area: Number = value_in("m3/rad", "area of the piston on the side of its rod", 0.0, ge=0)
    dead_volume: Number = value_in("m3", "oil in ports and hoses of each side", gt=0)
    stroke: Number = value_in("rad", "whole stroke", gt=0)
    retracted: Number = value_in("rad", "drive where the piston is retracted", 0.0)
    damping: Number = value_in("N m s/rad", "damping of the column, by leakage and throttles", 0.0, ge=0)

    @property
    def travel(self) -> tuple[float, float]:
        """Return where the piston is retracted, and where it is extended."""
        return self.retracted, self.retracted + self.stroke

    def patch(self, machine: Machine) -> None:
        """Put the oil between the drive and what it moves, eq. (1)."""
        from flexarm import _core

        machine.drive_trains[self.at].oil = _core.OilColumn(
            bulk_modulus=self.bulk_modulus,
            piston_area=self.piston_area,
            ring_area=self.ring_area,
            dead_volume=self.dead_volume,
            retracted=self.retracted,
            stroke=self.stroke,
            damping=self.damping,
        )

    def trials(self, search: Search) -> Iterator[Trial]:
        """Yield the cylinder as its drawing has it: air in the oil changes beta and c alone."""
        sought = ("bulk_modulus", "damping") if self.damping else ("bulk_modulus",)
        yield Trial(fixed={name: value for name, value, _ in self.parameters() if name not in sought})

    def probes(
        self, stated: Effect | None, free: Sequence[str], null: Values, priors: Priors
    ) -> Iterator[Self]:
        """Yield oil with so much air that it is softer by a half: 1/k of (1) is linear in 1/beta."""
        yield self.with_parameters({"bulk_modulus": null["bulk_modulus"] / self.softer})

    def sized(self, multiples: Sequence[float], probed: Probes) -> dict[str, float]:
        """Return the bulk modulus of a multiple of its probe's flexibility."""
        rigid = 1.0 / probed.null["bulk_modulus"]
        soft = rigid + multiples[0] * (self.softer - 1.0) * rigid
        return {"bulk_modulus": 1.0 / max(soft, probed.least * rigid)}

    def stated_priors(self, arm: Arm) -> dict[str, Prior]:
        """Return priors about what the model states: oil is softer with air, and hardly ever stiffer."""
        beta, c, usual = self.bulk_modulus, self.damping, priors_in(self, arm)
        air = "handbooks: entrapped air and hoses take up to four fifths of the bulk modulus"
        found = {"bulk_modulus": Prior(beta / 5, 1.5 * beta, beta, "log", "Pa", air)}
        if c:
            unit, loss = usual["damping"].unit, "engineering judgement: leakage differs tenfold"
            found["damping"] = Prior(c / 10, 10 * c, c, "log", unit, loss)
        return found

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From a small to a large actuator; areas of cylinders are of the same size as volumes per radian."""
        bulk = "handbooks: 1.4 to 1.8e9 Pa of mineral oil without air, down to a third with air and hoses"
        size = "catalogues: bores of 40 to 200 mm, rods of half the bore; vane motors of 1e-4 to 1e-2 m3/rad"
        hoses = "engineering judgement: 1 to 10 m of hose, bore of 10 to 25 mm"
        travel = "catalogues: rotary actuators of 90 to 280 degrees, cylinders of 0.2 to 2 m"
        ends = "engineering judgement: coordinates count from near the retracted end"
        loss = "engineering judgement: 0.1 to 10 % of critical for an arm that swings at a few Hz"
        return {
            "bulk_modulus": Prior(4e8, 1.8e9, 1.2e9, "log", "Pa", bulk),
            "piston_area": Prior(1e-4, 3e-2, 1e-3, "log", "m3/rad", size),
            "ring_area": Prior(1e-4, 2e-2, 7e-4, "log", "m3/rad", size),
            "dead_volume": Prior(5e-5, 5e-3, 1e-3, "log", "m3", hoses),
            "stroke": Prior(0.2, 5.0, 3.0, "log", "rad", travel),
            "retracted": Prior(-3.0, 1.0, -1.5, "linear", "rad", ends),
            "damping": Prior(20.0, 2e4, 400.0, "log", "N m s/rad", loss),
        }
