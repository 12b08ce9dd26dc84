"""Inertial units and inclinometers, strapped to a body at a point.

    omega = R^T w,        f = R^T (a - g)                                                            (1)
    inclination of body axis e:  asin(u . R e),  u = -g/|g|                                          (2)

R: the body's axes, w its angular rate and a the point's acceleration in the base, g gravity. f is specific
force: at rest it is |g| upward.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.measurement.sampling import Described, columns, point_index, sample, stored
from flexarm.measurement.tracker import base_orientation


def angular_rate(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return the angular rate of (1) in the body's axes [rad/s], shape (n, axes)."""
    return _body_vector(simulation, "angular_rate", what, instants)


def acceleration(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return the specific force f of (1) in the body's axes [m/s2], shape (n, axes)."""
    return _body_vector(simulation, "acceleration", what, instants)


def inclination(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return the angle of a body axis to the horizontal (2), upward positive [rad], shape (n, 1)."""
    from scipy.spatial.transform import Rotation

    quaternion = base_orientation(simulation, what, instants)
    axis = np.eye(3)[columns(what.axes)[0]]
    known = np.isfinite(quaternion).all(axis=1)
    found = np.full((len(instants), 1), np.nan)
    if known.any():
        upward = Rotation.from_quat(quaternion[known]).apply(axis) @ _up(simulation)
        found[known, 0] = np.arcsin(np.clip(upward, -1, 1))  # eq. (2)
    return found


def _body_vector(simulation: Any, name: str, what: Described, instants: Floats) -> Floats:
    values = stored(simulation, name, what)[:, point_index(simulation, what)]
    return sample(simulation.time, values[:, columns(what.axes)], instants)


def _up(simulation: Any) -> Floats:
    """Return the upward direction in the base's axes; z without gravity."""
    gravity = np.asarray(simulation.arm.gravity, dtype=float)
    weight = float(np.linalg.norm(gravity))
    return -gravity / weight if weight > 0 else np.array([0.0, 0.0, 1.0])
