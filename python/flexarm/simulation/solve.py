r"""Solution of a run: equilibrium at the start, then the motion, alone or with its derivatives.

A motor that is driven by torque has no angle to begin with: it is held where it rests and let go at the
start. An arm whose joints pass its equilibrium at given rates starts in motion, with the velocities

.. math:: v_0 = \sum_j \frac{\partial x}{\partial \varphi_j} \dot\varphi_j                             (1)

x(phi) is the equilibrium as a function of the angles of the drives, of which the core has the derivative:
joints that follow in closed loops, inner hinges and shapes of links move with it. (1) meets all constraints,
and strains change only as the weight does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.drive_effect import lags_between
from flexarm.arm.parameter import Parameter, neighbours
from flexarm.arrays import Floats, read_only
from flexarm.assembly import assemble, joint_values, loops_of
from flexarm.drive import Drive
from flexarm.drive.lag import as_followed
from flexarm.errors import InvalidParameter
from flexarm.sensitivity import Redrive, Sensitivities, collected, varied
from flexarm.simulation.energies import energies_of
from flexarm.simulation.from_core import simulation_of
from flexarm.simulation.prepared import PreparedRun, motions
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


@dataclass(frozen=True)
class StartedRun:
    """A run at its start."""

    run: PreparedRun
    system: _core.System
    equilibrium: _core.Equilibrium
    motions: list[_core.PiecewisePolynomial]

    @classmethod
    def of(cls, run: PreparedRun) -> StartedRun:
        """Return a run at its start, in equilibrium."""
        system, along = _free(run, run.arm), run.motions
        held = _held(run, system)
        equilibrium = _start(run, held, along)
        return cls(run, system, start_in_motion(run, held, system, equilibrium), along)

    def result(self, found: _core.Transient) -> Simulation:
        """Return the run from what the core found."""
        run = self.run
        energies = energies_of(found, self.system, self.equilibrium, self.motions, run.options, run.led)
        return _with_drive(run, simulation_of(run.arm, found, run.options, energies, run.led))


def solved(run: PreparedRun, report: Report) -> Simulation:
    """Return the run alone."""
    start = StartedRun.of(run)
    return start.result(_core.simulate(start.system, start.equilibrium, start.motions, run.options, report))


def _with_drive(run: PreparedRun, found: Simulation) -> Simulation:
    """Return a run with the hash of its drive, and what joints were told that follow late."""
    found.solver["drive_sha256"] = run.drive.sha256()
    if run.arm.closures:
        found.solver["redundant_conditions"] = loops_of(run.arm).redundant
        found.solver["driven"] = " ".join(run.drive.joints)
    late = [name for name in run.told.joints if lags_between(run.arm, name)]
    if not late:
        return found
    command = np.full((len(found.time), len(found.joints)), np.nan)
    for name in late:
        command[:, found.joints.index(name)] = run.told.joints[name](found.time)
    return replace(found, joint_command=read_only(command))


def differentiated(
    run: PreparedRun, wanted: tuple[Parameter, ...], redrive: Redrive | None, report: Report
) -> Simulation:
    """Return the run with the derivatives of its arrays."""
    system = _free(run, run.arm)
    held = _held(run, system)
    driven_joints = {*run.kinds, *run.drive.rest}
    varied_free, places = varied(run.arm, wanted, lambda arm: _free(run, arm), redrive, driven=driven_joints)
    varied_held = varied_free
    if held is not system:
        varied_held, _ = varied(
            run.arm, wanted, lambda arm: _with_motors_held(run, arm), redrive, driven=driven_joints
        )
    moving = [wanted[place] for place in places]
    found, arrays = _with_derivatives(run, system, held, varied_free, varied_held, report, moving)
    return replace(found, sensitivities=collected(wanted, places, arrays))


def driven(run: PreparedRun, changes: Sequence[Drive]) -> Simulation:
    """Return the run with the derivatives of its arrays by a part of each of some changes of its drives.

    Raise InvalidParameter if a controller drives a joint, whose loop answers to a change, or the run begins
    in motion.
    """
    if run.drive.rates is not None:
        raise InvalidParameter("a run that begins in motion has no derivatives by its drives", where="drive")
    if any(joint.side == "command" for joint in run.drive.joints.values()):
        raise InvalidParameter("must prescribe motions or torques, no commands", where="drive")
    system = _free(run, run.arm)
    held = _held(run, system)
    nothing = motions(run.arm, Drive({}))
    along = [motions(run.arm, as_followed(change, run.arm)) for change in changes]
    varied_free, varied_held = (
        [_core.Varied(each, each, 1.0, 0.0, there, nothing) for there in along] for each in (system, held)
    )
    found, arrays = _with_derivatives(run, system, held, varied_free, varied_held, None)
    parts = tuple(Parameter(f"drives.{k}", 0.0, "1", drives=True) for k in range(len(changes)))
    return replace(found, sensitivities=Sensitivities(parts, arrays))


def _with_derivatives(
    run: PreparedRun,
    system: _core.System,
    held: _core.System,
    varied_free: list[_core.Varied],
    varied_held: list[_core.Varied],
    report: Report,
    wanted: Sequence[Parameter] = (),
) -> tuple[Simulation, dict[str, Floats]]:
    """Return the run and its derivatives with respect to what varies, stated with motors free and held."""
    equilibrium = _start(run, held, run.motions)
    initial = _core.static_derivative(held, equilibrium, varied_held, run.options.start)
    if wanted:
        require_backlash_derivative(
            run.arm,
            wanted,
            varied_held,
            held,
            equilibrium,
            initial,
            lambda other: _start(run, other, run.motions),
        )
    if held is not system:
        initial = _core.released_derivative(held, initial, system)
    equilibrium = start_in_motion(run, held, system, equilibrium)
    if run.drive.rates is not None:
        columns = []
        for parameter in wanted:
            (above, up), (below, down) = neighbours(run.arm, parameter)
            plus, minus = (StartedRun.of(replace(run, arm=arm)).equilibrium.state.v for arm in (above, below))
            columns.append((np.asarray(plus) - np.asarray(minus)) / (up - down))
        initial.velocity = np.stack(columns, axis=1)
    run.options.tolerance = DIFFERENTIATED
    both = _core.simulate_differentiated(
        system, equilibrium, run.motions, run.options, varied_free, initial, report
    )
    energies = energies_of(both.run, system, equilibrium, run.motions, run.options, run.led)
    found = _with_drive(run, simulation_of(run.arm, both.run, run.options, energies, run.led))
    return found, derived(found, both.derivatives, len(varied_free), run.led)


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


def _start(run: PreparedRun, held: _core.System, along: list[_core.PiecewisePolynomial]) -> _core.Equilibrium:
    """Return the equilibrium under the first drive values; motors driven by torque are held at rest."""
    first = {
        joint.name: motion(run.options.start)[0]
        for joint, motion in zip(run.arm.joints, along, strict=True)
        if joint.name in run.prescribed
    }
    values = joint_values(run.arm, {**run.drive.rest, **first})
    gravity = _core.Loads(gravity=np.array(run.arm.gravity))
    return _core.static_equilibrium(held, values, gravity, run.options.start)


_APART = 1e-4
"""Time between the two poses whose difference is (1) [s]."""


def start_in_motion(
    run: PreparedRun, held: _core.System, system: _core.System, equilibrium: _core.Equilibrium
) -> _core.Equilibrium:
    """Return the equilibrium of the held arm, let go with the rates of the run's drive, eq. (1).

    Raise InvalidParameter if a rate is not finite, or of a joint that no torque drives.
    """
    released = equilibrium if held is system else _core.released(held, equilibrium, system)
    if run.drive.rates is None:
        return released
    free = [name for name, joint in run.drive.joints.items() if joint.side == "torque"]
    for name, rate in run.drive.rates.items():
        if name not in free:
            raise InvalidParameter(
                f"no torque drives {name!r}, which begins as its drive does; torques drive "
                f"{', '.join(free) or 'no joint'}",
                where="drive.rates",
            )
        if not isfinite(rate):
            raise InvalidParameter(f"must be finite, got {rate}", where=f"drive.rates.{name}")
    kinds = {**dict.fromkeys(free, _core.DriveKind.motor_angle), **run.prescribed}
    turned = assemble(run.arm, kinds, driven=run.drive.rest)
    turned.count_closures_as(held)
    there = _core.Varied(
        turned, turned, _APART / 2, -_APART / 2, _poses(run, _APART / 2), _poses(run, -_APART / 2)
    )
    along = _core.static_derivative(turned, equilibrium, [there], run.options.start)  # eq. (1)
    return _core.in_motion(released, _core.released_derivative(turned, along, system))


def _poses(run: PreparedRun, time: float) -> list[_core.PiecewisePolynomial]:
    """Return where the drives are a time [s] after the start, at the rates of the start."""
    rates = run.drive.rates or {}
    found = []
    for joint, motion in zip(run.arm.joints, run.motions, strict=True):
        angle, rate, _ = motion(run.options.start)
        told = joint.name in run.prescribed
        found.append(
            _core.PiecewisePolynomial.constant(
                angle + time * rate if told else time * rates.get(joint.name, 0.0)
            )
        )
    return found
