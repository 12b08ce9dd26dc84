r"""From a controller's output to the torque on the rotor, equation (1) of `flexarm.arm.motor`.

A voltage u held over a sample does not hold the torque: with the rate φ' it falls,

    T = a u - c φ',     a = η k_m n/R,     c = η k_m² n²/R        output-referred                     (1)

c is a viscous friction of the rotor, so the integrator carries it exactly and only a u is held. Where the
torque is limited, a u is set so that T meets the limit at the sample's φ'.
"""

from __future__ import annotations

from math import inf

from flexarm.arm.controller import Controller
from flexarm.arm.joint import Joint
from flexarm.arm.motor import Motor


class VoltageDrive:
    """A motor on a voltage, eq. (1).

    Attributes
    ----------
    torque_per_volt, back_emf : float
        a [N m/V] and c [N m s/rad].
    """

    def __init__(self, motor: Motor, joint: Joint) -> None:
        constant = motor.torque_constant * joint.gear_ratio
        self.torque_per_volt = motor.efficiency * constant / motor.resistance
        self._greatest_voltage = motor.voltage_limit or inf
        self._greatest_torque = (motor.torque_limit or inf) * abs(joint.gear_ratio)
        self.back_emf = self.torque_per_volt * constant

    def hold(self, voltage: float, rate: float) -> tuple[float, float]:
        """Voltage after its limit [V] and the torque a u to hold [N m]."""
        u = _limited(voltage, self._greatest_voltage)
        loss = self.back_emf * rate
        return u, _limited(self.torque_per_volt * u - loss, self._greatest_torque) + loss  # eq. (1)


class TorqueDrive:
    """A motor on a current loop much faster than a sample: it gives the torque that is asked for.

    Without a motor in the model only the controller's own limit is known.
    """

    back_emf = 0.0

    def __init__(self, controller: Controller, motor: Motor | None, joint: Joint) -> None:
        own = getattr(controller, "torque_limit", None) or inf
        of_motor = (motor.torque_limit or inf) * abs(joint.gear_ratio) if motor else inf
        self._greatest_torque = min(own, of_motor)
        self._voltage = VoltageDrive(motor, joint) if motor else None
        self._greatest_voltage = (motor.voltage_limit or inf) if motor else inf

    def hold(self, torque: float, rate: float) -> tuple[float, float]:
        """Voltage that it takes [V], NaN without a motor, and the torque to hold [N m]."""
        held = _limited(torque, self._greatest_torque)
        if self._voltage is None:
            return float("nan"), held
        loss, gain = self._voltage.back_emf * rate, self._voltage.torque_per_volt
        wanted = (held + loss) / gain
        u = _limited(wanted, self._greatest_voltage)
        return u, held if u == wanted else gain * u - loss


def _limited(value: float, greatest: float) -> float:
    return max(-greatest, min(greatest, value))
