"""Effects on how joints follow their drives: they change the motion of the motor, not the arm or a sensor.

`flexarm.drive.lag` turns the drive of such a joint into the motion with which the joint follows it.
"""

from __future__ import annotations

from flexarm.arm.effect import Effect


class DriveEffect(Effect):
    """An effect between a joint's drive and the angle that is prescribed."""

    def lag(self) -> tuple[float, float]:
        """Return delay and time constant with which the joint follows [s]."""
        raise NotImplementedError
