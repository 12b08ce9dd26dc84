r"""Maximum a posteriori estimates of all free parameters together, and their covariance.

With residuals r over their noise, weights W of the rows and the normal prior of u, the objective

.. math:: \min_u \; r(u)^T W r(u) + (u - c)^T P (u - c)                                                (1)

is minimised by Levenberg-Marquardt steps [Marquardt1963],

.. math:: (H + \lambda \, \mathrm{diag} H) \Delta u = -(J^T W r + P (u - c)), \quad H = J^T W J + P   (2)

with lambda = 0 first. The Jacobian J of a step serves the next one too where it predicted the change of r.
Where it did not, a second step with the same J follows, which bends the path along a curved valley of (1):
stiffness and modulus that share a compliance have one. An estimate has converged where a step moves nothing
by more than a fifth of its sigma and lowers the objective by less than the square of that. W is that of
`calibration.discrepancy`, eq. (4). The covariance of the estimates contains all errors, as in a diagnosis
(`diagnosis.uncertainty`):

.. math:: V = H^{-1} (J^T W C W J + P) H^{-1} + \frac{1}{K} \sum_k (H^{-1} J^T W e_k)(H^{-1} J^T W e_k)^T (3)

with C of noise and discrepancy, and e_k the responses to draws of input noise.

With a basis A, steps are du = A dv: a family with one shared size has one column. Its spread is estimated
along with the members after that (`calibration.optimum`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.parameter import with_value
from flexarm.arrays import Floats
from flexarm.budget import allows
from flexarm.calibration.discrepancy import Channel, Process, channels_of
from flexarm.calibration.families import Family
from flexarm.calibration.parameters import FreeParameter
from flexarm.calibration.policy import CalibrationPolicy
from flexarm.diagnosis.fit import FIT_ERRORS, NormalEquations
from flexarm.diagnosis.noise_model import input_noise_errors
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.residual_rows import is_non_smooth
from flexarm.diagnosis.uncertainty import robust_covariance

if TYPE_CHECKING:
    from flexarm.calibration.valley import Valley

Tell = Callable[[str], object]
"""Gets what is being done."""
REST = "the estimates came to rest"
"""What a budget of time may end before."""


@dataclass(eq=False)
class Estimation:
    """Objective (1): a problem, a model with free parameters, and their priors."""

    problem: Problem
    arm: Arm
    """The model, with all effects that parameters belong to."""
    parameters: tuple[FreeParameter, ...]
    """In the order of u."""
    families: tuple[Family, ...]
    """Some of the parameters, by family."""
    policy: CalibrationPolicy
    """Tolerances and limits of the steps."""
    white: bool = False
    """True if the model's discrepancy has no correlation."""

    def model(self, u: Floats) -> Arm:
        """Return the arm with these values."""
        arm = self.arm
        for parameter, x in zip(self.parameters, u, strict=True):
            if not parameter.of_record:
                arm = with_value(arm, parameter.key, parameter.value(float(x)))
        return arm

    @property
    def centre(self) -> Floats:
        """Return c of (1)."""
        found = np.array([parameter.centre for parameter in self.parameters])
        for family in self.families:
            found[self.columns(family)] = family.hierarchy.hyperprior[0]
        return found

    def precision(self) -> Floats:
        """Return P of (1)."""
        found = np.diag([1 / parameter.sigma**2 for parameter in self.parameters])
        for family in self.families:
            columns = self.columns(family)
            found[np.ix_(columns, columns)] = family.hierarchy.precision(len(columns))
        return found

    def columns(self, family: Family) -> list[int]:
        """Return the places of a family's members in u."""
        keys = [parameter.key for parameter in self.parameters]
        return [keys.index(member.key) for member in family.members]

    def shared_columns(self) -> Floats:
        """Return A, with one shared size a family."""
        shared = [self.columns(family) for family in self.families if family.hierarchy.has_mean]
        taken = {k for columns in shared for k in columns}
        groups = [*shared, *([k] for k in range(len(self.parameters)) if k not in taken)]
        found = np.zeros((len(self.parameters), len(groups)))
        for j, columns in enumerate(groups):
            found[columns, j] = 1.0
        return found

    def linearised(self, u: Floats) -> Point:
        """Return residual and Jacobian at u."""
        arm = self.model(u)
        steps = {p.key: p.step for p in self.parameters if p.step is not None}
        jacobian = self.problem.jacobian(arm, [parameter.key for parameter in self.parameters], steps)
        jacobian *= [parameter.slope(float(x)) for parameter, x in zip(self.parameters, u, strict=True)]
        return Point(u, self.residual(u, jacobian), jacobian, input_noise_errors(self.problem, arm))

    def residual(self, u: Floats, jacobian: Floats) -> Floats:
        """Return r of (1), with the discretisation error; parameters of records act linearly."""
        arm = self.model(u)
        own = [k for k, parameter in enumerate(self.parameters) if parameter.of_record]
        found: Floats = self.problem.residual(arm) + self.problem.correction(arm)
        return found + jacobian[:, own] @ (u - self.centre)[own]

    def with_spreads(self, u: Floats, variance: Floats) -> Estimation:
        """Return the same with spreads of families given estimates u and their variances."""
        families = []
        for family in self.families:
            columns = self.columns(family)
            families.append(
                replace(family, hierarchy=family.hierarchy.updated(u[columns], variance[columns]))
            )
        return replace(self, families=tuple(families))

    def weighting(self, residual: Floats, input_errors: Floats, spread: Floats) -> Weighting:
        """Return W of (1) and C of (3) given a residual that has a spread J R, R R^T = H^-1."""
        channels = channels_of(self.problem, is_non_smooth(self.arm), input_errors, self.white)
        places = [where for _, where in self.problem.channels()]
        return Weighting.of(places, channels, residual, input_errors, spread)


