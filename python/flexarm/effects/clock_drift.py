r"""Drift of a clock: it runs faster or slower than true time.

.. math:: \text{stamp} = t + \text{rate} \, (t - t_0) = t \, (1 + \text{rate}) + \text{constant}     (1)

t_0 is the start of the run, where the clock is right but for its delay.
"""

from __future__ import annotations

from flexarm.arm.arm import Arm
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import ClockEffect
from flexarm.tables import Number, value_in


class ClockDrift(ClockEffect):
    """Drift of the stamps of a signal or of a clock.

    `rate` is that of (1); positive where the clock is fast.
    """

    name = "clock_drift"
    varies_with = "time"
    rate: Number = value_in("s/s", "how much faster the clock runs", 0.0, gt=-0.5, lt=0.5)

    def late(self) -> tuple[float, float]:
        """Eq. (1)."""
        return 0.0, self.rate

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of two quartz clocks that nothing synchronises."""
        source = "data sheets of quartz oscillators without compensation: +-20 to +-100 ppm each"
        return {"rate": Prior(-1e-4, 1e-4, 0.0, "linear", "s/s", source)}
