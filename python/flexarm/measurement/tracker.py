"""Laser trackers and the like: positions and orientations of points; `predict` turns them into a frame.

A tracker samples a moving point: it neither averages nor filters, so a mode above half of its rate appears at
a lower frequency (2.5 Hz sampled at 2.3 Hz at 0.2 Hz). The simulation is sampled at the same instants and
aliases alike.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.measurement.sampling import Described, point_index, sample, stored


def base_position(simulation: Any, what: Described, instants: Floats, point: str | None = None) -> Floats:
    """Return the position of the signal's point (or another one) in the base's axes [m], shape (n, 3)."""
    p = point_index(simulation, what, point)
    return sample(
        simulation.time,
        stored(simulation, "position", what)[:, p],
        instants,
        stored(simulation, "velocity", what)[:, p],
    )


def base_orientation(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return the quaternion (x, y, z, w) of the signal's body in the base, shape (n, 4).

    Components are interpolated and normalised; signs are made continuous first (q and -q are one rotation).
    """
    quaternion = stored(simulation, "orientation", what)[:, point_index(simulation, what)]
    found = sample(simulation.time, continuous(quaternion), instants)
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    return found


def continuous(quaternion: Floats) -> Floats:
    """Return the same rotations, each with the sign nearer to the one before, shape (n, 4)."""
    flips = np.where(np.sum(quaternion[1:] * quaternion[:-1], axis=1) < 0, -1.0, 1.0)
    return np.asarray(quaternion * np.cumprod(np.concatenate([[1.0], flips]))[:, None])
