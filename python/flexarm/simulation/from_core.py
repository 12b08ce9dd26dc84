"""The core's record of a run as a `Simulation`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arrays import Floats, read_only
from flexarm.simulation.energies import Energies
from flexarm.simulation.simulation import Simulation


def simulation_of(
    arm: Arm,
    run: _core.Transient,
    options: _core.TransientOptions,
    energies: Energies | Callable[[], Energies],
    led: int = 0,
) -> Simulation:
    """Return the core's columns as arrays with the instant first, without copies.

    The first `led` instants, in which a drive is led in, are left out.
    """
    n, p, links = len(run.time) - led, len(arm.points), len(arm.links)

    def columns(name: str, *shape: int) -> Floats | None:
        block = getattr(run, name)
        return read_only(block.T[led:].reshape(n, *shape)) if block.size or 0 in shape else None

    joints = {
        name: columns(name, len(arm.joints))
        for name in ("joint_angle", "joint_rate", "drive_angle", "drive_rate", "joint_torque", "motor_torque")
    }
    arrays: dict[str, Any] = {
        **joints,
        "energy_record": energies,
        "position": columns("position", p, 3),
        "velocity": columns("velocity", p, 3),
        "section_forces": columns("section_forces", links, 2, 6),
        "base_wrench": columns("base_wrench", 6),
    }
    if options.record_rotations:
        arrays |= {"orientation": columns("orientation", p, 4), "angular_rate": columns("angular_rate", p, 3)}
    counts = run.statistics
    solver = {
        "backend": _core.build_info().solver,
        "step": options.step,
        "alpha": options.alpha,
        "dimension": run.dimension,
        "steps": counts.steps,
        "iterations": counts.iterations,
        "factorisations": counts.factorisations,
        "halvings": counts.halvings,
        "seconds": run.seconds,
    }
    return Simulation(arm, read_only(run.time[led:]), **arrays, solver=solver)
