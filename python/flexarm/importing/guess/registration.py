"""How near the rigid arm's point comes to a measured one after the best lag and rigid motion.

With measured points y, predicted ones x at the same instants and their means taken off,

    r² = min over R, det R = 1, of mean |y − R x|² = mean |y|² + mean |x|² − 2 (σ₁ + σ₂ + s σ₃)          (1)

with σ the singular values of mean y xᵀ and s = sign det. The lag is the best around the
one of `agreement`. Source: [Umeyama1991].
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.importing.guess.motion import Track, agreement, rigid_track

COARSE = 400
"""Instants on which a lag is sought."""
NARROWER = 5
"""Times that the steps about the best lag are made three times smaller."""


@dataclass(frozen=True)
class Registration:
    """What the best lag and rigid motion leave between a measured point and the model's."""

    rms: float
    """After both [m], (1)."""
    shifted: float
    """After the lag and a shift alone, the axes being parallel [m]."""
    mirrored: float
    """After both and a reflection, as with two of the columns exchanged [m]."""


def registration(arm: Arm, point: str, joints: Mapping[str, Track], measured: Track) -> Registration:
    """Return how near a point of the rigid arm along its joints comes to a measured one of three axes."""
    predicted = rigid_track(arm, point, joints, range(3), COARSE)
    if measured.poses:
        return _left(measured, predicted, 0.0)
    lag = agreement(measured, predicted, COARSE).lag
    step = max(measured.time[-1], predicted.time[-1]) / COARSE
    best = _left(measured, predicted, lag)
    for _ in range(NARROWER):
        for tried in (lag - step, lag + step):
            found = _left(measured, predicted, tried)
            if found.rms < best.rms:
                best, lag = found, tried
        step /= 3
    return best


def _left(measured: Track, predicted: Track, lag: float) -> Registration:
    at = measured.time - lag
    inside = (at >= predicted.time[0]) & (at <= predicted.time[-1])
    if inside.sum() < 8:
        return Registration(np.inf, np.inf, np.inf)
    y, x = _centred(measured.values[inside]), _centred(predicted.at(at[inside]))
    shifted = float(np.sqrt(np.mean(np.sum((y - x) ** 2, axis=1))))
    u, sizes, v = np.linalg.svd(y.T @ x / len(y))
    sign, both = np.sign(np.linalg.det(u @ v)), float(np.mean(np.sum(y**2 + x**2, axis=1)))
    proper, mirrored = (
        float(np.sqrt(max(both - 2 * (sizes[0] + sizes[1] + s * sizes[2]), 0.0))) for s in (sign, -sign)
    )  # eq. (1)
    return Registration(proper, shifted, mirrored)


def _centred(values: Floats) -> Floats:
    centred: Floats = values - values.mean(axis=0)
    return centred
