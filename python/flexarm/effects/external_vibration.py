r"""Something shakes the base: a pump, a crane, traffic.

.. math:: M(t) = A \sin(2 \pi f t + p)                                                               (1)

M [N m] is a moment on the compliant base (`base_compliance`) about the axis of the arm's first joint; t is
the time of the run, that of the records. It begins with the run: the equilibrium from which a motion starts
is without it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import hypot, pi
from typing import TYPE_CHECKING, ClassVar

from flexarm.arm.effect import Search, Trial
from flexarm.arm.prior import Prior
from flexarm.arm.wave_effect import WaveEffect
from flexarm.arm.weight import base_axis
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class ExternalVibration(WaveEffect):
    """Harmonic moment on a compliant base.

    `amplitude` is A, `frequency` f and `phase` p of (1).
    """

    name = "external_vibration"
    requires = "base_compliance"
    shape = ("frequency", "phase")
    varies_with = "time"
    band_hz: ClassVar[tuple[float, float]] = (0.3, 15.0)
    """Frequencies that a search looks at; what moves with the drive is slower."""
    amplitude: Number = value_in("N m", "amplitude of the moment", 0.0, ge=0)
    frequency: Number = value_in("Hz", "its frequency", 0.0, ge=0)
    phase: Number = value_in("rad", "its phase at t = 0", 0.0)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Refuse a base that does not turn about the axis of the moment."""
        yield from super().problems(arm)
        base = arm.effect("base_compliance", self.at)
        if base is not None and len(getattr(base, "stiffnesses", ())) == 2:
            x, y, _ = base_axis(arm)
            if not hypot(x, y) > 0:
                yield (
                    "at",
                    "shakes the base about the axis of the first joint, about which a base_compliance with "
                    "two stiffnesses does not turn; give it one",
                )

    def patch(self, machine: Machine) -> None:
        """Add a moment, eq. (1)."""
        machine.base.vibration = (self.amplitude, self.frequency, self.phase)  # eq. (1)

    def trials(self, search: Search) -> Iterator[Trial]:
        """Yield the frequencies at which the gap swings to start from."""
        yield from (Trial(start={"frequency": frequency}) for frequency in search.frequencies)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Machines and people nearby."""
        size = "engineering judgement: from hardly seen on a stiff base to a shaker's"
        speed = "engineering judgement: floors swing at 2 to 10 Hz, machines turn at up to 50"
        return {
            "amplitude": Prior(0.5, 200.0, 10.0, "log", "N m", size),
            "frequency": Prior(0.5, 60.0, 8.0, "log", "Hz", speed),
            "phase": Prior(-pi, pi, 0.0, "uniform", "rad", "any phase is as likely"),
        }
