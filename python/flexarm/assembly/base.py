"""The base an arm stands on, as the core takes it: tilted, on a pedestal that turns and may be shaken."""

from __future__ import annotations

from math import isinf

import numpy as np

from flexarm import _core
from flexarm.arm.base_axis import base_axis
from flexarm.arm.inertia import Matrix
from flexarm.arm.rotation import from_vector, rotated
from flexarm.assembly.machine import Base, Machine


def tilted(base: Base) -> Matrix:
    """Return the rotation of everything that stands on the base, about its origin."""
    return from_vector((*base.tilt, 0.0))


def pedestal(machine: Machine) -> _core.Pedestal | None:
    """Return the pedestal of a compliant base, or None where the base is rigid. It tilts with the base."""
    base = machine.base
    if isinf(base.stiffness):
        return None
    amplitude, frequency, phase = base.vibration or (0.0, 0.0, 0.0)
    return _core.Pedestal(
        axis=np.array(rotated(tilted(base), base_axis(machine.arm))),
        stiffness=base.stiffness,
        damping=base.damping,
        amplitude=amplitude,
        frequency=frequency,
        phase=phase,
    )
