"""Bases of latent motions over a record: cubic B-splines in time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.missing_law.policy import LawPolicy

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

DEGREE = 3
"""Degree of the B-splines."""


@dataclass(frozen=True, eq=False)
class TimeBasis:
    """Cubic B-splines over the time of a record.

    Attributes
    ----------
    knots : ndarray, shape (m + 4,)
        With their ends repeated [s].
    """

    knots: Floats

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