@dataclass(frozen=True, eq=False)
class Weighting:
    """Deviance of residuals, W of (1) and C of (3)."""

    places: Sequence[slice]
    """Rows of each channel."""
    channels: Sequence[Channel]
    hidden: Sequence[Floats]
    """Expected squares that the estimates hide, of each channel."""
    processes: Sequence[Process]
    input_errors: Floats
    """e_k of (3), shape (draws, n)."""

    @classmethod
    def of(
        cls,
        places: Sequence[slice],
        channels: Sequence[Channel],
        residual: Floats,
        input_errors: Floats,
        spread: Floats,
    ) -> Weighting:
        """Return the weighting of channels given a residual that has a spread J R, R R^T = H^-1."""
        hidden = [each.transform.squares(spread[where]) for each, where in zip(channels, places, strict=True)]
        found = cls(places, channels, hidden, (), input_errors)
        processes = [each.process(squares) for each, squares in found.squares(residual)]
        return replace(found, processes=tuple(processes))

    def squares(self, residual: Floats) -> Iterator[tuple[Channel, Floats]]:
        """Yield each channel with expected squares of a residual of shape (n,)."""
        for each, where, hidden in zip(self.channels, self.places, self.hidden, strict=True):
            yield each, each.transform.squares(residual[where]) + hidden

    def root(self, values: Floats) -> Floats:
        """Return the root of W times values of shape (n, ...)."""
        found = np.empty_like(values)
        for each, where in zip(self.processes, self.places, strict=True):
            found[where] = each.root(values[where])
        return found

    def times(self, values: Floats) -> Floats:
        """Return C times values of shape (n, ...)."""
        found = np.empty_like(values)
        for each, where in zip(self.processes, self.places, strict=True):
            found[where] = each.times(values[where])
        return found

    def covariance(self, jacobian: Floats, prior: Floats, inverse: Floats) -> Floats:
        """Return V of (3) from J, P and H^-1."""
        weighted = self.root(self.root(jacobian))
        return robust_covariance(weighted, self.times(weighted), prior, inverse, self.input_errors)


@dataclass(frozen=True, eq=False)
class Point:
    """A linearisation: u, r and J of (2)."""

    u: Floats
    residual: Floats
    jacobian: Floats
    input_errors: Floats
    """e_k of (3), shape (draws, n)."""
    exact: bool = True
    """False if J and e_k are those of an earlier point."""


@dataclass(frozen=True, eq=False)
class Posterior:
    """Normal posterior about the most probable values."""

    estimation: Estimation
    """With the families' spreads as estimated."""
    point: Point
    """Where (1) is least."""
    weighting: Weighting
    """W of (1) there."""
    inverse: Floats
    """H^-1 of (2), shape (m, m)."""
    covariance: Floats
    """V of (3), shape (m, m)."""
    last_move: Floats
    """Of the last step, in sigmas, shape (m,)."""
    iterations: int
    """Number of linearisations."""
    valley: Valley | None = None
    """Profile in the worst direction, where that is curved."""

    @property
    def largest_move(self) -> float:
        """Return the greatest move of the last step [sigma]."""
        return float(np.abs(self.last_move).max(initial=0.0))

    @property
    def at_rest(self) -> bool:
        """Return True if the last step moved nothing beyond the tolerance."""
        return self.largest_move < self.estimation.policy.tolerance

    @property
    def inflation(self) -> Floats:
        """Return the long-run variance of each channel's noise and discrepancy over that of the noise."""
        return np.array([each.level for each in self.weighting.processes])

    @property
    def leaves_gap(self) -> bool:
        """Return True if some channel's residual exceeds its noise."""
        return bool(self.inflation.max(initial=0.0) > self.estimation.policy.inflated)

    @property
    def negligible(self) -> float:
        """Return the fall of (1) that estimates at rest may miss."""
        return len(self.point.u) * self.estimation.policy.tolerance**2

    def objective(self, u: Floats, residual: Floats | None = None) -> float:
        """Return (1) with W of this posterior."""
        r = self.estimation.residual(u, self.point.jacobian) if residual is None else residual
        moved = u - self.estimation.centre
        return float(np.sum(self.weighting.root(r) ** 2)) + float(moved @ self.estimation.precision() @ moved)


