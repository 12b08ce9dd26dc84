"""Snapshots of states, as sensors read a run.

Every state is an instant of its own, 0, 1, 2 ... The acceleration of points comes from the states themselves
instead of the derivative of their velocities.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.sensor import Sensor
from flexarm.arrays import Floats
from flexarm.measurement.predict import read
from flexarm.result import OfArm


@dataclass(frozen=True, eq=False)
class StateSnapshots(OfArm):
    """Arrays that measurements take from a `Simulation`; the first axis is the state, 0, 1, 2, ... in `time`.

    Points have position and velocity in base axes [m], [m/s], and in body axes rate [rad/s] and specific
    force [m/s2], (n, point, 3), and a quaternion x, y, z, w, (n, point, 4). Others are as in `Simulation`.
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

    @classmethod
    def of(cls, arm: Arm, system: _core.System, states: Sequence[_core.State]) -> StateSnapshots:
        """Return the snapshots of states of a system assembled from the arm."""
        gravity = np.array(arm.gravity)
        seen = _core.snapshots(system, list(states), _core.Loads(gravity=gravity))
        n, p, run = len(states), len(arm.points), seen.run
        orientation = run.orientation.T.reshape(n, p, 4)
        return cls(
            arm=arm,
            time=np.arange(float(n)),
            position=run.position.T.reshape(n, p, 3),
            velocity=run.velocity.T.reshape(n, p, 3),
            orientation=orientation,
            angular_rate=run.angular_rate.T.reshape(n, p, 3),
            acceleration=_in_body(orientation, seen.acceleration.T.reshape(n, p, 3) - gravity),
            joint_angle=run.joint_angle.T,
            joint_rate=run.joint_rate.T,
            drive_angle=run.drive_angle.T,
            drive_rate=run.drive_rate.T,
            motor_torque=run.motor_torque.T,
            section_forces=run.section_forces.T.reshape(n, len(arm.links), 2, 6),
        )

    def readings(self, sensor: Sensor) -> Floats:
        """Return the sensor's readings without noise, rounding or delay, shape (n, channels)."""
        return read(self, sensor, self.time)


def _in_body(orientation: Floats, vectors: Floats) -> Floats:
    """Return vectors of base axes in the axes of bodies with quaternions (x, y, z, w)."""
    axis, w = -orientation[..., :3], orientation[..., 3:]
    twice = 2 * np.cross(axis, vectors)
    return vectors + w * twice + np.cross(axis, twice)
