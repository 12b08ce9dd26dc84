r"""Linear response of the residuals to a windup of a joint.

A windup w(t) adds to the angle by which a drive turns its joint: with phi the motor's angle over the ratio,
theta the link's angle and k the joint's stiffness,

.. math:: T = k (\varphi + w - \theta) + c (\dot\varphi + \dot w - \dot\theta)                         (1)

so that a run along phi + w has it. w is a cubic B-spline in each record [deBoor2001],

.. math:: w(t) = \sum_j c_j B_j(t), \qquad
          \partial r/\partial c_j = (r(\varphi + \varepsilon B_j) - r(\varphi))/\varepsilon            (2)

A torque f that the joint loses is the windup w = -f/k. Runs of (2) take a longer time step; residuals about a
latent motion are simulated with the step of the problem.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from math import factorial
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.budget import allows
from flexarm.comparison.simulated_record import SimulatedRecord
from flexarm.diagnosis.problem import Problem
from flexarm.drive import JointDrive
from flexarm.missing_law.policy import LawPolicy
from flexarm.threads import at_once

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

DEGREE = 3
"""Degree of the B-splines."""


@dataclass(frozen=True, eq=False)
class TimeBasis:
    """Cubic B-splines over the time of a record."""

    knots: Floats
    """With their ends repeated [s], shape (m + 4,)."""

    @classmethod
    def over(cls, start: float, end: float, policy: LawPolicy) -> TimeBasis:
        """Return splines from start to end [s]."""
        count = int(np.clip((end - start) / policy.spacing, 4, policy.most_knots))
        inner = np.linspace(start, end, count + 1)
        return cls(np.concatenate([[start] * DEGREE, inner, [end] * DEGREE]))

    def __len__(self) -> int:
        """Return the number of coefficients m."""
        return len(self.knots) - DEGREE - 1

    @property
    def places(self) -> Floats:
        """Greville abscissae, where coefficients act, shape (m,) [s]."""
        m = len(self)
        return np.asarray(np.mean([self.knots[1 + k : 1 + k + m] for k in range(DEGREE)], axis=0))

    def at(self, time: Floats) -> Floats:
        """Return B_j(t), shape (n, m); held outside."""
        from scipy.interpolate import BSpline

        inside = np.clip(time, self.knots[0], self.knots[-1])
        return np.asarray(BSpline.design_matrix(inside, self.knots, DEGREE).toarray())

    def fine(self, policy: LawPolicy) -> Floats:
        """Return instants that sample each interval of knots [s]."""
        count = policy.samples * (len(self) - DEGREE)
        return np.linspace(self.knots[0], self.knots[-1], count + 1)

    def nearest(self, time: Floats, values: Floats) -> Floats:
        """Return coefficients of the splines nearest to values at instants, in the mean square."""
        at = self.at(time)
        return np.asarray(np.linalg.solve(at.T @ at, at.T @ values))

    def polynomial(self, coefficients: Floats) -> PPoly:
        """Return w as a piecewise polynomial."""
        from scipy.interpolate import BSpline, PPoly

        return PPoly.from_spline(BSpline(self.knots, coefficients, DEGREE))


def added(drive: JointDrive, extra: PPoly) -> JointDrive:
    """Return a drive plus a piecewise polynomial; both are held before and after."""
    from scipy.interpolate import PPoly

    own = PPoly(drive.coefficients, drive.breaks)
    breaks = np.unique(np.concatenate([drive.breaks, extra.x]))
    breaks = breaks[np.concatenate([[True], np.diff(breaks) > 1e-9])]
    order = max(len(drive.coefficients), len(extra.c))
    middle = (breaks[:-1] + breaks[1:]) / 2
    found = np.zeros((order, len(breaks) - 1))
    for part in (own, extra):
        inside = np.clip(middle, part.x[0], part.x[-1])
        held = (middle < part.x[0]) | (middle > part.x[-1])
        i = np.clip(np.searchsorted(part.x, inside, side="right") - 1, 0, len(part.x) - 2)
        offset = np.where(held, inside, breaks[:-1]) - part.x[i]
        c = part.c[::-1, i]  # rising powers
        for k in range(len(c)):
            term = sum(
                c[j] * offset ** (j - k) * (factorial(j) / factorial(k) / factorial(j - k))
                for j in range(k, len(c))
            )
            found[order - 1 - k] += np.where(held & (k > 0), 0.0, term)
    return JointDrive(breaks, found, drive.side)


@dataclass(frozen=True, eq=False)
class WindupResponse:
    """Eq. (2) of a joint in all records."""

    problem: Problem
    arm: Arm
    joint: str
    """Whose; the model is that of the diagnosis."""
    bases: Mapping[str, TimeBasis]
    """By record; coefficients of all records follow one another."""
    jacobian: Floats
    """Derivatives of the residual by all coefficients, shape (n, m)."""

    @classmethod
    def of(cls, problem: Problem, arm: Arm, joint: str, policy: LawPolicy) -> WindupResponse | None:
        """Simulate (2), `jobs` runs at once; None if the time for it ends."""
        coarse = problem.with_step(policy.response_step)
        bases = {name: _basis(problem, arm, name, policy) for name in problem.records}
        first = dict(zip(bases, np.cumsum([0, *map(len, bases.values())]), strict=False))
        found = np.zeros((len(problem), sum(map(len, bases.values()))))
        nothing = coarse.residual(arm)

        def column(which: tuple[str, int]) -> None:
            name, j = which
            unit = policy.perturbation * np.eye(len(bases[name]))[j]
            after = nothing.copy()
            pair = coarse.simulations.driven(
                name, arm, {joint: wound(coarse, arm, name, joint, bases[name].polynomial(unit))}
            )
            coarse.put(after, name, pair)
            found[:, first[name] + j] = (after - nothing) / policy.perturbation  # eq. (2)

        runs = [which for name, basis in bases.items() for which in product([name], range(len(basis)))]
        batch = policy.batch * problem.jobs
        for k in range(0, len(runs), batch):
            if not allows(f"the missing motion of {joint} was sought"):
                return None
            at_once(column, runs[k : k + batch], problem.jobs)
        return cls(problem, arm, joint, bases, found)

    def parts(self, coefficients: Floats) -> dict[str, Floats]:
        """Return coefficients by record."""
        ends = np.cumsum([len(basis) for basis in self.bases.values()])[:-1]
        return dict(zip(self.bases, np.split(coefficients, ends), strict=True))

    def moved(self, coefficients: Floats) -> Floats:
        """Return what a latent motion changes of the residual, simulated, shape (n,)."""
        before = self.problem.residual(self.arm)
        after = before.copy()
        for name, each in self.parts(coefficients).items():
            self.problem.put(after, name, self.run(name, each))
        found: Floats = after - before
        return found

    def run(self, name: str, coefficients: Floats) -> SimulatedRecord:
        """Return the run of a record with a latent motion."""
        extra = self.bases[name].polynomial(coefficients)
        drive = wound(self.problem, self.arm, name, self.joint, extra)
        return self.problem.simulations.driven(name, self.arm, {self.joint: drive})


def wound(problem: Problem, arm: Arm, name: str, joint: str, extra: PPoly) -> JointDrive:
    """Return the drive of a joint in a record with a windup on it."""
    drive = problem.simulations.drive(name, problem.records[name].applied_to(arm))
    return added(drive.joints[joint], extra)


def _basis(problem: Problem, arm: Arm, name: str, policy: LawPolicy) -> TimeBasis:
    """Return splines over the rows of a record."""
    times = [rows.time for rows in problem.rows_of(name)]
    drive = problem.simulations.drive(name, problem.records[name].applied_to(arm))
    start = min([drive.start, *(float(t[0]) for t in times)])
    return TimeBasis.over(start, max(float(t[-1]) for t in times), policy)
