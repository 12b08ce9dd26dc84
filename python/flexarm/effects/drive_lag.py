r"""Lag of a drive: the joint follows late, and as a filter of first order does.

.. math:: \tau \dot\varphi(t) + \varphi(t) = u(t - D)                                                (1)

u [rad] is the drive, that of the record or of the run, \varphi what the motor does. Before the drive begins
the joint rests at its first value. To first order a slow motion tells only D + \tau, which is what stamps of
all other signals that are as late would do; a time constant shows where the drive accelerates. It acts where
an angle or a command is prescribed; a joint with a controller has that one's lag. Statics, modes and linear
models do not know it, and steppers refuse it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from flexarm.arm.arm import Arm
from flexarm.arm.drive_effect import DriveEffect
from flexarm.arm.effect import Probes
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in


class DriveLag(DriveEffect):
    """First-order lag and delay between a drive and its joint.

    `delay` is D and `time_constant` tau of (1).
    """

    name = "drive_lag"
    driven_joints_only = True
    sought_of_commands = ("delay",)
    in_motion = ("delay", "time_constant")
    non_negative = ("delay", "time_constant")
    one_signed = True
    varies_with = "rate"
    delay: Number = value_in("s", "how late the joint begins to follow", 0.0, ge=0)
    time_constant: Number = value_in("s", "time constant with which it follows", 0.0, ge=0)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Refuse a joint that follows through a controller."""
        if any(controller.joint == self.at for controller in arm.controllers):
            yield "at", f"{self.at!r} follows its command through a controller of the model, whose lag counts"

    def lag(self) -> tuple[float, float]:
        """Return D and tau of (1)."""
        return self.delay, self.time_constant

    def sized(self, multiples: Sequence[float], probed: Probes) -> dict[str, float]:
        """Return start values; split the total lag equally where a multiple is negative.

        To first order only the sum of delay and time constant is seen.
        """
        found = super().sized(multiples, probed)
        if len(found) < 2 or min(multiples) >= 0:
            return found
        late = sum(
            times * (probe.value_of(key) - probed.null[key])
            for times, probe in zip(multiples, probed.effects, strict=True)
            for key in found
        )
        null, least = probed.null, probed.least
        return {key: max(null[key] + late / len(found), least * self.value_of(key)) for key in found}

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From a quick servo to a slow hydraulic drive on a field bus."""
        late = "engineering judgement: a cycle of a field bus (1 ms) to a slow interface (0.2 s)"
        lag = "engineering judgement: position loops of 1 to 100 Hz bandwidth lag by 1/(2 pi f) = 2 to 160 ms"
        return {
            "delay": Prior(1e-3, 0.2, 0.015, "log", "s", late),
            "time_constant": Prior(1e-3, 0.2, 0.015, "log", "s", lag),
        }
