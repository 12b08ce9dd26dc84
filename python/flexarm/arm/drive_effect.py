"""Effects on how joints follow their drives: they change the motion of the motor, not the arm or a sensor.

`flexarm.drive.lag` turns the drive of such a joint into the motion with which the joint follows it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.effect import Effect
from flexarm.arm.joint import coupled_joints

if TYPE_CHECKING:
    from flexarm.arm import Arm


class DriveEffect(Effect):
    """An effect between a joint's drive and the angle that is prescribed."""

    def lag(self) -> tuple[float, float]:
        """Return delay and time constant with which the joint follows [s]."""
        raise NotImplementedError


def lags_between(arm: Arm, joint: str) -> list[DriveEffect]:
    """Return the lags between a joint's drive and its motor: at the joint and at those geared to it."""
    places = coupled_joints([joint], arm.gears)
    return [e for e in arm.effects if isinstance(e, DriveEffect) and e.at in places and any(e.lag())]
