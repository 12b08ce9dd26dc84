r"""Motors: from voltage to torque, for drives by command.

.. math:: i = (u - k_m n \dot\varphi)/R, \qquad T_m = \eta k_m n i                                  (1)

u [V] is the voltage, i [A] the current, \varphi [rad] the motor's angle over the ratio n, R the resistance,
k_m the torque constant (in SI it is the back-EMF constant too), \eta the efficiency and T_m [N m] the torque
on the rotor, output-referred. A rotor inertia and a ratio stand at the joint, the ratio of a joint behind
gears is that of all before it (`flexarm.arm.joint.motor_ratio`); friction is the effect `motor_friction`.
"""

from __future__ import annotations

from pydantic import Field

from flexarm.tables import Name, Number, Table, value_in


class Motor(Table):
    """The motor of a joint.

    `resistance` is R, `torque_constant` k_m and `efficiency` eta of (1); `voltage_limit` is the greatest |u|.
    """

    joint: Name = Field(description="name of the joint that the motor drives")
    resistance: Number = value_in("ohm", "resistance", gt=0)
    torque_constant: Number = value_in("N m/A", "torque constant, motor side", gt=0)
    efficiency: Number = value_in("-", "efficiency of motor and reducer", 1.0, gt=0, le=1)
    voltage_limit: Number | None = value_in("V", "greatest voltage", None, gt=0)
    torque_limit: Number | None = value_in("N m", "greatest torque, motor side", None, gt=0)
