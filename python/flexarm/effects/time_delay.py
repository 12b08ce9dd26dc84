r"""Delay of stamps: they are later than the instants at which values were taken.

.. math:: \text{stamp} = t + \text{delay}                                                            (1)

At a clock it delays all signals of the clock, and adds to a delay at one of them.
"""

from __future__ import annotations

from flexarm.arm.arm import Arm
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import ClockEffect
from flexarm.tables import Number, value_in


class TimeDelay(ClockEffect):
    """Delay of the stamps of a signal or of a clock.

    The delay is positive where stamps are late.
    """

    name = "time_delay"
    of_commands = True
    varies_with = "rate"
    delay: Number = value_in("s", "how late the stamps are", 0.0)

    def late(self) -> tuple[float, float]:
        """Eq. (1)."""
        return self.delay, 0.0

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From synchronised clocks to stamps given where data arrive."""
        source = (
            "engineering judgement: PTP (IEEE 1588) holds clocks to 1 us, NTP to 1 ms on a local net; stamps "
            "given where data arrive are 1 to 50 ms late"
        )
        return {"delay": Prior(-0.02, 0.05, 0.0, "linear", "s", source)}

    @classmethod
    def command_priors(cls) -> dict[str, Prior]:
        """Return how late a command acts: its stamp is early, the mirror image of the stamps of a sensor."""
        source = "engineering judgement: a command acts where it arrives, 1 to 50 ms after it was given"
        return {"delay": Prior(-0.05, 0.02, 0.0, "linear", "s", source)}
