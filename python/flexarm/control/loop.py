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
from flexarm.errors import InvalidParameter
from flexarm.wording import listed


class ControlLoop:
    """Sensors, law and motor of one joint.

    `controller` gives the controller at a time [s], and `holding_torque` is what holds the arm at the start,
    output-referred [N m; N if prismatic].
    """

    def __init__(
        self,
        controller: Callable[[float], Controller],
        sensing: Sensing,
        actuator: Actuator,
        holding_torque: Real,
    ) -> None:
        self.joint = sensing.joint
        self._controller_at = controller
        self._sensing = sensing
        self._actuator = actuator
        self._law = CascadeLaw(holding_torque)

    @classmethod
    def of(
        cls,
        arm: Arm,
        controller: Controller,
        holding: Floats,
        schedule: Callable[[float], Controller] | None = None,
    ) -> ControlLoop:
        """Return the loop of a model's controller, or of one whose gains change in the run.

        `holding` are the torques that hold the arm at the start, shape (joints,) [N m; N if prismatic].
        """
        sensing = Sensing(arm, controller)
        at = _gains_only(controller, schedule) if schedule else lambda time: controller
        return cls(at, sensing, actuator_of(arm, controller), float(holding[sensing.joint]))

    def sample(self, plant: Plant, command: Real) -> tuple[Real, Real]:
        """Read the sensors, update the law, and return the voltage [V] and torque to hold.

        The torque is in N m, of slides in N. Raise InvalidParameter if a schedule changes more than gains.
        """
        controller, reading = self._controller_at(plant.time), self._sensing.read(plant)
        rate = plant.rate(self.joint, output=False)  # back-EMF is that of the rotor, whatever sensors show
        if not isinstance(controller, Cascade):
            return self._actuator.hold(feedback_voltage(controller, command, reading), rate)
        wanted = self._law.torque(controller, command, reading)
        voltage, torque = self._actuator.hold(wanted, rate)
        self._law.settle(limited=torque != wanted)
        return voltage, torque


def _gains_only(own: Controller, at: Callable[[float], Controller]) -> Callable[[float], Controller]:
    """Return a schedule that is refused where it changes more than the gains of a model's controller."""
    fixed = ("type", "joint", "deflection", "sample_time", "torque_limit")

    def controller(time: float) -> Controller:
        scheduled = at(time)
        changed = [name for name in fixed if getattr(scheduled, name, None) != getattr(own, name, None)]
        if changed:
            what = f"changes {listed(changed)} at t = {time:.6g} s; a schedule may change gains only"
            raise InvalidParameter(what, where=f"schedule.{own.joint}")
        return scheduled

    return controller
