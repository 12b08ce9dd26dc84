r"""Hysteresis of a joint: rate-independent friction inside the reducer, beside its spring.

.. math:: T \leftarrow T + T_h z, \qquad \dot z = (1 - z \operatorname{sgn}\dot d)\,\dot d / w          (1)

d [rad] is the deflection of the reducer (Dahl's law), z = 0 at the equilibrium from which the motion starts.
A cycle of the deflection between -a and a, a much larger than w, takes 4 T_h (a - w). Needs a
`joint_compliance` at the same joint.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar

from flexarm.arm.effect import Effect
from flexarm.arm.prior import Prior
from flexarm.effects.joint_compliance import without_spring
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class JointHysteresis(Effect):
    """Dahl's law in the deflection of the reducer.

    Parameters
    ----------
    at : str
        The joint; it has a joint_compliance.
    torque : float
        T_h of (1) [N m]; N for a prismatic joint.
    width : float
        w of (1) [rad]: deflection over which the friction builds up.
    """

    name: ClassVar[str] = "joint_hysteresis"
    torque: Number = value_in("N m", "torque at which the hysteresis saturates", 0.0, ge=0)
    width: Number = value_in("rad", "deflection over which it builds up", 3e-4, gt=0)

    def patch(self, machine: Machine) -> None:
        """Puts Dahl's law beside the reducer's spring, eq. (1)."""
        machine.drive_trains[self.at].hysteresis.append((self.torque, self.width))  # eq. (1)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """A rigid reducer has no deflection to be hysteretic in."""
        yield from without_spring(self, arm)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Loss of a few percent of the rated torque over some arc minutes."""
        return {
            "torque": Prior(
                1.0,
                300.0,
                20.0,
                "log",
                "N m",
                "catalogues of strain-wave and cycloidal reducers: loss at 2 to 10 % of rated torque",
            ),
            "width": Prior(
                3e-5,
                2e-3,
                3e-4,
                "log",
                "rad",
                "catalogues of strain-wave and cycloidal reducers: hysteresis loss of 0.5 to 3 arc minutes",
            ),
        }
