r"""Transmission error of a reducer: its output ripples as the motor turns.

.. math:: \psi = \varphi / s + A \sin(m n \varphi + \beta)                                              (1)

\varphi [rad] is the motor's angle over the nominal ratio n, so n \varphi is the angle of the motor's shaft;
m counts periods per turn of it, \psi is where the teeth put the output, in front of the reducer's spring, and
s the scale of `gear_ratio`. Strain-wave reducers have m = 2. At the output of a [[gears]] n is the ratio of
that gear.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import pi
from typing import TYPE_CHECKING

from flexarm.arm.effect import Search, Trial
from flexarm.arm.prior import Prior
from flexarm.arm.wave_effect import WaveEffect
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class TransmissionError(WaveEffect):
    """A sine of the motor's angle, added to the output of the teeth.

    `amplitude` is A, at the output, `multiple` m and `phase` beta of (1).
    """

    name = "transmission_error"
    driven_joints_only = True
    shape = ("multiple", "phase")
    amplitude: Number = value_in("rad", "amplitude at the output", 0.0)
    multiple: Number = value_in("per motor turn", "periods in a turn of the motor", 1.0)
    phase: Number = value_in("rad", "phase at the motor's angle zero", 0.0)

    def patch(self, machine: Machine) -> None:
        """Lets the teeth ripple, eq. (1)."""
        teeth = machine.drive_trains[self.at].teeth()
        teeth.amplitude, teeth.multiple, teeth.phase = self.amplitude, self.multiple, self.phase  # eq. (1)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Refuse an output that turns back while the motor goes on: A m n < 1."""
        ratio = next(joint.gear_ratio for joint in arm.joints if joint.name == self.at)
        ratio *= next((gear.ratio for gear in arm.gears if gear.output == self.at), 1.0)
        slope = abs(self.amplitude * self.multiple * ratio)
        if slope >= 1:
            yield (
                "amplitude",
                f"must keep amplitude x multiple x gear ratio below 1, got {self.amplitude:g} rad x "
                f"{self.multiple:g} x {ratio:g} = {slope:.3g}: the output would turn back at times",
            )

    def trials(self, search: Search) -> Iterator[Trial]:
        """Yield periods a motor turn: of cycloidal and strain-wave reducers they are small whole numbers."""
        yield from (Trial(fixed={"multiple": float(multiple)}) for multiple in range(1, 5))

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Return priors: an arc minute peak to peak, mostly twice a turn."""
        accuracy = (
            "catalogues of strain-wave and cycloidal reducers: angular transmission accuracy of 0.5 to 2 "
            "arc minutes peak to peak, simpler gears some times that"
        )
        turns = (
            "engineering judgement: twice a turn in strain-wave reducers, once from an eccentric input, "
            "higher harmonics smaller"
        )
        return {
            "amplitude": Prior(1e-5, 6e-4, 1e-4, "log", "rad", accuracy),
            "multiple": Prior(0.5, 6.0, 2.0, "log", "per motor turn", turns),
            "phase": Prior(-pi, pi, 0.0, "uniform", "rad", "nothing is known of it"),
        }
