"""The base an arm stands on, as the core takes it: tilted, on a pedestal that turns and may be shaken."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from flexarm import _core
from flexarm.arm.base_axis import base_axis
from flexarm.arm.inertia import Matrix
from flexarm.arm.rotation import from_vector, rotated
from flexarm.assembly.machine import Base, Hinge, Machine


def tilted(base: Base) -> Matrix:
    """Return the rotation of everything that stands on the base, about its origin."""
    return from_vector((*base.tilt, 0.0))


def core_hinges(hinges: Iterable[Hinge]) -> list[_core.Hinge]:
    """Return hinges as the core takes them."""
    return [
        _core.Hinge(axis=np.array(each.axis), stiffness=each.stiffness, damping=each.damping)
        for each in hinges
    ]


def pedestal(machine: Machine) -> _core.Pedestal | None:
    """Return the pedestal of a compliant base, or None where the base is rigid. It tilts with the base."""
    base, turn = machine.base, tilted(machine.base)
    if not base.hinges:
        return None
    amplitude, frequency, phase = base.vibration or (0.0, 0.0, 0.0)
    return _core.Pedestal(
        hinges=core_hinges(replace(each, axis=rotated(turn, each.axis)) for each in base.hinges),
        axis=np.array(rotated(turn, base_axis(machine.arm))),
        amplitude=amplitude,
        frequency=frequency,
        phase=phase,
    )
