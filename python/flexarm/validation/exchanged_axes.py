"""Exchanged axes of sensors of three axes: readings that the model gives about other axes.

    y_k = s_k p_j(k),    s_k = 1 or -1,    j a permutation of x, y, z other than x, y, z itself         (1)

A gain shows one turned sign (`validation.gain_faults`). Axes of an inertial sensor that are exchanged leave a
reading that no gain explains, and offsets of an accelerometer hide it, since gravity is one. So (1) is tried
as it stands. Exchanged axes of places are those of a mirror (`validation.mirrors`), or of a frame.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import permutations, product

import numpy as np

from flexarm.arrays import Floats
from flexarm.validation.channel import Channel
from flexarm.validation.policy import POLICY
from flexarm.wording import listed, with_unit

INERTIAL = ("acceleration", "angular_rate")
"""Quantities along the body axes of a point."""


def exchanged_axes(seen: Mapping[str, Sequence[Channel]]) -> Iterator[str]:
    """Report inertial sensors that (1) explains, and their own axes do not."""
    for name, channels in seen.items():
        for signal in dict.fromkeys(channel.signal.name for channel in channels):
            axes = [channel for channel in channels if channel.signal.name == signal]
            if axes[0].signal.quantity in INERTIAL and len(axes) == 3:
                yield from _exchanged(f"{name}: signals.{signal}", axes)


def rows_of(axes: Sequence[Channel]) -> tuple[Floats, Floats]:
    """Return readings and predictions, (axes, n), of rows that hold all axes."""
    held = np.zeros(len(axes[0].signal), dtype=np.intp)
    for axis in axes:
        held[axis.rows] += 1
    kept = [held[axis.rows] == len(axes) for axis in axes]
    y, p = (
        np.stack([values[rows] for values, rows in zip(of, kept, strict=True)])
        for of in ([each.measured for each in axes], [each.predicted for each in axes])
    )
    return y, p


def _exchanged(where: str, axes: Sequence[Channel]) -> Iterator[str]:
    y, p = rows_of(axes)
    if not y.size:
        return
    own, names = _rms(y - p), [channel.name for channel in axes]
    tried = [
        (_rms(y - np.array(signs)[:, None] * p[list(order)]), order, signs)
        for order in permutations(range(3))
        if order != (0, 1, 2)
        for signs in product((1, -1), repeat=3)
    ]
    least, order, signs = min(tried)
    if least > POLICY.max_unexplained * min(own, _rms(y)):
        return
    told = [
        f"{names[k]} reads {'-' * (signs[k] < 0)}{names[j]}"
        for k, j in enumerate(order)
        if _rms(y[k] - signs[k] * p[j]) <= POLICY.max_unexplained * _rms(y[k] - p[k])
    ]
    unit = axes[0].signal.unit
    left = f"that leaves {with_unit(least, unit, 2)} rms of {with_unit(own, unit, 2)}"
    yield f"{where}: {listed(told)} of the model's point; {left}: is it mounted so, or are columns exchanged?"


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.sum(np.atleast_2d(values) ** 2, axis=0))))
