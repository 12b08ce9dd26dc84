r"""Friction of the motor, referred to the output side.

.. math:: T_f = T_c z + c \, \dot\varphi, \qquad \dot z = (1 - z \operatorname{sgn}\dot\varphi)\,\dot\varphi /
w    (1)

\varphi [rad] is the motor's angle over the ratio; T_f [N m], the motor's own friction torque times the ratio,
opposes \dot\varphi; w = 2e-5 rad as in the output bearing (`coulomb_friction`), and so are other shapes. It
acts on the motor and not on T, the torque on the link: where the motor's angle is imposed it is seen only in
the motor's torque.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Self

from flexarm.arm.effect import Effect
from flexarm.arm.friction_effect import FrictionEffect
from flexarm.arm.motor_limits import back_emf_damping, stall_torque, within
from flexarm.arm.prior import Prior, Priors, Values
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class MotorFriction(FrictionEffect):
    """Dry and viscous friction of the motor.

    `coulomb` is T_c and `viscous` c of (1); the other parameters are the shape of `FrictionEffect`.
    """

    name = "motor_friction"
    torque_at = "motor"
    non_negative = ("coulomb", "viscous")
    coulomb: Number = value_in("N m", "dry friction of the motor, output-referred", 0.0, ge=0)
    viscous: Number = value_in("N m s/rad", "viscous friction of the motor, output-referred", 0.0, ge=0)

    def patch(self, machine: Machine) -> None:
        """Dry friction and a damper on the motor's angle, eq. (1)."""
        from flexarm import _core

        machine.drive_trains[self.at].motor += [
            *self.laws(self.coulomb),
            _core.ViscousFriction(self.viscous),
        ]  # eq. (1)

    def probes(
        self, stated: Effect | None, free: Sequence[str], null: Values, priors: Priors
    ) -> Iterator[Self]:
        """Yield dry and viscous friction, each without the other."""
        for key, other in (("coulomb", "viscous"), ("viscous", "coulomb")):
            yield self.with_parameters({key: priors[key].typical, other: 0.0})

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Motor and wave generator or input stage, seen through ratios of 50 to 200."""
        source = "engineering judgement: no-load running torque of geared servo motors at their output"
        dry = Prior(0.5, 200.0, 10.0, "log", "N m", source)
        viscous = Prior(0.2, 300.0, 10.0, "log", "N m s/rad", source)
        return {
            "coulomb": within(stall_torque(arm, self.at), dry),
            "viscous": within(back_emf_damping(arm, self.at), viscous),
            **self.shape_priors(),
        }
