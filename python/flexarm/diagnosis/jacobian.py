"""Derivatives of the residuals of records by parameters of the model, in the cheapest way that is exact.

Of poses they follow from the derivatives of equilibria, one run for all parameters. A point of which only
positions are measured moves in its link with the link's section,

    dp/do = R,                                                                                         (1)

without another run. All else is differences of runs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.parameter import neighbours, parameters
from flexarm.arrays import Floats
from flexarm.comparison.poses import pose_numbers, solve_poses
from flexarm.diagnosis.residual_rows import put_over_noise
from flexarm.errors import InvalidParameter
from flexarm.measurement.slopes import predict_slopes

if TYPE_CHECKING:
    from flexarm.diagnosis.problem import Problem


PART = 3e-4
"""Of a parameter, for differences of runs.

Newton's iterations stop a ten-millionth of a metre apart: for an arm that swings on for 30 s, 3e-5 of its
modulus left up to 7 % of the derivative, ten times that a tenth of it.
"""
SHIFT = 1e-4
"""Of a point, for a difference that is exact to rounding [m]."""


def differences(
    problem: Problem, arm: Arm, keys: Sequence[str], steps: Mapping[str, float] = MappingProxyType({})
) -> Floats:
    """From runs with each parameter a little larger and smaller, of points from (1); shape (n, len(keys)).

    `steps` are those of some parameters, if not small.
    """
    found = np.zeros((len(problem), len(keys)))
    wanted = parameters(arm, list(keys))
    seen = {p.key for p in wanted if _only_seen(problem, p.key)}
    pairs = {p.key: neighbours(arm, p, steps.get(p.key), PART) for p in wanted if p.key not in seen}
    problem.prepare(model for pair in pairs.values() for model, _ in pair)
    for k, key in enumerate(p.key for p in wanted):
        if key in seen:
            found[:, k] = _point_slope(problem, arm, key)
        else:
            (above, up), (below, down) = pairs[key]
            found[:, k] = (problem.residual(above) - problem.residual(below)) / (up - down)
    return found


def static_jacobian(problem: Problem, arm: Arm, keys: Sequence[str]) -> Floats | None:
    """From the derivatives of equilibria, shape (n, len(keys)).

    None where records are motions, orientations are measured, or a law has no derivative.
    """
    records = problem.records
    signals = {(each.record, each.signal) for each in problem.rows}
    if any(
        records[record].kind != "static" or records[record].signals[signal].quantity == "orientation"
        for record, signal in signals
    ):
        return None
    found = np.empty((len(problem), len(keys)))
    try:
        for name in records:
            _put_pose_slopes(found, problem, arm, name, list(keys))
    except InvalidParameter:
        return None
    return found


def _put_pose_slopes(found: Floats, problem: Problem, arm: Arm, name: str, keys: list[str]) -> None:
    record, placement = problem.records[name], problem.placement[name]
    carried = record.applied_to(arm)
    if any(_is_overruled(key, arm, carried) for key in keys):
        raise InvalidParameter("is what the record states", where="sensitivities")
    run = solve_poses(carried, record, sensitivities=keys)
    stamps = pose_numbers(record)

    def of_signal(name: str) -> Floats:
        signal = record.signals[name]
        frame = placement.frame(signal)
        return -predict_slopes(run, signal, registration=frame, stamps=stamps[name])

    put_over_noise(found, problem.rows_of(name), of_signal)


def _is_overruled(key: str, arm: Arm, carried: Arm) -> bool:
    """Return True if a parameter is that of an effect in whose place a record has its own."""
    table, name, at, *_ = key.split(".")
    return table == "effects" and arm.effect(name, at) != carried.effect(name, at)


def _only_seen(problem: Problem, key: str) -> bool:
    """Return True if a parameter is the place of a point of which only positions are measured."""
    table, name, *_ = key.split(".")
    if table != "points":
        return False
    records = problem.records.values()
    signals = [s for record in records for s in record.signals.values() if s.point == name]
    return all(signal.quantity == "position" for signal in signals)


def _point_slope(problem: Problem, arm: Arm, key: str) -> Floats:
    """Return derivative by the place of a point in its link."""
    _, point, _, axis = key.split(".")
    found = np.zeros(len(problem))
    for name, record in problem.records.items():
        pair = problem.simulations.run(name, arm)
        rows = [row for row in problem.rows_of(name) if record.signals[row.signal].point == point]
        run = pair.simulation
        i = run.points.index(point)
        move = np.zeros_like(run.position)
        move[:, i] = _turned(run.orientation[:, i], "xyz".index(axis))  # eq. (1)
        ends = np.zeros((2, len(problem)))
        for end, shift in zip(ends, (SHIFT, -SHIFT), strict=True):
            shifted = replace(run, position=run.position + shift * move)
            problem.write_residual(end, name, replace(pair, simulation=shifted), rows)
        found += (ends[0] - ends[1]) / (2 * SHIFT)
    return found


def _turned(quaternion: Floats, axis: int) -> Floats:
    """Return an axis of the section in base axes, shape (n, 3)."""
    from scipy.spatial.transform import Rotation

    found: Floats = Rotation.from_quat(quaternion).as_matrix()[:, :, axis]
    return found
