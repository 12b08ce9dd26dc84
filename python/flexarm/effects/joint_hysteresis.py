r"""Hysteresis of a joint: rate-independent friction inside the reducer, beside its spring.

.. math:: T \leftarrow T + T_h z, \qquad \dot z = (1 - z \operatorname{sgn}\dot d)\,\dot d / w          (1)

d [rad] is the deflection of the reducer (Dahl's law), z = 0 at the equilibrium from which the motion starts.
A cycle of the deflection between -a and a, a much larger than w, takes 4 T_h (a - w). Needs a
`joint_compliance` at the same joint.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from flexarm.arm.effect import Effect, Search, Trial
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class JointHysteresis(Effect):
    """Dahl's law in the deflection of the reducer.

    `torque` is T_h and `width` w of (1).
    """

    name = "joint_hysteresis"
    requires = "joint_compliance"
    in_motion = ("torque", "width")
    smooth = False
    acts_as = "joint_compliance"
    one_signed = True
    non_negative = ("torque",)
    shape = ("width",)
    varies_with = "torque"
    torque: Number = value_in("N m", "torque at which the hysteresis saturates", 0.0, ge=0)
    width: Number = value_in("rad", "deflection over which it builds up", 3e-4, gt=0)

    def patch(self, machine: Machine) -> None:
        """Put Dahl's law beside the reducer's spring, eq. (1)."""
        machine.drive_trains[self.at].hysteresis.append((self.torque, self.width))  # eq. (1)

    def trials(self, search: Search) -> Iterator[Trial]:
        """Yield a narrow and a wide loop to start from."""
        yield from (Trial(start={"width": times * self.width}) for times in (1.0, 4.0))

    def acting_as(
        self, other: Effect, other_stated: Effect | None, stated: Effect | None
    ) -> dict[str, float] | None:
        """Return the loop that is T_h/w stiff while it sticks, for a spring stiffer than the stated one."""
        if other_stated is None or other_stated.inert:
            return None
        stiffer = other.value_of("stiffness") - other_stated.value_of("stiffness")
        return {"torque": stiffer * self.width} if stiffer > 0 else None

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Loss of a few percent of the rated torque over some arc minutes."""
        of = "catalogues of strain-wave and cycloidal reducers:"
        return {
            "torque": Prior(1.0, 300.0, 20.0, "log", "N m", f"{of} loss at 2 to 10 % of rated torque"),
            "width": Prior(3e-5, 2e-3, 3e-4, "log", "rad", f"{of} hysteresis loss of 0.5 to 3 arc minutes"),
        }
