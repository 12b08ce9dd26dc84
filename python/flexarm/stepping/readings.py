"""Readings of a state."""

from __future__ import annotations

from typing import NamedTuple

from flexarm.arrays import Floats


class JointReading(NamedTuple):
    """A joint at an instant.

    Attributes
    ----------
    angle, rate : float
        theta of the link about the joint [rad, m if prismatic], and its rate.
    drive_angle, drive_rate : float
        phi of the motor over the ratio, and its rate.
    torque, motor_torque : float
        On the child about +axis; of the motor with rotor inertia and friction; output side [N m].
    """

    angle: float
    rate: float
    drive_angle: float
    drive_rate: float
    torque: float
    motor_torque: float


class PointReading(NamedTuple):
    """A point at an instant.

    Attributes
    ----------
    position, velocity, acceleration : ndarray, shape (3,)
        Base axes [m], [m/s], [m/s2].
    rotation : ndarray, shape (3, 3)
        Body axes as columns, base axes.
    angular_rate : ndarray, shape (3,)
        Body axes [rad/s].
    """

    position: Floats
    velocity: Floats
    acceleration: Floats
    rotation: Floats
    angular_rate: Floats
