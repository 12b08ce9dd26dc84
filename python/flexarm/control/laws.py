r"""Control laws at their sample instants t_k = k T_s; equations (1) and (2) of `flexarm.arm.controller`.

Cascade, with e = K_p (φ_c - φ) - φ' and the integral part I in N m:

    T_k = K_v e_k + I_k,     I_{k+1} = I_k + K_v T_s/T_i e_k                                          (1)

I starts at the torque that holds the arm, and rests while T is at its limit. State feedback has no memory.
The laws compute with numbers, or with numbers that carry their derivatives (`flexarm.control.dual`).
"""

from __future__ import annotations

from dataclasses import dataclass

from flexarm.arm.controller import Cascade, StateFeedback
from flexarm.control.dual import Real


@dataclass(frozen=True)
class Reading:
    """The readings of a controller at a sample."""

    angle: Real
    rate: Real
    """φ [rad] and φ' [rad/s], output-referred."""
    deflection: Real = 0.0
    deflection_rate: Real = 0.0
    """d [m] and its rate [m/s]; 0 where none is measured."""


class CascadeLaw:
    """Position loop around a PI velocity loop; its output is a torque.

    `holding_torque` holds the arm at the start, output-referred [N m]; without an integral part it is not
    used.
    """

    def __init__(self, holding_torque: Real) -> None:
        self._integral = holding_torque
        self._step: Real = 0.0

    def torque(self, controller: Cascade, command: Real, reading: Reading) -> Real:
        """Return T of (1) [N m]; `settle` ends the sample."""
        error = controller.position_gain * (command - reading.angle) - reading.rate
        proportional = controller.velocity_gain * error
        if controller.integral_time is None:
            return proportional
        self._step = proportional * controller.sample_time / controller.integral_time
        return proportional + self._integral  # eq. (1)

    def settle(self, limited: bool) -> None:
        """Take the integral part to the next sample, unless the torque is at its limit."""
        if not limited:
            self._integral += self._step  # eq. (1)


def feedback_voltage(controller: StateFeedback, command: Real, reading: Reading) -> Real:
    """Return u = K_1 (φ_c - φ) - K_3 φ' - K_2 d - K_4 d' [V]."""
    return (
        controller.position_gain * (command - reading.angle)
        - controller.rate_gain * reading.rate
        - controller.deflection_gain * reading.deflection
        - controller.deflection_rate_gain * reading.deflection_rate
    )
