r"""Offsets of the tip from the rigid arm, tangential and radial, and their quasi-static part.

tangential  (cos θ, -sin θ)     d(tip)/dθ, unit length, in x, z                                   (1)
radial      (sin θ,  cos θ)     outward along the arm                                             (2)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexarm.analytic import rigid_tip
from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.statics import static


@dataclass(frozen=True)
class Plane:
    """The swing of one arm in the x, z plane."""

    length: float
    """From the joint to the tip [m]."""
    vertical: float = 0.0
    """Angle about which it swings [rad]."""

    def tangential(self, tip: Floats, angle: Floats) -> Floats:
        """Return the offset of tips x, z along (1) [m]."""
        offset = tip - rigid_tip(self.length, angle)
        return np.asarray(np.cos(angle) * offset[:, 0] - np.sin(angle) * offset[:, 1])  # eq. (1)

    def radial(self, tip: Floats, angle: Floats) -> Floats:
        """Return the offset of tips x, z along (2) [m]."""
        offset = tip - rigid_tip(self.length, angle)
        return np.asarray(np.sin(angle) * offset[:, 0] + np.cos(angle) * offset[:, 1])  # eq. (2)


@dataclass(frozen=True)
class StaticOffset:
    """Tangential offset of the tip in equilibrium, over the drive's angle."""

    angle: Floats
    offset: Floats
    """Drive angle [rad] and tangential offset [m], shape (n,)."""

    @classmethod
    def of(cls, arm: Arm, length: float, middle: float, largest: float) -> StaticOffset:
        """Return equilibria at angles within `largest` of `middle` [rad], the tip at `length`."""
        poses = 25  # equilibria behind a quasi-static curve; the cubic spline through them is within 0.1 um
        angles = middle + np.linspace(-largest, largest, poses)
        found = [static(arm, joints={"hinge": angle}) for angle in angles]
        tips = np.array([statics.position[-1, [0, 2]] for statics in found])
        return cls(angles, Plane(length).tangential(tips, angles))

    def __call__(self, angle: Floats) -> Floats:
        """Return the offset at drive angles [m]."""
        from scipy.interpolate import CubicSpline

        found: Floats = CubicSpline(self.angle, self.offset)(angle)
        return found
