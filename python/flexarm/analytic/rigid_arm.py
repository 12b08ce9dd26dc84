"""The rigid arm: the tip where the encoder's angle alone puts it."""

from __future__ import annotations

import numpy as np

from flexarm.analytic.motion import directions
from flexarm.analytic.nonlinear_modal import Array
from flexarm.errors import InvalidParameter


def rigid_tip(length: float, angle: Array | float, hanging: bool = False) -> Array:
    """Return the tip x, z [m] of a rigid arm, L (sin θ, cos θ), shape (..., 2), z up.

    The angle [rad] counts from the upright vertical (or the hanging one), positive from z towards x.
    """
    if not length > 0:
        raise InvalidParameter(f"arm's length must be positive, got {length} m")
    radial = directions(np.asarray(angle, dtype=float) + (np.pi if hanging else 0.0))[0]
    return length * radial
