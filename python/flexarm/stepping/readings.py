"""Readings of a state."""

from __future__ import annotations

from typing import NamedTuple

from flexarm.arrays import Floats


class JointReading(NamedTuple):
    """A joint at an instant."""

    angle: float
    rate: float
    """Angle theta of the link about the joint [rad], and its rate [rad/s]; [m], [m/s] if prismatic."""
    drive_angle: float
    drive_rate: float
    """Angle phi of the motor over the gear ratio, and its rate, in the same units."""
    torque: float
    motor_torque: float
    """On the child about +axis, and of the motor with rotor inertia and friction; output-referred [N m; N if
    prismatic]."""


class PointReading(NamedTuple):
    """A point at an instant."""

    position: Floats
    velocity: Floats
    acceleration: Floats
    """Base axes [m], [m/s], [m/s2], shape (3,)."""
    rotation: Floats
    """Body axes as columns, base axes, shape (3, 3)."""
    angular_rate: Floats
    """Body axes [rad/s], shape (3,)."""
