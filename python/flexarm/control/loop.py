"""The loop of one joint: its sensors, its control law and its motor, from sample to sample."""

from __future__ import annotations

from collections.abc import Callable

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.controller import Cascade, Controller
from flexarm.control.actuator import TorqueDrive, VoltageDrive
from flexarm.control.laws import CascadeLaw, feedback_voltage
from flexarm.control.sensing import Sensing
from flexarm.drive import JointDrive


class Loop:
    """Sensors, law and motor of one joint.

    Parameters
    ----------
    arm : Arm
        The model.
    controller : Controller
        Of the joint.
    command : JointDrive
        What it follows.
    holding : float
        Torque that holds the arm at the start, output-referred [N m].
    schedule : callable, optional
        The controller at a time [s], where its gains change in the run.
    """

    def __init__(
        self,
        arm: Arm,
        controller: Controller,
        command: JointDrive,
        holding: float,
        schedule: Callable[[float], Controller] | None = None,
    ) -> None:
        joint = arm.joint(controller.joint)
        motor = next((motor for motor in arm.motors if motor.joint == joint.name), None)
        self.joint = [entry.name for entry in arm.joints].index(joint.name)
        self.command = command
        self._at = schedule or (lambda time: controller)
        self._sensing = Sensing(arm, controller)
        self._law = CascadeLaw(holding)
        if isinstance(controller, Cascade) or motor is None:
            self.actuator: TorqueDrive | VoltageDrive = TorqueDrive(controller, motor, joint)
        else:
            self.actuator = VoltageDrive(motor, joint)

    def sample(self, run: _core.SampledRun, command: float) -> tuple[float, float]:
        """Voltage [V] and torque to hold [N m] of this sample."""
        controller, reading = self._at(run.time), self._sensing.read(run)
        if not isinstance(controller, Cascade):
            return self.actuator.hold(feedback_voltage(controller, command, reading), reading.rate)
        wanted = self._law.torque(controller, command, reading)
        voltage, torque = self.actuator.hold(wanted, reading.rate)
        self._law.settle(limited=torque != wanted)
        return voltage, torque
