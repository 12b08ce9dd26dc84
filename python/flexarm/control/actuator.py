r"""From a controller's output to the torque on the rotor, equation (1) of `flexarm.arm.motor`.

A voltage u held over a sample does not hold the torque: with the rate φ' it falls,

    T = a u - c φ',     a = η k_m n/R,     c = η k_m² n²/R        output-referred                     (1)

c is a viscous friction of the rotor, so the integrator carries it exactly and only a u is held. Where the
torque is limited, a u is set so that T meets the limit at the rotor's φ' at the sample. Numbers of motors may
carry their derivatives (`flexarm.control.dual`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from math import inf
from typing import ClassVar, TypeVar

from flexarm.arm import Arm
from flexarm.arm.controller import Cascade, Controller
from flexarm.arm.joint import motor_ratio
from flexarm.arm.motor import Motor
from flexarm.control.dual import Real, between


@dataclass(frozen=True)
class VoltageDrive:
    """A motor on a voltage, eq. (1)."""

    torque_per_volt: Real
    back_emf: Real
    """a [N m/V] and c [N m s/rad]."""
    greatest_voltage: Real
    greatest_torque: Real
    """[V] and, output-referred, [N m]."""

    @classmethod
    def of(cls, motor: Motor, ratio: float) -> VoltageDrive:
        """Return the drive of a motor of a ratio."""
        constant = motor.torque_constant * ratio
        torque_per_volt = motor.efficiency * constant / motor.resistance
        return cls(
            torque_per_volt,
            torque_per_volt * constant,
            motor.voltage_limit or inf,
            (motor.torque_limit or inf) * abs(ratio),
        )

    def hold(self, voltage: Real, rate: Real) -> tuple[Real, Real]:
        """Return the voltage after its limit [V] and the torque a u to hold [N m]."""
        u = _limited(voltage, self.greatest_voltage)
        loss = self.back_emf * rate
        return u, _limited(self.torque_per_volt * u - loss, self.greatest_torque) + loss  # eq. (1)


@dataclass(frozen=True)
class TorqueDrive:
    """A motor on a current loop much faster than a sample: it gives the torque that is asked for."""

    greatest_torque: Real
    """Of controller and motor, output-referred [N m]."""
    motor: VoltageDrive | None = None
    """Without a motor in the model no voltage is known."""
    back_emf: ClassVar[float] = 0.0

    @classmethod
    def of(cls, controller: Controller, motor: Motor | None, ratio: float) -> TorqueDrive:
        """Return the drive of a motor of a ratio, if the model has one, and its controller's limit."""
        own = getattr(controller, "torque_limit", None) or inf
        if motor is None:
            return cls(own)
        drive = VoltageDrive.of(motor, ratio)
        return cls(min(own, drive.greatest_torque), drive)

    def hold(self, torque: Real, rate: Real) -> tuple[Real, Real]:
        """Return the voltage that it takes [V], NaN without a motor, and the torque to hold [N m]."""
        held = _limited(torque, self.greatest_torque)
        if self.motor is None:
            return float("nan"), held
        loss, gain = self.motor.back_emf * rate, self.motor.torque_per_volt
        wanted = (held + loss) / gain
        u = _limited(wanted, self.motor.greatest_voltage)
        return u, held if u == wanted else gain * u - loss


Actuator = VoltageDrive | TorqueDrive
_A = TypeVar("_A", bound=Actuator)


def actuator_of(arm: Arm, controller: Controller) -> Actuator:
    """Return the drive of the joint of a controller."""
    ratio = motor_ratio(arm, controller.joint)
    motor = next((motor for motor in arm.motors if motor.joint == controller.joint), None)
    if isinstance(controller, Cascade) or motor is None:
        return TorqueDrive.of(controller, motor, ratio)
    return VoltageDrive.of(motor, ratio)


def differentiated(drive: _A, pairs: Sequence[tuple[_A, _A]], spreads: Sequence[float]) -> _A:
    """Return a drive with the derivatives of its numbers, as `flexarm.control.dual.between` takes pairs."""
    numbers: dict[str, Real | VoltageDrive] = {}
    for field in fields(drive):
        value = getattr(drive, field.name)
        perturbed = [(getattr(plus, field.name), getattr(minus, field.name)) for plus, minus in pairs]
        if isinstance(value, VoltageDrive):
            numbers[field.name] = differentiated(value, perturbed, spreads)
        elif value is not None:
            numbers[field.name] = between(value, perturbed, spreads)
    return replace(drive, **numbers)  # type: ignore[arg-type]


def _limited(value: Real, greatest: Real) -> Real:
    return max(-greatest, min(greatest, value))
