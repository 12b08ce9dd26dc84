r"""Lead-in: the rise from rest to the motion in which a record begins.

A record that begins in motion does not tell what came before, and a run begins at rest. During T before the
first sample the rate therefore rises from rest to the rate v and the acceleration a with which the samples
begin,

.. math:: \dot q = v \, s^2 (3 - 2 s) + a T \, (s^3 - s^2), \qquad s = t/T                             (1)

with t from the beginning of that rise; the angle is its integral that ends at the first sample. Rate and
acceleration are continuous: what the rise leaves ringing is of the order of 6 v/(omega^3 T^2). A first rate
or acceleration far beyond the usual ones of the first second is noise of samples that are joined as they are;
those of the cubic that fits this second best take its place. Backlash and friction start in the state that
this motion leaves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.polynomial import Polynomial

from flexarm.drive.joint_drive import JointDrive

LEAD = 4.0
"""T of (1) [s]: several periods of an arm's first mode."""
FAR = 3.0
"""Greatest difference of first rates from those of the trend, over their rms [-]."""


def led_in(drive: JointDrive) -> JointDrive:
    """Return the motion with a rise (1) from rest before it."""
    v, a = _first_rates(drive)
    T, t = LEAD, Polynomial([0.0, 1.0])
    rise = v * (t**3 / T**2 - t**4 / (2 * T**3)) + a * (t**4 / (4 * T**2) - t**3 / (3 * T))
    first = drive.breaks[0]
    return _before(drive, [first - T], [rise + float(drive(first)) - rise(T)])


def _first_rates(drive: JointDrive) -> tuple[float, float]:
    """Return v and a of (1)."""
    window = 1.0  # window of the trend [s]
    t = np.linspace(0.0, min(window, drive.breaks[-1] - drive.breaks[0]), 201)
    values = drive(drive.breaks[0] + t)
    trend = Polynomial.fit(t, values, min(3, len(drive.coefficients) - 1)).convert()
    found = []
    for order, first in enumerate(drive.polynomial()(drive.breaks[0])[1:], start=1):
        values = np.gradient(values, t)
        slow = float(trend.deriv(order)(0.0))
        far = FAR * float(np.sqrt(np.mean(values**2)))
        found.append(float(first) if abs(first - slow) <= far else slow)
    return found[0], found[1]


def _before(drive: JointDrive, starts: Sequence[float], pieces: Sequence[Polynomial]) -> JointDrive:
    """Return the motion with pieces before its own, each a polynomial from its start on."""
    rows = max(len(drive.coefficients), *(len(piece.coef) for piece in pieces))
    columns = [np.pad(piece.coef, (0, rows - len(piece.coef)))[::-1] for piece in pieces]
    padded = np.pad(drive.coefficients, ((rows - len(drive.coefficients), 0), (0, 0)))
    breaks = np.concatenate([starts, drive.breaks])
    return replace(drive, breaks=breaks, coefficients=np.column_stack([*columns, padded]))


def with_pulse(drive: JointDrive, before: float, width: float, height: float) -> JointDrive:
    r"""Return a motion with lead-in and a pulse in its rise,

    .. math:: 64 \, h \, s^3 (1 - s)^3, \quad 0 \le s \le 1,                                          (2)

    of `height` h [rad, m for a prismatic joint] over a `width` [s], that ends `before` the first sample [s].
    """
    k = int(np.argmin(np.abs(drive.breaks - drive.breaks[0] - LEAD)))  # the first sample
    last = drive.breaks[k] - before
    s = Polynomial([0.0, 1.0 / width])
    pulse = 64 * height * (s * (1 - s)) ** 3  # eq. (2)
    starts = sorted({*drive.breaks[:k].tolist(), last - width, *([last] if before > 0 else [])})
    pieces = []
    for start in starts:
        i = int(np.searchsorted(drive.breaks, start, side="right")) - 1
        piece = Polynomial(drive.coefficients[::-1, i])(Polynomial([start - drive.breaks[i], 1.0]))
        inside = last - width <= start < last
        pieces.append(piece + pulse(Polynomial([start - (last - width), 1.0])) if inside else piece)
    return _before(
        replace(drive, breaks=drive.breaks[k:], coefficients=drive.coefficients[:, k:]), starts, pieces
    )
