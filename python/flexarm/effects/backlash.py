r"""Backlash of a reducer: a gap in which its teeth touch neither flank.

.. math:: e = d - b/2 \; (d > b/2), \quad d + b/2 \; (d < -b/2), \quad 0 \text{ in between}            (1)

d [rad] is the deflection of the reducer, and its spring acts on e: T = k e + k_3 e^3 + c \dot d with k and c
of the joint's `joint_compliance`, which it needs. Inside the gap the damping fades within 2e-5 rad to a
hundredth, and a 1e-4 part of the stiffness is left, so that a joint without torque rests in the middle of its
gap. At rest the teeth lie on the flank that the torque pushes them against.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.effect import Derivative, Effect
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class Backlash(Effect):
    """A gap between motor and link.

    `gap` is b of (1).
    """

    name = "backlash"
    requires = "joint_compliance"
    smooth = False
    one_signed = True
    non_negative = ("gap",)
    multistart = "gap"
    varies_with = "torque"
    gap: Number = value_in("rad", "full width of the gap at the output", 0.0, ge=0)

    def patch(self, machine: Machine) -> None:
        """Open a gap in the reducer's spring, eq. (1)."""
        machine.drive_trains[self.at].gap = self.gap  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From a preloaded reducer to a worn slewing drive."""
        source = (
            "catalogues: lost motion below 1 arc minute of cycloidal reducers, backlash of 1 to 6 of "
            "planetary ones, 0.1 degrees and more of slewing drives"
        )
        return {"gap": Prior(3e-5, 5e-3, 4e-4, "log", "rad", source)}

    def derivative(self, parameter: str) -> Derivative:
        """One-sided at zero, where a gap can only open."""
        return "smooth" if self.gap > 0 else "one-sided"
