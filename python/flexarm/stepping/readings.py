"""Readings of a state."""

from __future__ import annotations

from typing import NamedTuple

from flexarm.arrays import Floats


class JointReading(NamedTuple):
    """A joint at an instant."""

    angle: float
    rate: float
    """theta of the link about the joint [rad, m if prismatic], and its rate."""
    drive_angle: float
    drive_rate: float
    """phi of the motor over the ratio, and its rate."""
    torque: float
    motor_torque: float
    """On the child about +axis; of the motor with rotor inertia and friction; output side [N m]."""


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
