"""Runs side by side in vector registers: arms of one structure along one drive, whose numbers differ.

A run differs from the one alone by rounding, and where the end of a step's iteration hangs on that, by a part
of its tolerance. It does not depend on what is computed beside it. What does not fit is left to be run alone:
loops, super-elements, tables of windup, derivatives, energies, section forces, rotations.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from inspect import signature
from typing import Any

from flexarm import _core
from flexarm.arm import Arm
from flexarm.drive import Drive
from flexarm.record import Record
from flexarm.simulation.prepared import coordinates, prepared_along
from flexarm.simulation.simulate import simulate
from flexarm.simulation.simulation import Simulation
from flexarm.simulation.solve import StartedRun

Pair = tuple[Arm, Drive | Record]

_NOT_SIDE_BY_SIDE = ("forces", "rotations", "energies", "sensitivities")
"""Options of `simulate` that only runs alone have."""


def side_by_side(pairs: Iterable[Pair], *, joints: bool = True, **options: Any) -> list[Simulation | None]:
    """Return the runs that fit, in their order, and None for each that is to be run alone.

    Options are those of `simulate`; without `joints` their angles, rates and torques are left out. What is
    wrong with a run, it tells alone.
    """
    wanted = list(pairs)
    defaults = {name: each.default for name, each in signature(simulate).parameters.items()}
    given = defaults | options
    fits = given.keys() == defaults.keys() and not any(given[name] for name in _NOT_SIDE_BY_SIDE)
    started = [_started(arm, drive, joints, given) if fits else None for arm, drive in wanted]
    found: list[Simulation | None] = [None] * len(wanted)
    for group in _alike(started):
        runs = _core.simulate_side_by_side(
            [(start.system, start.equilibrium) for _, start in group],
            group[0][1].motions,
            group[0][1].run.options,
            given["progress"],
        )
        for (k, start), run in zip(group, runs, strict=True):
            found[k] = None if run is None else start.result(run)
    return found


def _started(arm: Arm, drive: Drive | Record, joints: bool, given: dict[str, Any]) -> StartedRun | None:
    """Return a run at its start, or None where something is wrong, or it runs alone."""
    try:
        names = ("step", "alpha", "end", "forces", "rotations")
        run = prepared_along(arm, drive, *(given[name] for name in names))
        if run.drive.rates is not None or any(j.side == "command" for j in run.drive.joints.values()):
            return None
        run.options.consistent_forces = given["consistent_forces"]
        run.options.record_joints = joints
        run.options.dimension = coordinates(given["dimension"])
        return StartedRun.of(run)
    except Exception:  # the run alone tells
        return None


def _alike(started: Sequence[StartedRun | None]) -> list[list[tuple[int, StartedRun]]]:
    """Return the runs along the same drive, over the same time, each with its place."""
    groups: dict[Any, list[tuple[int, StartedRun]]] = {}
    for k, start in enumerate(started):
        if start is None:
            continue
        run = start.run
        joints = tuple(joint.name for joint in run.arm.joints)
        key = (run.drive.sha256(), run.options.start, run.options.end, joints)
        groups.setdefault(key, []).append((k, start))
    return list(groups.values())
