r"""How a drive comes to the motion in which a record begins.

A record that begins in motion does not tell what came before, and a run begins at rest. During T before the
first sample the rate therefore rises from rest to the rate v and the acceleration a with which the samples
begin,

.. math:: \dot q = v \, s^2 (3 - 2 s) + a T \, (s^3 - s^2), \qquad s = t/T                             (1)

with t from the beginning of that rise; the angle is its integral that ends at the first sample. Rate and
acceleration are continuous throughout: what the rise itself leaves ringing is of the order of
6 v/(omega^3 T^2). The arm arrives from where it must have come: teeth on the flank, friction in the sense of
its motion.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexarm.drive.joint_drive import JointDrive

LEAD = 4.0
"""T of (1) [s]: several periods of an arm's first mode."""


def led_in(drive: JointDrive) -> JointDrive:
    """The motion with a rise (1) from rest before it."""
    order, T = max(len(drive.coefficients) - 1, 4), LEAD
    q, v, a = (float(drive.coefficients[-1 - k, 0]) * f for k, f in ((0, 1.0), (1, 1.0), (2, 2.0)))
    rise = np.zeros((order + 1, 1))
    rise[-5, 0] = a / (4 * T**2) - v / (2 * T**3)
    rise[-4, 0] = v / T**2 - a / (3 * T)
    rise[-1, 0] = q - v * T / 2 + a * T**2 / 12
    padded = np.vstack(
        [np.zeros((order + 1 - len(drive.coefficients), drive.coefficients.shape[1])), drive.coefficients]
    )
    breaks = np.concatenate([[drive.breaks[0] - T], drive.breaks])
    return replace(drive, breaks=breaks, coefficients=np.hstack([rise, padded]))
