"""Laws with corners: beside them predictions have ripples, and small steps say little of large ones."""

from __future__ import annotations

from flexarm.arm import Arm

CORNERS = ("backlash", "coulomb_friction", "joint_hysteresis", "motor_friction")


def has_corners(arm: Arm) -> bool:
    """Whether a model has such a law."""
    return any(effect.name in CORNERS for effect in arm.effects)
