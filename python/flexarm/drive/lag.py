r"""Lag of joints that follow their drives late: a delay D and a filter of first order.

.. math:: \tau \dot y + y = u(t - D)                                                                 (1)

A piece of the drive is a polynomial p(s) of the time s since its begin. There (1) is solved exactly by

.. math:: y(s) = P(s) + C e^{-s/\tau}, \qquad P = p - \tau p' + \tau^2 p'' - \dots                   (2)

with C from the end of the piece before; at the start y rests at the drive's first value. The core takes
polynomials: between knots, closer where the exponential is alive, (2) is put by the quintic that has its
values, rates and accelerations at both ends. With knots a quarter of a time constant apart that is exact to
(1/4)^6/46080 = 5e-9 of C.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flexarm.arm import Arm
from flexarm.arm.drive_effect import lags_between
from flexarm.arrays import Floats
from flexarm.drive.drive import Drive
from flexarm.drive.joint_drive import JointDrive
from flexarm.errors import InvalidParameter

APART = 0.25
"""Distance of knots over the time constant where the exponential of (2) is alive."""


def as_followed(drive: Drive, arm: Arm) -> Drive:
    """Return the motions with which motors follow their drives, those of outputs of gears at the inputs.

    Raise InvalidParameter if a joint is to follow a torque or a held command late.
    """
    joints = dict(drive.joints)
    for name, joint in drive.joints.items():
        for effect in lags_between(arm, name):
            if joint.side not in ("motor", "output"):
                raise InvalidParameter(
                    f"{effect.name} at {effect.at!r} acts on a prescribed angle, and this run prescribes a "
                    f"{joint.side}; leave the effect out",
                    where=f"effects.{effect.name}.{effect.at}",
                )
            joints[name] = lagged(joints[name], *effect.lag())
    late = replace(drive, joints=joints)
    if not arm.gears or any(joint.side == "command" for joint in joints.values()):
        return late
    return late.at_inputs(arm)


def lagged(drive: JointDrive, delay: float, time_constant: float) -> JointDrive:
    """Return the response (1) to a drive u, with D and tau [s] that are not negative."""
    gone = 1e-12  # part of the drive's range below which it is not
    drive = replace(drive, breaks=drive.breaks + delay)
    if not time_constant > 0:
        return drive
    last = np.zeros((len(drive.coefficients), 1))
    last[-1] = drive(drive.breaks[-1])
    p = np.hstack([drive.coefficients, last])  # it is held after its end
    part, term = p, p
    for _ in range(len(p) - 1):
        term = -time_constant * _derivative(term)
        part = part + term  # eq. (2)
    widths = np.append(np.diff(drive.breaks), np.inf)
    c = _transients(part, widths, float(p[-1, 0]), time_constant)
    floor = gone * max(float(np.ptp(p[-1])), abs(float(p[-1, 0])), 1e-300)
    knots, piece = _knots(widths, np.abs(c), floor, time_constant)
    values = _at(knots, part[:, piece], c[piece], time_constant)
    return _joined(drive, knots + drive.breaks[piece], piece, values)


def _derivative(p: Floats) -> Floats:
    """Return the derivative of polynomials, highest power first, shape (order + 1, pieces), as many rows."""
    powers = np.arange(len(p) - 1, -1, -1)[:, None]
    return np.vstack([np.zeros_like(p[:1]), (powers * p)[:-1]])


def _transients(part: Floats, widths: Floats, first: float, time_constant: float) -> Floats:
    """Return C of (2) of every piece."""
    ends = np.zeros(len(widths) - 1)
    for row in part:
        ends = ends * widths[:-1] + row[:-1]
    left = np.exp(-widths[:-1] / time_constant)
    found, now = [], first
    for begin, end, remaining in zip(part[-1, :-1].tolist(), ends.tolist(), left.tolist(), strict=True):
        found.append(now - begin)
        now = end + found[-1] * remaining
    return np.array([*found, now - float(part[-1, -1])])


def _knots(widths: Floats, c: Floats, floor: float, time_constant: float) -> tuple[Floats, NDArray[np.intp]]:
    """Return times since the begin of their piece at which (2) is joined, and the piece of each."""
    apart = APART * time_constant
    alive = time_constant * np.log(np.maximum(c / floor, 1.0))
    alive = np.where(alive > widths - apart, widths, alive)
    steps = np.ceil(alive / apart).astype(int)
    beyond = alive < widths  # one more, where the piece goes on as a polynomial
    counts = steps + 1 + beyond
    piece = np.repeat(np.arange(len(widths)), counts)
    number = np.arange(len(piece)) - np.repeat(np.cumsum(counts) - counts, counts)
    inside = number * (alive / np.maximum(steps, 1))[piece]
    ends = np.where(np.isfinite(widths), widths, alive + apart)
    last = number >= steps[piece]
    return np.where(last, np.where(number == steps[piece], alive[piece], ends[piece]), inside), piece


def _at(s: Floats, part: Floats, c: Floats, time_constant: float) -> Floats:
    """Return value, rate and acceleration of (2), shape (3, n), of a piece for each instant."""
    settled = c * np.exp(-s / time_constant)
    found = []
    for sign in (1.0, -1.0 / time_constant, 1.0 / time_constant**2):
        value = np.zeros_like(s)
        for row in part:
            value = value * s + row
        found.append(value + sign * settled)
        part = _derivative(part)
    return np.array(found)


def _joined(drive: JointDrive, time: Floats, piece: NDArray[np.intp], values: Floats) -> JointDrive:
    """Return quintics through values, rates and accelerations at the knots of every piece."""
    within = piece[1:] == piece[:-1]
    starts, h = time[:-1][within], np.diff(time)[within]
    (y0, v0, a0), (y1, v1, a1) = values[:, :-1][:, within], values[:, 1:][:, within]
    d, v, a = y1 - y0 - h * v0 - h**2 * a0 / 2, v1 - v0 - h * a0, a1 - a0
    coefficients = np.array(
        [
            (6 * d - 3 * h * v + h**2 * a / 2) / h**5,
            (-15 * d + 7 * h * v - h**2 * a) / h**4,
            (10 * d - 4 * h * v + h**2 * a / 2) / h**3,
            a0 / 2,
            v0,
            y0,
        ]
    )
    return replace(drive, breaks=np.append(starts, time[-1]), coefficients=coefficients)
