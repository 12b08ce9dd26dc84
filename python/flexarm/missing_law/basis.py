"""Bases of latent motions over a record: cubic B-splines in time, and one number a pose."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.problem import Problem
from flexarm.measurement.least_squares_spline import DEGREE
from flexarm.missing_law.gaussian import matern_root
from flexarm.missing_law.policy import LawPolicy

if TYPE_CHECKING:
    from scipy.interpolate import PPoly


@dataclass(frozen=True, eq=False)
class TimeBasis:
    """Cubic B-splines over the time of a record."""

    knots: Floats
    """With their ends repeated [s], shape (m + 4,)."""
    of: ClassVar[str] = "time"
    of_unit: ClassVar[str] = "s"
    """What the coefficients follow."""

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

    def root(self, length: float) -> Floats:
        """Return a root of the prior covariance of size one, for a correlation length [s]."""
        return matern_root(self.places, length)

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

    def splines(self) -> list[PPoly]:
        """Return each B_j as a piecewise polynomial over its support."""
        from scipy.interpolate import BSpline, PPoly

        each, x = BSpline(self.knots, np.eye(len(self)), DEGREE), self.knots[DEGREE:-DEGREE]
        c = np.array([each(x[:-1], nu=power) / factorial(power) for power in range(DEGREE, -1, -1)])
        ends = [(max(j - DEGREE, 0), min(j + 1, len(x) - 1)) for j in range(len(self))]
        return [PPoly(c[:, i:k, j], x[i : k + 1]) for j, (i, k) in enumerate(ends)]


@dataclass(frozen=True)
class PoseBasis:
    """A number for each pose of a static record; poses know nothing of one another."""

    count: int
    """Number m of poses."""
    of: ClassVar[str] = "pose"
    of_unit: ClassVar[str] = "1"

    def __len__(self) -> int:
        """Return the number of poses."""
        return self.count

    @property
    def places(self) -> Floats:
        """Numbers of the poses, shape (m,)."""
        return np.arange(float(self.count))

    def root(self, length: float) -> Floats:
        """Return a root of the prior covariance of size one, of which a length changes nothing."""
        return np.eye(self.count)

    def at(self, time: Floats) -> Floats:
        """Return the indicator of each pose, shape (n, m), at numbers of poses."""
        found: Floats = np.eye(self.count)[np.rint(time).astype(int)]
        return found

    def fine(self, policy: LawPolicy) -> Floats:
        """Return the poses."""
        return self.places


Basis = TimeBasis | PoseBasis


def basis_of(problem: Problem, name: str, policy: LawPolicy, start: float = np.inf) -> Basis:
    """Return the basis over the rows of a record, of a motion from `start` [s] if that is earlier."""
    record = problem.records[name]
    if record.kind == "static":
        return PoseBasis(len(record.poses))
    times = [rows.time for rows in problem.rows_of(name)]
    first = min(start, *(float(t[0]) for t in times))
    return TimeBasis.over(first, max(float(t[-1]) for t in times), policy)
