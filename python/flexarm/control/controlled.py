"""An arm whose joints follow commands: its system in the core, and the start of its run.

Until the start the motors hold the arm at rest where their encoders show the first command.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import isnan

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.controller import Controller
from flexarm.assembly import assemble, joint_values
from flexarm.control.actuator import actuator_of
from flexarm.control.back_emf import with_losses
from flexarm.control.dual import value_of
from flexarm.control.sensing import Sensing
from flexarm.drive import Drive
from flexarm.drive.lag import as_followed
from flexarm.errors import InvalidParameter
from flexarm.simulation.prepared import motions


@dataclass(frozen=True)
class ControlledArm:
    """An arm, its drive, and the controllers of its commanded joints."""

    arm: Arm
    drive: Drive
    """Of all driven joints."""
    controllers: Mapping[str, Controller]
    """By the name of the joint."""

    @classmethod
    def of(cls, arm: Arm, drive: Drive) -> ControlledArm:
        """Return the arm with its own controllers.

        Raise InvalidParameter if a commanded joint has none.
        """
        known = {controller.joint: controller for controller in arm.controllers}
        found = {}
        for name, joint in drive.joints.items():
            if joint.side == "torque":
                raise InvalidParameter("a torque and a command in one run are not supported", where=name)
            if joint.side != "command":
                continue
            if name not in known:
                raise InvalidParameter(
                    f"joint {name!r} is moved by a command, but has no controller; controllers exist for "
                    f"{', '.join(known) or 'no joint'}",
                    where="controllers",
                )
            found[name] = known[name]
        return cls(arm, drive, found)

    @cached_property
    def losses(self) -> dict[str, float]:
        """Back-EMF of each commanded joint as friction [N m s/rad]; zero under a current loop."""
        return {name: value_of(actuator_of(self.arm, c).back_emf) for name, c in self.controllers.items()}

    @cached_property
    def system(self) -> _core.System:
        """The arm with commanded motors let go."""
        return self._assembled({name: joint.kind for name, joint in self.drive.joints.items()})

    @cached_property
    def held(self) -> _core.System:
        """The arm with commanded motors held."""
        return self._assembled(
            {
                name: _core.DriveKind.motor_angle if name in self.controllers else joint.kind
                for name, joint in self.drive.joints.items()
            }
        )

    def _assembled(self, kinds: Mapping[str, _core.DriveKind]) -> _core.System:
        return assemble(with_losses(self.arm, self.losses), kinds, driven=self.drive.rest)

    @property
    def motions(self) -> list[_core.PiecewisePolynomial]:
        """Motions that drive the other joints; commanded ones are not read."""
        others = {name: joint for name, joint in self.drive.joints.items() if name not in self.controllers}
        return motions(self.arm, as_followed(replace(self.drive, joints=others), self.arm))

    def first_values(self, start: float) -> dict[str, float]:
        """Return the positions of driven joints at the start [rad or m]."""
        first = {name: float(joint(start)) for name, joint in self.drive.joints.items()}
        for name, controller in self.controllers.items():
            first[name] = _shown_at(self.arm, controller, first[name])
        return first

    def first_motions(self, start: float) -> list[_core.PiecewisePolynomial]:
        """Return constant motions that hold every joint at its first value."""
        first = self.first_values(start)
        return [_core.PiecewisePolynomial.constant(first.get(joint.name, 0.0)) for joint in self.arm.joints]

    def at_rest(self, start: float, system: _core.System | None = None) -> _core.Equilibrium:
        """Return the equilibrium of the held arm, or of another system of it, with these first values."""
        values = joint_values(self.arm, {**self.drive.rest, **self.first_values(start)})
        gravity = _core.Loads(gravity=np.array(self.arm.gravity))
        return _core.static_equilibrium(self.held if system is None else system, values, gravity)


def _shown_at(arm: Arm, controller: Controller, command: float) -> float:
    """Return the angle at which the controller's encoder shows the command."""
    angle = Sensing(arm, controller).true_angle(command)
    if isnan(angle):
        raise InvalidParameter(
            f"the encoder of joint {controller.joint!r} never shows the command {command:g}: an effect on it "
            "hides the angle",
            where=f"controllers.{controller.joint}",
        )
    return angle
