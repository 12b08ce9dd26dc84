"""StateSnapshots of an arm one by one, each an instant of its own, as sensors read them."""

from __future__ import annotations

from dataclasses import dataclass

from flexarm.arm import Arm
from flexarm.arrays import Floats


@dataclass(frozen=True, eq=False)
class StateSnapshots:
    """What measurements take from a `Simulation`; the first axis is the state.

    Attributes
    ----------
    arm : Arm
        The model.
    time : ndarray, shape (n,)
        Numbers of the states: 0, 1, 2, ...
    position, velocity, angular_rate, acceleration : ndarray, shape (n, point, 3)
        Of the points: base axes [m], [m/s]; body axes: rate [rad/s] and specific force [m/s2].
    orientation : ndarray, shape (n, point, 4)
        Quaternion x, y, z, w.
    joint_angle, joint_rate, drive_angle, drive_rate, motor_torque : ndarray, shape (n, joint)
        As in `Simulation`.
    section_forces : ndarray, shape (n, link, 2, 6)
        As in `Simulation`.
    """

    arm: Arm
    time: Floats
    position: Floats
    velocity: Floats
    orientation: Floats
    angular_rate: Floats
    acceleration: Floats
    joint_angle: Floats
    joint_rate: Floats
    drive_angle: Floats
    drive_rate: Floats
    motor_torque: Floats
    section_forces: Floats

    @property
    def points(self) -> tuple[str, ...]:
        """Names of the points, in the order of the arrays."""
        return tuple(point.name for point in self.arm.points)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, in the order of the arrays."""
        return tuple(joint.name for joint in self.arm.joints)
