r"""The deflection that a controller reads, thousands of times a run: what does not change is computed once.

With the joints at q the undeformed link stands at [Brockett1984]

.. math:: H(q) = \prod_k S_k(q_k) \, H(0)                                                            (1)

S_k turns about (or shifts along) the line on which the joint's axis lies at q = 0, in the base. A point p of
the deformed link is off its place r in the link's frame by

.. math:: d = R^T (p - x) - r, \qquad H = (R, x)                                                     (2)

which is equation (2) of `flexarm.measurement.deformation`.

References
----------
.. [Brockett1984] R. W. Brockett, "Robotic manipulators and the product of exponentials formula",
   Mathematical Theory of Networks and Systems, 1984.
"""

from __future__ import annotations

from math import cos, sin
from typing import Any

import numpy as np

from flexarm.arm.names import link_of
from flexarm.arrays import Floats
from flexarm.measurement.deformation import gauged
from flexarm.measurement.kinematics import chain_to, joint_frame, link_pose
from flexarm.measurement.sampling import columns

IDENTITY = np.eye(3)


class _Line:
    """The line on which a joint's axis lies at q = 0."""

    def __init__(self, axis: Floats, origin: Floats) -> None:
        self.axis, self.origin = axis, origin
        x, y, z = axis
        self._cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        self._twice = self._cross @ self._cross

    def turn(self, angle: float) -> Floats:
        """Rotation about the axis, by Rodrigues' formula 1 + sin q K + (1 - cos q) K^2."""
        found: Floats = IDENTITY + sin(angle) * self._cross + (1.0 - cos(angle)) * self._twice
        return found


class DeflectionGauge:
    """A sensor of deflection with one axis.

    Parameters
    ----------
    model : Arm
        The model, with its effects.
    sensor : Sensor
        Names the point and the axis.

    Raises
    ------
    CannotMeasure
        If the frame of the undeformed link is not known from joint angles alone.
    """

    def __init__(self, model: Any, sensor: Any) -> None:
        arm, point, base = gauged(model, sensor)
        self.point = [each.name for each in arm.points].index(point.name)
        self._axis = columns(sensor.axes)[0]
        link = link_pose(arm, link_of(point.link), {}, base)
        rigid = link_pose(arm, point.link, {}, base).of_point(np.asarray(point.position))
        self._R, self._x = link.R[0], link.x[0]
        self._r = self._R.T @ (rigid[0] - self._x)
        names = [joint.name for joint in arm.joints]
        self._lines: list[tuple[int, bool, _Line]] = []
        for joint in chain_to(arm, point.link):
            if joint.type != "fixed":
                frame = joint_frame(arm, joint, link_pose(arm, joint.parent, {}, base))
                axis = frame.R[0] @ np.asarray(joint.axis) / np.linalg.norm(joint.axis)
                self._lines.append(
                    (names.index(joint.name), joint.type == "prismatic", _Line(axis, frame.x[0]))
                )

    def read(self, position: Floats, angles: Floats) -> float:
        """Deflection [m] of the point at `position` [m], joints at `angles` [rad, m]."""
        R, x = self._R, self._x
        for joint, slides, line in reversed(self._lines):  # eq. (1)
            if slides:
                x = x + angles[joint] * line.axis
            else:
                turn = line.turn(float(angles[joint]))
                R, x = turn @ R, line.origin + turn @ (x - line.origin)
        return float((R.T @ (position - x) - self._r)[self._axis])  # eq. (2)
