"""StateSnapshots of an arm looked at one by one, as sensors see a run.

Sensors read a simulation at their instants; here every state is an instant of its own, 0, 1, 2 ..., and the
acceleration of points comes from the states themselves instead of the derivative of their velocities.
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
from flexarm.measurement.states import StateSnapshots


@dataclass(frozen=True, eq=False)
class SystemSnapshots(StateSnapshots):
    """StateSnapshots of an assembled system."""

    @classmethod
    def of(cls, arm: Arm, system: _core.System, states: Sequence[_core.State]) -> SystemSnapshots:
        """The states of a system assembled from the arm."""
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
        """What the sensor reads of each state, without noise, rounding or delay: shape (n, channels)."""
        return read(self, sensor, self.time)


def _in_body(orientation: Floats, vectors: Floats) -> Floats:
    """Vectors in base axes, in the axes that quaternions (x, y, z, w) turn the base's into."""
    axis, w = -orientation[..., :3], orientation[..., 3:]
    twice = 2 * np.cross(axis, vectors)
    turned: Floats = vectors + w * twice + np.cross(axis, twice)
    return turned
