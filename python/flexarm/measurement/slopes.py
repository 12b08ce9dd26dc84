"""Derivatives of predicted signals: through sensors, clocks and frames.

A run x(p) with derivatives dx/dp is seen by sensors that may depend on p too, y = f(x; p):

    dy/dp = (f(x + d dx/dp; p + d) - f(x - d dx/dp; p - d))/(2 d)                                     (1)

Sensors are linear or smooth in the motion, so that (1) is exact to rounding for most and to d^2 for the
others. Delays and drifts of clocks, registrations and drifts of frames are parameters like any other.
Rounding by an encoder's steps is left out: it has no derivative.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.parameter import neighbours
from flexarm.errors import InvalidParameter
from flexarm.measurement.clocks import EXACT, ClockError
from flexarm.measurement.frames import IDENTITY, Registration
from flexarm.measurement.predict import predict

Floats = NDArray[np.float64]


def predict_slopes(
    simulation: Any,
    signal: Any,
    clock: ClockError = EXACT,
    registration: Registration = IDENTITY,
    *,
    stamps: Floats | None = None,
) -> Floats:
    """Derivatives of a predicted signal by every parameter that a run was differentiated by.

    Parameters
    ----------
    simulation : Simulation or PoseSequence
        A run, or poses, with `sensitivities`.
    signal : Signal
        Names the quantity, its place and the stamps.
    clock, registration, stamps
        As in `predict`.

    Returns
    -------
    ndarray, shape (n, channels, parameter)
        SI over the parameter's unit; NaN where the simulation has ended.

    Raises
    ------
    InvalidParameter
        If the run has no derivatives.
    CannotMeasure
        If the simulation does not hold what the signal needs.
    """
    found = simulation.sensitivities
    if found is None:
        raise InvalidParameter("has no derivatives; simulate with sensitivities=[...]", where="simulation")
    columns = []
    for k, parameter in enumerate(found.parameters):
        (above, up), (below, down) = neighbours(simulation.arm, parameter)

        def seen(arm: Any, amount: float, k: int = k) -> Floats:
            arrays = {
                name: getattr(simulation, name) + amount * array[..., k]
                for name, array in found.arrays.items()
            }
            there = replace(simulation, arm=arm, sensitivities=None, **arrays)
            return predict(there, signal, clock, registration, rounded=False, stamps=stamps)

        columns.append((seen(above, up) - seen(below, down)) / (up - down))  # eq. (1)
    return np.stack(columns, axis=-1) if columns else np.empty((*signal.values.shape, 0))
