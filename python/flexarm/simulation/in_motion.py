r"""Starts in motion: velocities of an arm whose joints pass its equilibrium at given rates.

.. math:: v_0 = \sum_j \frac{\partial x}{\partial \varphi_j} \dot\varphi_j                             (1)

x(phi) is the equilibrium as a function of the angles of the drives, of which the core has the derivative:
joints that follow in closed loops, inner hinges and shapes of links move with it. (1) meets all constraints,
and strains change only as the weight does.
"""

from __future__ import annotations

from math import isfinite

from flexarm import _core
from flexarm.assembly import assemble
from flexarm.errors import InvalidParameter
from flexarm.simulation.prepared import PreparedRun

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
