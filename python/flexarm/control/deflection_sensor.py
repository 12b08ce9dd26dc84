r"""The deflection that a controller reads at every sample; constant parts are computed once.

With the joints at q the undeformed link stands at [Brockett1984]

.. math:: H(q) = \prod_k S_k(q_k) \, H(0)                                                            (1)

S_k turns about (or shifts along) the line on which the joint's axis lies at q = 0, in the base. A point p of
the deformed link is off its place r in the link's frame, along an axis e of the link, by

.. math:: d = (R_0 e)^T (H(0) H(q)^{-1} p - x_0) - e^T r, \qquad H(0) = (R_0, x_0)                       (2)

which is equation (2) of `flexarm.measurement.deformation`.

References
----------
.. [Brockett1984] R. W. Brockett, "Robotic manipulators and the product of exponentials formula",
   Mathematical Theory of Networks and Systems, 1984.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from typing import Any

import numpy as np

from flexarm.arm.kinematics import chain_to, joint_frame, link_pose
from flexarm.arm.names import link_of
from flexarm.arrays import Floats
from flexarm.measurement.deformation import rigid_reference
from flexarm.measurement.sampling import columns

Point = tuple[float, float, float]


@dataclass(frozen=True)
class _Line:
    """The line on which a joint's axis lies at q = 0; three floats are faster than an array of three."""

    axis: Point
    origin: Point
    slides: bool

    def back(self, point: Point, q: float) -> Point:
        """Return S(q)^-1 of a point: a shift, or Rodrigues' formula for the angle -q."""
        x, y, z = point
        kx, ky, kz = self.axis
        if self.slides:
            return x - q * kx, y - q * ky, z - q * kz
        ox, oy, oz = self.origin
        x, y, z = x - ox, y - oy, z - oz
        c, s = cos(q), -sin(q)
        along = (1.0 - c) * (kx * x + ky * y + kz * z)
        return (
            ox + c * x + s * (ky * z - kz * y) + along * kx,
            oy + c * y + s * (kz * x - kx * z) + along * ky,
            oz + c * z + s * (kx * y - ky * x) + along * kz,
        )


class DeflectionSensor:
    """A sensor of deflection with one axis, in a model with its effects.

    Raise CannotMeasure if the frame of the undeformed link is not known from joint angles alone.
    """

    def __init__(self, model: Any, sensor: Any) -> None:
        arm, point, base = rigid_reference(model, sensor)
        self.point = [each.name for each in arm.points].index(point.name)
        k = columns(sensor.axes)[0]
        link = link_pose(arm, link_of(point.link), {}, base)
        rigid = link_pose(arm, point.link, {}, base).of_point(np.asarray(point.position))
        axis = link.R[0][:, k]
        self._axis: Point = tuple(axis.tolist())
        self._zero = float(axis @ rigid[0])  # (R_0 e)^T (x_0 + R_0 r)
        names = [joint.name for joint in arm.joints]
        self._lines: list[tuple[int, _Line]] = []
        for joint in chain_to(arm, point.link):
            if joint.type != "fixed":
                frame = joint_frame(arm, joint, link_pose(arm, joint.parent, {}, base))
                along = frame.R[0] @ np.asarray(joint.axis) / np.linalg.norm(joint.axis)
                line = _Line(tuple(along.tolist()), tuple(frame.x[0].tolist()), joint.type == "prismatic")
                self._lines.append((names.index(joint.name), line))

    def read(self, position: Floats, angles: Floats) -> float:
        """Return the deflection [m] of the point at `position` [m], joints at `angles` [rad, m]."""
        point: Point = tuple(position.tolist())
        for joint, line in self._lines:  # eq. (1), the base first
            point = line.back(point, float(angles[joint]))
        x, y, z = self._axis
        return x * point[0] + y * point[1] + z * point[2] - self._zero  # eq. (2)

    def slopes(self, position: Floats, angles: Floats) -> tuple[Floats, Floats]:
        """Return derivatives with respect to the position, shape (3,), and to every joint's angle [m/rad].

        (2) is linear in the position; by angles they are differences, right to 1e-11 of the distance.
        """
        step = 1e-5  # of differences by a joint's angle [rad or m]
        here = self.read(position, angles)
        by_position = np.array([self.read(position + unit, angles) - here for unit in np.eye(3)])
        by_angle = np.zeros(len(angles))
        for joint, _ in self._lines:
            h = np.zeros(len(angles))
            h[joint] = step
            by_angle[joint] = (self.read(position, angles + h) - self.read(position, angles - h)) / (2 * step)
        return by_position, by_angle

    def __eq__(self, other: object) -> bool:
        """Return True if both show the same of every motion."""
        return isinstance(other, DeflectionSensor) and vars(self) == vars(other)

    __hash__ = None  # type: ignore[assignment]
