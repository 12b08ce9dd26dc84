"""Effects fitted through the full simulation: the least-squares problem, and the derivatives that solve it.

    min over z of  C(r(z)) + sum_i ln(1 + (z_i/3)^2)                                                   (1)

z are the effects' parameters on the scales of their priors (`diagnosis.candidate`), C the residual that
clocks, frames and nominal values cannot explain (`diagnosis.fit`). The prior is widened to a third of its
weight and has Student's wide tails, since it need not know this machine: it keeps what the data do not
determine, such as a damping, at plausible values, and hardly moves what they do.

SciPy's least_squares solves (1) within bounds. Its derivatives come from a model that was fitted nearby, or
from finite steps, as laws that are not smooth need them, and from there on from Broyden's update
[Broyden1965] while that predicts what a step does,

    J' = J + (r(z') - r(z) - J dz) dz^T/|dz|^2,   dz = z' - z                                          (2)

A fit that does not come near another model is terminated early: if (1) would stay above a limit even if it
fell once more by twice its last fall, or by twice the predicted one.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.budget import allows
from flexarm.diagnosis.candidate import Candidate, TransformedParameter, members_at, prior_rows
from flexarm.diagnosis.fit import Projection
from flexarm.diagnosis.policy import FIT
from flexarm.errors import InvalidParameter, NotConverged

if TYPE_CHECKING:
    from flexarm.diagnosis.estimator import Estimator
    from flexarm.diagnosis.fit import Fit


class _Terminated(Exception):
    """Ends a fit that stays above its limit."""


class LeastSquares:
    """Rows of (1) and their derivatives, with all evaluations cached.

    A model that cannot be simulated counts as so far off that a step there is taken back. The first
    derivatives are those of `nearby`, a fit with some of the effects. `terminated` is True after early
    termination, above the limit.
    """

    def __init__(
        self,
        estimator: Estimator,
        members: tuple[Candidate, ...],
        parameters: tuple[TransformedParameter, ...],
        projection: Projection,
        nearby: Fit | None = None,
    ) -> None:
        self.estimator, self.members = estimator, members
        self.parameters, self.projection, self.nearby = parameters, projection, nearby
        self._raw: dict[bytes, Floats] = {}
        self._slopes: dict[bytes, Floats] = {}
        self._differences: dict[bytes, Floats] = {}
        self._last: Floats | None = None
        self._least, self._limit, self.terminated = inf, inf, False

    def solve(self, start: Floats, limit: float = inf) -> Floats:
        """Return z at the minimum of (1) within the bounds, or where the fit was terminated early.

        Raise NotConverged or InvalidParameter if the start cannot be simulated.
        """
        from scipy.optimize import least_squares

        self.residual(start)  # raises if the start cannot be simulated
        if not self.parameters:
            return start
        bounds = np.array([c.bound for c in self.parameters])
        finest = float(min(self._steps(start) / [c.widest_step for c in self.parameters]))
        self._limit = limit
        try:
            found = least_squares(
                self.objective_rows,
                np.clip(start, -0.99 * bounds, 0.99 * bounds),
                self.objective_jacobian,
                bounds=(-bounds, bounds),
                x_scale=1.0,
                max_nfev=FIT.evaluations,
                ftol=FIT.tolerance * 1e-1,
                xtol=FIT.tolerance * finest,
                gtol=1e-12,
            )
        except _Terminated:
            self.terminated = True
            assert self._last is not None
            return self._last
        return np.asarray(found.x)

    def z_of(self, members: Sequence[Candidate]) -> Floats:
        """Return the parameters z of effects."""
        return np.array([c.z(members[c.candidate].value_of(c.name)) for c in self.parameters])

    def members_at(self, z: Floats) -> tuple[Candidate, ...]:
        """Return the effects with these parameters."""
        return members_at(self.members, self.parameters, z)

    def residual(self, z: Floats) -> Floats:
        """Return residuals of the model."""
        key = z.tobytes()
        if key not in self._raw:
            self._raw[key] = self.estimator.residual(self.members_at(z))
        return self._raw[key]

    def objective_rows(self, z: Floats) -> Floats:
        """Rows of (1); where nothing can be simulated, the sum is so large that the step is taken back."""
        try:
            rest = self.projection.project(self.residual(z))
        except (NotConverged, InvalidParameter):
            return np.full(len(self.estimator.problem) + self.projection.added + len(z), 1e4)
        return np.concatenate([rest, prior_rows(self.parameters, z)[0]])

    def objective_jacobian(self, z: Floats) -> Floats:
        """Return derivatives of the rows; a fit that would stay above its limit is terminated here."""
        found = np.vstack(
            [self.projection.project(self.jacobian_at(z)), np.diag(prior_rows(self.parameters, z)[1])]
        )
        if self._limit < inf:
            self._terminate_if_far(self.objective_rows(z), found)
        if not allows("all fits had come to rest"):
            raise _Terminated
        return found

    def _terminate_if_far(self, rows: Floats, jacobian: Floats) -> None:
        least = float(rows @ rows)
        ahead = rows + jacobian @ np.linalg.lstsq(jacobian, -rows, rcond=None)[0]
        falls = max(self._least - least, least - float(ahead @ ahead))  # the first fall is not known: inf
        self._least = least
        if least - FIT.further_fall * falls > self._limit:
            raise _Terminated

    def jacobian_at(self, z: Floats) -> Floats:
        """Return derivatives of the residuals by z, eq. (2) where that is enough."""
        key = z.tobytes()
        if key not in self._slopes:
            found = self._at_start(z) if self._last is None else self._updated(z)
            self._slopes[key] = self.differences(z) if found is None else found
        self._last = z.copy()
        return self._slopes[key]

    def _at_start(self, z: Floats) -> Floats | None:
        """Return the first derivatives, of the model nearby where it has some; None where it has none."""
        taken = self._reused(z)
        if not taken:
            return None
        if (exact := self._exact(z)) is not None:
            return exact
        fresh = [k for k in range(len(z)) if k not in taken]
        columns = taken | dict(zip(fresh, self._columns(z, fresh).T, strict=True))
        return np.stack([columns[k] for k in range(len(z))], axis=1)

    def _reused(self, z: Floats) -> dict[int, Floats]:
        """Return derivatives by parameters that are the same, or nearly, in the model nearby."""
        if self.nearby is None:
            return {}
        there = {self.nearby.key(k): k for k in range(len(self.nearby.z))}
        found = {}
        for k, parameter in enumerate(self.parameters):
            i = there.get((*self.members[parameter.candidate].place, parameter.name))
            if i is not None and abs(z[k] - self.nearby.z[i]) < FIT.reused_within:
                found[k] = self.nearby.jacobian[:, i]
        return found

    def _updated(self, z: Floats) -> Floats | None:
        """Eq. (2) from the last derivatives; None where they predicted too little.

        A single difference costs as little.
        """
        assert self._last is not None
        if len(z) == 1:
            return None
        jacobian, dz = self._slopes[self._last.tobytes()], z - self._last
        step = self.residual(z) - self.residual(self._last)
        missed = step - jacobian @ dz
        if float(missed @ missed) > FIT.step_missed**2 * float(step @ step):
            return None
        return jacobian + np.outer(missed, dz / float(dz @ dz))  # eq. (2)

    def differences(self, z: Floats) -> Floats:
        """Return derivatives from finite steps, forward or backward where there is room."""
        key = z.tobytes()
        if key not in self._differences:
            exact = self._exact(z)
            self._differences[key] = self._columns(z, range(len(z))) if exact is None else exact
        return self._differences[key]

    def _columns(self, z: Floats, which: Sequence[int]) -> Floats:
        """Differences by some parameters, shape (n, len(which))."""
        here, steps = self.residual(z), self._steps(z)
        ahead = z + np.diag(steps)
        models = (self._arm(ahead[k]) for k in which)
        self.estimator.problem.prepare(arm for arm in models if arm is not None)
        columns = [self._column(z, k, float(steps[k]), here) for k in which]
        return np.stack(columns, axis=1) if columns else np.empty((len(here), 0))

    def _arm(self, z: Floats) -> Arm | None:
        try:
            return self.estimator.with_effects(self.members_at(z))
        except InvalidParameter:
            return None

    def _exact(self, z: Floats) -> Floats | None:
        """Return the same of smooth laws in poses, which have derivatives of their own."""
        keys = [self.members[c.candidate].keys_of(c.name) for c in self.parameters]
        arm = self._arm(z)
        if not keys or arm is None or not all(c.smooth for c in self.parameters):
            return None
        found = self.estimator.problem.static_jacobian(arm, [key for each in keys for key in each])
        if found is None:
            return None
        first = np.cumsum([0, *(len(each) for each in keys[:-1])])
        slope = [c.slope(float(x)) for c, x in zip(self.parameters, z, strict=True)]
        return np.asarray(np.add.reduceat(found, first, axis=1)) * slope

    def _steps(self, z: Floats) -> Floats:
        seconds = self.estimator.problem.seconds
        return np.array([c.step(float(x), seconds) for c, x in zip(self.parameters, z, strict=True)])

    def _column(self, z: Floats, k: int, ahead: float, here: Floats) -> Floats:
        for step in (ahead, -ahead):
            there = z.copy()
            there[k] += step
            try:
                found: Floats = (self.residual(there) - here) / step
            except (NotConverged, InvalidParameter):
                continue
            return found
        return np.zeros_like(here)
