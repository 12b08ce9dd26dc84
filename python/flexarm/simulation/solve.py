"""Solution of a run: equilibrium at the start, then the motion, alone or with its derivatives.

A motor that is driven by torque has no angle to begin with: it is held where it rests and let go at the
start.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.parameter import Parameter
from flexarm.arrays import Floats, read_only
from flexarm.assembly import assemble, joint_values
from flexarm.drive.lag import lagging
from flexarm.sensitivity import Redrive, collected, varied
from flexarm.simulation.energies import energies_of
from flexarm.simulation.from_core import simulation_of
from flexarm.simulation.prepared import PreparedRun
from flexarm.simulation.progress import Report
from flexarm.simulation.simulation import Simulation
from flexarm.statics.backlash_derivative import require_backlash_derivative

DIFFERENTIATED = 1e-13
"""Newton's tolerance: accelerations, h^2 less exact than positions, enter derivatives by masses."""

_DERIVED = (
    "position",
    "velocity",
    "joint_angle",
    "joint_rate",
    "drive_angle",
    "drive_rate",
    "joint_torque",
    "motor_torque",
    "orientation",
    "angular_rate",
    "section_forces",
    "base_wrench",
)
"""Arrays of a run that have derivatives."""


def solved(run: PreparedRun, report: Report) -> Simulation:
    """Return the run alone."""
    system, motions = _free(run, run.arm), run.motions
    held = _held(run, system)
    equilibrium = _start(run, held, motions)
    if held is not system:
        equilibrium = _core.released(held, equilibrium, system)
    found = _core.simulate(system, equilibrium, motions, run.options, report)
    energies = energies_of(found, system, equilibrium, motions, run.options, run.led)
    return _with_commands(run, simulation_of(run.arm, found, run.options, energies, run.led))


def _with_commands(run: PreparedRun, found: Simulation) -> Simulation:
    """Return a run with what joints were told that follow late."""
    late = lagging(run.told, run.arm)
    if not late:
        return found
    command = np.full(found.drive_angle.shape, np.nan)
    for name in late:
        command[:, found.joints.index(name)] = run.told.joints[name](found.time)
    return replace(found, joint_command=read_only(command))


def differentiated(
    run: PreparedRun, wanted: tuple[Parameter, ...], redrive: Redrive | None, report: Report
) -> Simulation:
    """Return the run with the derivatives of its arrays."""
    system, motions = _free(run, run.arm), run.motions
    held = _held(run, system)
    equilibrium = _start(run, held, motions)
    varied_systems, places = varied(run.arm, wanted, lambda arm: _free(run, arm), redrive)
    still = varied_systems
    if held is not system:
        still, _ = varied(run.arm, wanted, lambda arm: _with_motors_held(run, arm), redrive)
    initial = _core.static_derivative(held, equilibrium, still, run.options.start)
    require_backlash_derivative(
        run.arm,
        [wanted[place] for place in places],
        still,
        held,
        equilibrium,
        initial,
        lambda other: _start(run, other, motions),
    )
    if held is not system:
        initial = _core.released_derivative(held, initial, system)
        equilibrium = _core.released(held, equilibrium, system)
    run.options.tolerance = DIFFERENTIATED
    both = _core.simulate_differentiated(
        system, equilibrium, motions, run.options, varied_systems, initial, report
    )
    energies = energies_of(both.run, system, equilibrium, motions, run.options, run.led)
    found = _with_commands(run, simulation_of(run.arm, both.run, run.options, energies, run.led))
    arrays = derived(found, both.derivatives, len(places), run.led)
    return replace(found, sensitivities=collected(wanted, places, arrays))


def derived(run: Simulation, derivatives: _core.Transient, count: int, led: int = 0) -> dict[str, Floats]:
    """Return the derivatives of a run's arrays from the core's columns after `led` instants."""
    return {
        name: getattr(derivatives, name).T[led:].reshape(*value.shape, count)
        for name in _DERIVED
        if (value := getattr(run, name)) is not None
    }


def _free(run: PreparedRun, arm: Arm) -> _core.System:
    """Return an arm as it moves in the run."""
    return assemble(arm, run.kinds, driven=run.drive.rest)


def _with_motors_held(run: PreparedRun, arm: Arm) -> _core.System:
    """Return an arm as it stands before the start, motors held that torques drive."""
    return assemble(arm, run.prescribed, driven={*run.kinds, *run.drive.rest})


def _held(run: PreparedRun, system: _core.System) -> _core.System:
    """Return the arm with its motors held until the start; the same one if none is driven by torque."""
    if run.prescribed == run.kinds:
        return system
    return _with_motors_held(run, run.arm)


def _start(
    run: PreparedRun, held: _core.System, motions: list[_core.PiecewisePolynomial]
) -> _core.Equilibrium:
    """Return the equilibrium under the first drive values; motors driven by torque are held at rest."""
    told = run.prescribed
    first = {
        joint.name: motion(run.options.start)[0]
        for joint, motion in zip(run.arm.joints, motions, strict=True)
        if joint.name in told
    }
    values = joint_values(run.arm, {**run.drive.rest, **first})
    gravity = _core.Loads(gravity=np.array(run.arm.gravity))
    return _core.static_equilibrium(held, values, gravity, run.options.start)
