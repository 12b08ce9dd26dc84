"""Controllers that diverge: motors that run away from their commands."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import pi

from flexarm.arm import Arm
from flexarm.arm.joint import shaft_ratio
from flexarm.arm.sizes import LONGEST
from flexarm.control.dual import value_of
from flexarm.control.loop import Loop
from flexarm.control.plant import Plant
from flexarm.errors import NotConverged


def require_followed(
    arm: Arm,
    loops: Mapping[str, Loop],
    plant: Plant,
    commanded: Mapping[str, float],
    ranges: Mapping[str, float],
) -> None:
    """Raise NotConverged if a motor is farther from its command than a stable controller leaves it.

    That is the range of its commands, and a turn of its joint or a length that no arm has.
    """
    for name, error, unit in _errors(arm, loops, plant, commanded):
        most = ranges[name] + (LONGEST if unit == "m" else 2 * pi * shaft_ratio(name, arm.gears))
        if not abs(error) <= most:
            raise NotConverged(
                f"the controller of joint {name!r} diverges: at t = {plant.time:.6g} s its motor stands "
                f"{abs(error):.3g} {unit} from its command, allowed are {most:.3g} {unit}; are its gains and "
                "sample time those of the machine, and is the torque enough?",
                time=plant.time,
            )


def with_loops(
    failure: NotConverged, arm: Arm, loops: Mapping[str, Loop], plant: Plant, commanded: Mapping[str, float]
) -> NotConverged:
    """Return a failure of the time step that says what the controllers did then."""
    told = [
        f"the motor of {name!r} is {abs(error):.2g} {unit} from its command and moves at "
        f"{value_of(plant.rate(loops[name].joint, output=False)):.3g} {unit}/s"
        for name, error, unit in _errors(arm, loops, plant, commanded)
    ]
    what = f"{failure}; under its controller {', '.join(told)}"
    return NotConverged(what, time=failure.time, iteration=failure.iteration, residual=failure.residual)


def _errors(
    arm: Arm, loops: Mapping[str, Loop], plant: Plant, commanded: Mapping[str, float]
) -> Iterator[tuple[str, float, str]]:
    """Yield joint, command minus the motor's angle over the ratio, and its unit."""
    for name, loop in loops.items():
        error = commanded[name] - value_of(plant.angle(loop.joint, output=False))
        yield name, error, "m" if arm.joint(name).type == "prismatic" else "rad"
