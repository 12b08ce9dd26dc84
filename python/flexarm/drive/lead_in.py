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
from numpy.polynomial import Polynomial

from flexarm.arrays import Floats
from flexarm.drive.joint_drive import JointDrive

LEAD = 4.0
"""T of (1) [s]: several periods of an arm's first mode."""


def led_in(drive: JointDrive) -> JointDrive:
    """The motion with a rise (1) from rest before it."""
    T, motion = LEAD, _padded(drive.coefficients, 5)
    q, v, a = motion[-1, 0], motion[-2, 0], 2 * motion[-3, 0]
    rise = [a / (4 * T**2) - v / (2 * T**3), v / T**2 - a / (3 * T), 0.0, 0.0, q - v * T / 2 + a * T**2 / 12]
    coefficients = np.column_stack([np.pad(rise, (len(motion) - 5, 0)), motion])
    return replace(
        drive, breaks=np.concatenate([[drive.breaks[0] - T], drive.breaks]), coefficients=coefficients
    )


def jerked(drive: JointDrive, before: float, width: float, height: float) -> JointDrive:
    r"""A motion that was led in, with a jerk in its rise,

    .. math:: 64 \, h \, s^3 (1 - s)^3, \quad 0 \le s \le 1,                                          (2)

    of `height` h [rad, m for a prismatic joint] over a `width` [s], that ends `before` the first sample [s].
    """
    rise, (begin, first) = Polynomial(drive.coefficients[::-1, 0]), drive.breaks[:2]
    starts = [begin, first - before - width, first - before]
    pieces = [rise(Polynomial([start - begin, 1.0])) for start in starts]  # each from its own start
    s = Polynomial([0.0, 1.0 / width])
    pieces[1] += 64 * height * (s * (1 - s)) ** 3  # eq. (2)
    kept = slice(3 if before > 0 else 2)
    rows = max(7, len(drive.coefficients))
    columns = [np.pad(piece.coef, (0, rows - len(piece.coef)))[::-1] for piece in pieces[kept]]
    return replace(
        drive,
        breaks=np.concatenate([starts[kept], drive.breaks[1:]]),
        coefficients=np.column_stack([*columns, _padded(drive.coefficients[:, 1:], rows)]),
    )


def _padded(coefficients: Floats, rows: int) -> Floats:
    """Polynomials of higher order, the same."""
    return np.vstack([np.zeros((rows - len(coefficients), coefficients.shape[1])), coefficients])
