r"""Latent rotations of the base about each of its axes, as functions of time.

A slow rotation w(t) of the base about an axis through its origin moves what a tracker sees as a rotation
of the tracker's frame does,

.. math:: \partial r/\partial c_j = \frac{r(+\varepsilon) - r(-\varepsilon)}{2\varepsilon}\, B_j(t)      (1)

with r the residual for an error of the frame's rotation, B_j the splines of w. Inertia of the arm that turns
with the base, and gravity in its axes, are neglected: rotations are slow against the first mode. No mode
filters them: they may fit better than the joint that moves, and leave no joint out (`search`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.diagnosis.problem import Problem
from flexarm.missing_law.basis import Basis, basis_of
from flexarm.missing_law.policy import LawPolicy

BASE = "base"
"""Place of the rotations."""
AXES = "xyz"


def base_responses(
    problem: Problem, arm: Arm, policy: LawPolicy
) -> Iterator[tuple[str, list[Basis], Floats]]:
    """Yield axis, splines by record and (1), shape (n, m), of each axis that a signal shows."""
    turned = np.array([_turned(problem, arm, axis, policy.perturbation) for axis in np.eye(3)])
    least = policy.least_mode * float(np.linalg.norm(turned, axis=1).max())
    for axis, slopes in zip(AXES, turned, strict=True):
        if not np.linalg.norm(slopes) > least:
            continue
        bases: list[Basis] = []
        blocks = []
        for name in problem.records:
            rows = list(problem.rows_of(name))
            if not rows:
                continue
            bases.append(basis_of(problem, name, policy))
            block = np.zeros((len(problem), len(bases[-1])))
            for each in rows:
                block[each.where] = slopes[each.where, None] * bases[-1].at(each.time)  # eq. (1)
            blocks.append(block)
        yield axis, bases, np.column_stack(blocks)


def _turned(problem: Problem, arm: Arm, axis: Floats, turn: float) -> Floats:
    """Return derivatives of the residual with respect to a constant rotation, shape (n,)."""
    found = np.zeros(len(problem))
    for rows in problem.rows:
        pair, placement = problem.simulations.run(rows.record, arm), problem.placement[rows.record]
        signal = pair.signals[rows.signal]
        frame = placement.frame(signal)
        ends = []
        for sign in (1, -1):
            moved = replace(frame, rotation=np.asarray(frame.rotation) + sign * turn * axis)
            moved_placement = replace(placement, frames={**placement.frames, signal.frame: moved})
            ends.append(pair.residual(signal, moved_placement, hold=True)[rows.mask, rows.channel])
        found[rows.where] = (ends[0] - ends[1]) / (2 * turn * rows.sigma)
    return found
