"""The loop of one joint: its sensors, its control law and its motor, from sample to sample."""

from __future__ import annotations

from collections.abc import Callable

from flexarm.arm import Arm
from flexarm.arm.controller import Cascade, Controller
from flexarm.arrays import Floats
from flexarm.control.actuator import Actuator, actuator_of
from flexarm.control.dual import Real
from flexarm.control.laws import CascadeLaw, feedback_voltage
from flexarm.control.plant import Plant
from flexarm.control.sensing import Sensing


class Loop:
    """Sensors, law and motor of one joint.

    `controller` gives the controller at a time [s], and `holding` is the torque that holds the arm at the
    start, output-referred [N m].
    """

    def __init__(
        self, controller: Callable[[float], Controller], sensing: Sensing, actuator: Actuator, holding: Real
    ) -> None:
        self.joint = sensing.joint
        self._at = controller
        self._sensing = sensing
        self._actuator = actuator
        self._law = CascadeLaw(holding)

    @classmethod
    def of(
        cls,
        arm: Arm,
        controller: Controller,
        holding: Floats,
        schedule: Callable[[float], Controller] | None = None,
    ) -> Loop:
        """Return the loop of a model's controller, or of one whose gains change in the run.

        `holding` are the torques that hold the arm at the start, one a joint [N m].
        """
        sensing = Sensing(arm, controller)
        at = schedule or (lambda time: controller)
        return cls(at, sensing, actuator_of(arm, controller), float(holding[sensing.joint]))

    def sample(self, plant: Plant, command: Real) -> tuple[Real, Real]:
        """Return the voltage [V] and torque to hold [N m] of this sample."""
        controller, reading = self._at(plant.time), self._sensing.read(plant)
        if not isinstance(controller, Cascade):
            return self._actuator.hold(feedback_voltage(controller, command, reading), reading.rate)
        wanted = self._law.torque(controller, command, reading)
        voltage, torque = self._actuator.hold(wanted, reading.rate)
        self._law.settle(limited=torque != wanted)
        return voltage, torque