def estimate(estimation: Estimation, u: Floats, tell: Tell, basis: Floats | None = None) -> Posterior:
    """Return where (1) is least, from u on, shape (m,).

    Steps are combinations of the columns of `basis`, shape (m, k), and spreads stay; default: all steps.

    Raise NotConverged or InvalidParameter if the start cannot be simulated.
    """
    policy, centre = estimation.policy, estimation.centre
    A = np.eye(len(u)) if basis is None else basis
    point, spread = estimation.linearised(u), np.zeros((len(estimation.problem), 1))
    for count in range(1, policy.iterations + 1):
        P = estimation.precision()
        weighting = estimation.weighting(point.residual, point.input_errors, spread)
        step = _step(point, weighting, P, centre, A, 0.0)
        weighting = estimation.weighting(point.residual + point.jacobian @ step, point.input_errors, spread)
        R = A @ NormalEquations.of(weighting.root(point.jacobian @ A), A.T @ P @ A).root()
        inverse, spread = R @ R.T, point.jacobian @ R
        covariance = weighting.covariance(point.jacobian, P, inverse)
        step, residual, lowered = damped_step(estimation, point, weighting, P, centre, A)
        sigmas = step / np.sqrt(np.maximum(np.diag(covariance), 1e-300))
        found = Posterior(estimation, point, weighting, inverse, covariance, sigmas, count)
        rms = float(np.sqrt(np.mean(point.residual**2)))
        tell(f"step {count}: {rms:.3g} times the noise, moves by {found.largest_move:.2g} sigma")
        converged = found.largest_move < policy.tolerance and lowered < policy.tolerance**2
        if (converged and point.exact) or count == policy.iterations:
            break
        if not allows(REST):
            break
        linear = not converged and _is_linear(point, step, residual, policy)
        u = point.u + step
        point = replace(point, u=u, residual=residual, exact=False) if linear else estimation.linearised(u)
        if basis is None:
            estimation = estimation.with_spreads(u, np.diag(covariance))
    return found


def _is_linear(point: Point, step: Floats, residual: Floats, policy: CalibrationPolicy) -> bool:
    """Return True if J missed no more than a small part of what a step changed."""
    change = residual - point.residual
    missed = change - point.jacobian @ step
    return float(missed @ missed) < policy.linearisation_error**2 * float(np.sum(change**2))


def _step(point: Point, weighting: Weighting, P: Floats, centre: Floats, A: Floats, damping: float) -> Floats:
    """Return du of (2)."""
    jacobian = weighting.root(point.jacobian @ A)
    precision = A.T @ P @ A
    if damping > 0:
        precision = precision + damping * np.diag(np.sum(jacobian**2, axis=0) + np.diag(precision))
    gradient = jacobian.T @ weighting.root(point.residual) + A.T @ (P @ (point.u - centre))
    return -A @ NormalEquations.of(jacobian, precision).solved(gradient)


def damped_step(
    estimation: Estimation, point: Point, weighting: Weighting, P: Floats, centre: Floats, A: Floats
) -> tuple[Floats, Floats, float]:
    """Return the least damped step of (2) that does not raise (1), r after it, and by how much (1) falls.

    The step is zero where all raise it.
    """
    policy = estimation.policy
    logarithmic = np.array([parameter.scale == "log" for parameter in estimation.parameters])

    def objective(u: Floats, residual: Floats) -> float:
        return float(np.sum(weighting.root(residual) ** 2) + (u - centre) @ P @ (u - centre))

    def limited(step: Floats) -> Floats:
        longest = float(np.abs(step[logarithmic]).max(initial=0.0))
        return step * min(1.0, policy.longest_step / max(longest, 1e-300))

    before, damping = objective(point.u, point.residual), 0.0
    for _ in range(policy.trials):
        step = limited(_step(point, weighting, P, centre, A, damping))
        tried = [(np.inf, step, point.residual)]
        with suppress(*FIT_ERRORS):
            residual = estimation.residual(point.u + step, point.jacobian)
            tried.append((objective(point.u + step, residual), step, residual))
            if not _is_linear(point, step, residual, policy):
                moved = replace(point, u=point.u + step, residual=residual)
                bent = step + limited(_step(moved, weighting, P, centre, A, damping))
                residual = estimation.residual(point.u + bent, point.jacobian)
                tried.append((objective(point.u + bent, residual), bent, residual))
        least, step, residual = min(tried, key=lambda each: each[0])
        if least <= before:
            return step, residual, before - least
        damping = 10 * damping or policy.damping
    return np.zeros_like(point.u), point.residual, 0.0
