r"""Mass of a payload that is not the nominal one.

.. math:: m \leftarrow \text{mass}                                                                   (1)

The total [kg], not a correction; inertia about the payload's own centre stays. What a record says it weighed
takes precedence.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.effect import Effect
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class PayloadMass(Effect):
    """Another mass of a payload.

    Left out: the nominal mass.
    """

    name = "payload_mass"
    stated_by_records = True
    may_vanish = True
    varies_with = "torque"
    mass: Number | None = value_in("kg", "total mass of the payload", None, ge=0)

    def patch(self, machine: Machine) -> None:
        """Another mass, eq. (1)."""
        load = machine.payloads[self.at]
        load.mass = load.mass if self.mass is None else self.mass  # eq. (1)

    def null(self, arm: Arm) -> dict[str, float]:
        """Return the nominal mass."""
        return {"mass": arm.payload(self.at).mass or 0.0}

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """About the nominal mass."""
        nominal = arm.payload(self.at).mass or 1.0
        source = "engineering judgement: stated payloads leave out adapters and cables, or guess the load"
        return {"mass": Prior(0.75 * nominal, 1.35 * nominal, nominal, "log", "kg", source)}
