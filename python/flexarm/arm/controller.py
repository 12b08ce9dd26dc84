r"""Controllers: from a command to a torque or a voltage, sampled.

Cascade, a position loop around a PI velocity loop, torque as output (all output-referred):

.. math::
    \dot\varphi_r = K_p (\varphi_c - \varphi), \qquad
    T = K_v \Big(\dot\varphi_r - \dot\varphi + \frac1{T_i}\int (\dot\varphi_r - \dot\varphi)\,dt\Big)   (1)

State feedback, voltage as output, with a deflection d [m] measured at the arm:

.. math:: u = K_1 (\varphi_c - \varphi) - K_3 \dot\varphi - K_2 d - K_4 \dot d                           (2)

\varphi_c is the command and \varphi the motor's angle over the ratio [rad].
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexarm.tables import Inconsistent, Name, Number, Table, value_in


class Cascade(Table):
    """Position loop around a velocity loop, eq. (1).

    `position_gain` is K_p, `velocity_gain` K_v and `integral_time` T_i; left out: no integral part.
    """

    type: Literal["cascade"] = "cascade"
    joint: Name = Field(description="name of the joint that is controlled")
    position_gain: Number = value_in("1/s", "gain of the position loop", gt=0)
    velocity_gain: Number = value_in("N m s/rad", "gain of the velocity loop, output-referred", gt=0)
    integral_time: Number | None = value_in("s", "integral time of the velocity loop", None, gt=0)
    sample_time: Number = value_in("s", "sample time", gt=0)
    torque_limit: Number | None = value_in("N m", "greatest torque, output-referred", None, gt=0)


class StateFeedback(Table):
    """Angle, rate, deflection and its rate, fed back to the motor's voltage, eq. (2).

    The joint needs a motor. `deflection` names the sensor whose reading is d.
    """

    type: Literal["state_feedback"] = "state_feedback"
    joint: Name = Field(description="name of the joint that is controlled")
    position_gain: Number = value_in("V/rad", "gain K1 on the angle's error")
    rate_gain: Number = value_in("V s/rad", "gain K3 on the angle's rate", 0.0)
    deflection: Name | None = None
    deflection_gain: Number = value_in("V/m", "gain K2 on the deflection", 0.0)
    deflection_rate_gain: Number = value_in("V s/m", "gain K4 on the deflection's rate", 0.0)
    sample_time: Number = value_in("s", "sample time", gt=0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.deflection is None and (self.deflection_gain or self.deflection_rate_gain):
            raise Inconsistent((("deflection",), "is missing; deflection_gain needs the name of a sensor"))
        return self


Controller = Annotated[Cascade | StateFeedback, Field(discriminator="type")]
