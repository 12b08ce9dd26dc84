"""Controllers that diverge: motors that run away from their commands."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import pi

from flexarm.arm import Arm
from flexarm.arm.joint import shaft_ratio
from flexarm.arm.sizes import LONGEST
from flexarm.control.dual import value_of
from flexarm.control.loop import ControlLoop
from flexarm.control.plant import Plant
from flexarm.errors import NotConverged


def require_stable(
    arm: Arm,
    loops: Mapping[str, ControlLoop],
    plant: Plant,
    commanded: Mapping[str, float],
    ranges: Mapping[str, float],
) -> None:
    """Raise NotConverged if a motor deviates from its command by more than the command range plus one turn.

    A slide has `LONGEST` instead of the turn.
    """
    for name, error, unit in _errors(arm, loops, plant, commanded):
        limit = ranges[name] + (LONGEST if unit == "m" else 2 * pi * shaft_ratio(name, arm.gears))
        if not abs(error) <= limit:  # also NaN
            raise NotConverged(
                f"the controller of joint {name!r} diverges: at t = {plant.time:.6g} s its motor stands "
                f"{abs(error):.3g} {unit} from its command, allowed are {limit:.3g} {unit}; are its gains "
                "and sample time those of the machine, and is the torque enough?",
                time=plant.time,
            )


def add_controller_states(
    failure: NotConverged,
    arm: Arm,
    loops: Mapping[str, ControlLoop],
    plant: Plant,
    commanded: Mapping[str, float],
) -> NotConverged:
    """Return a failure of the time step that says what the controllers did then."""
    states = [
        f"the motor of {name!r} is {abs(error):.2g} {unit} from its command and moves at "
        f"{value_of(plant.rate(loops[name].joint, output=False)):.3g} {unit}/s"
        for name, error, unit in _errors(arm, loops, plant, commanded)
    ]
    what = f"{failure}; under its controller {', '.join(states)}"
    return NotConverged(what, time=failure.time, iteration=failure.iteration, residual=failure.residual)


def _errors(
    arm: Arm, loops: Mapping[str, ControlLoop], plant: Plant, commanded: Mapping[str, float]
) -> Iterator[tuple[str, float, str]]:
    """Yield joint, command minus motor angle (output-referred), and unit."""
    for name, loop in loops.items():
        error = commanded[name] - value_of(plant.angle(loop.joint, output=False))
        yield name, error, "m" if arm.joint(name).type == "prismatic" else "rad"
