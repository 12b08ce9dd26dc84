"""The rigid arm: the tip where the encoder's angle alone puts it."""

from __future__ import annotations

import numpy as np

from flexarm.analytic.motion import directions
from flexarm.analytic.nonlinear_modal import Array
from flexarm.errors import InvalidParameter


def rigid_tip(length: float, angle: Array | float, hanging: bool = False) -> Array:
    """Return the tip of a rigid arm, L (sin θ, cos θ).

    Parameters
    ----------
    length : float
        L [m].
    angle : float or ndarray, shape (...)
        Joint angle [rad] from the upright vertical, positive from z towards x.
    hanging : bool
        Count the angle from the hanging vertical instead.

    Returns
    -------
    tip : ndarray, shape (..., 2)
        x, z [m], z up.
    """
    if not length > 0:
        raise InvalidParameter(f"arm's length must be positive, got {length} m")
    radial = directions(np.asarray(angle, dtype=float) + (np.pi if hanging else 0.0))[0]
    return length * radial
