"""A motion from stop to stop without a jerk at its ends."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexarm.arrays import Floats


def joined(stops: Sequence[float], seconds: float) -> tuple[Floats, Floats]:
    """Return minimum-jerk moves from stop to stop [Flash1985].

    Parameters
    ----------
    stops : sequence of float
        Angles [rad], two or more.
    seconds : float
        From one stop to the next.

    Returns
    -------
    time, angle : ndarray
        Samples every 4 ms, the last stop included [s, rad].

    Examples
    --------
    >>> time, angle = joined([0.0, 1.0], 2.0)
    >>> float(angle[0]), round(float(angle[250]), 6), float(angle[-1])
    (0.0, 0.5, 1.0)
    """
    interval = 4e-3  # between samples [s]
    moves = len(stops) - 1
    time = np.linspace(0.0, seconds * moves, round(seconds * moves / interval) + 1)
    move = np.minimum((time / seconds).astype(int), moves - 1)
    s = np.clip(time / seconds - move, 0.0, 1.0)
    angle: Floats = np.take(stops, move) + np.diff(stops)[move] * s**3 * (10 - 15 * s + 6 * s**2)
    return time, angle
