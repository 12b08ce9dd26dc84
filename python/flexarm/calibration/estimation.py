r"""Maximum a posteriori estimates of all free parameters together, and their covariance.

With residuals r over their noise, weights W of the rows and the normal prior of u, the objective

.. math:: \min_u \; r(u)^T W r(u) + (u - c)^T P (u - c)                                                (1)

is minimised by Levenberg-Marquardt steps [Marquardt1963],

.. math:: (H + \lambda \, \mathrm{diag} H) \Delta u = -(J^T W r + P (u - c)), \quad H = J^T W J + P   (2)

with lambda = 0 first. The Jacobian J of a step serves the next one too where it predicted the change of r.
Where it did not, a second step with the same J follows, which bends the path along a curved valley of (1):
stiffness and modulus that share a compliance have one. An estimate has converged where a step moves nothing
by more than a fifth of its sigma and lowers (1) by less than the square of that. W is that of
`diagnosis.discrepancy`, eq. (4). The covariance of the estimates contains all errors, as in a diagnosis
(`diagnosis.uncertainty`):

.. math:: V = H^{-1} (J^T W C W J + P) H^{-1} + \frac{1}{K} \sum_k (H^{-1} J^T W e_k)(H^{-1} J^T W e_k)^T (3)

with C of noise and discrepancy, and e_k the responses to draws of input noise; errors of the simulation come
on top.

A family is fitted with one shared size first: du = A dv, with a column of A for the family and one for each
other parameter. Its spread is estimated along with the members after that.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.parameter import with_value
from flexarm.arrays import Floats
from flexarm.budget import allows
from flexarm.calibration.families import Family
from flexarm.calibration.parameters import FreeParameter
from flexarm.calibration.policy import CalibrationPolicy
from flexarm.diagnosis.discrepancy import Discrepancy
from flexarm.diagnosis.evidence import by_channel, discrepancies_of, simulation_errors
from flexarm.diagnosis.fit import FIT_ERRORS, NormalEquations, Projection
from flexarm.diagnosis.noise_model import input_noise_errors
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.residual_rows import is_non_smooth
from flexarm.diagnosis.uncertainty import robust_covariance, surrogates

Tell = Callable[[str], object]
"""Gets what is being done."""


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
        shared = [self.columns(family) for family in self.families if family.hierarchy.shared]
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

    def weighting(self, residual: Floats, input_errors: Floats) -> Weighting:
        """Return W of (1) and C of (3), given a residual."""
        discrepancies = discrepancies_of(residual, self.problem, is_non_smooth(self.arm), input_errors)
        return Weighting(self.problem, discrepancies, input_errors)


@dataclass(frozen=True, eq=False)
class Weighting:
    """W of (1) and C of (3)."""

    problem: Problem
    discrepancies: tuple[Discrepancy, ...]
    """Of each channel."""
    input_errors: Floats
    """e_k of (3), shape (draws, n)."""

    def root(self, values: Floats) -> Floats:
        """Return the root of W times values of shape (n, ...)."""
        return by_channel(lambda each, rows: each.weighted(rows), values, self.problem, self.discrepancies)

    def robust(self, jacobian: Floats, prior: Floats, inverse: Floats) -> Floats:
        """Return V of (3) from J, P and H^-1, without errors of the simulation."""
        weighted = self.root(self.root(jacobian))
        correlated = by_channel(
            lambda each, rows: each.times(rows), weighted, self.problem, self.discrepancies
        )
        return robust_covariance(weighted, correlated, prior, inverse, self.input_errors)

    def covariance(self, jacobian: Floats, prior: Floats, inverse: Floats) -> Floats:
        """Return V of (3) from J, P and H^-1."""
        size = simulation_errors(self.problem, False)
        depends = self.root(self.root(jacobian)) @ inverse
        errors = surrogates(self.problem, jacobian, depends, size)
        return self.robust(jacobian, prior, inverse) + np.diag(errors**2)


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

    @property
    def largest_move(self) -> float:
        """Return the greatest move of the last step [sigma]."""
        return float(np.abs(self.last_move).max(initial=0.0))

    @property
    def at_rest(self) -> bool:
        """Return True if the last step moved nothing beyond the tolerance."""
        return self.largest_move < self.estimation.policy.tolerance


def multi_start(estimation: Estimation, u: Floats, tell: Tell) -> Floats:
    """Return u with the shared size of each family in turn at the best of a grid.

    All else is fitted along to first order.
    """
    policy = estimation.policy
    for family in (family for family in estimation.families if family.hierarchy.shared):
        tell(f"sizes of {family.effect}")
        columns = estimation.columns(family)
        others = [k for k in range(len(u)) if k not in columns]
        jacobian = estimation.linearised(u).jacobian
        sigma = np.array([estimation.parameters[k].sigma for k in others])
        projection = Projection(jacobian[:, others], sigma)
        prior = family.hierarchy.prior
        low, high = prior.low / policy.range_factor, prior.high * policy.range_factor
        tried = [(np.inf, u)]
        for size in np.log(np.geomspace(low, high, policy.sizes)):
            start = u.copy()
            start[columns] = size
            with suppress(*FIT_ERRORS):
                rest = projection.project(estimation.residual(start, jacobian))
                tried.append((float(rest @ rest), start))
        u = min(tried, key=lambda each: each[0])[1]
    return u


def estimate(estimation: Estimation, u: Floats, tell: Tell, basis: Floats | None = None) -> Posterior:
    """Return where (1) is least, from u on, shape (m,).

    Steps are combinations of the columns of `basis`, shape (m, k), and spreads stay; default: all steps.

    Raise NotConverged or InvalidParameter if the start cannot be simulated.
    """
    policy, centre = estimation.policy, estimation.centre
    A = np.eye(len(u)) if basis is None else basis
    point = estimation.linearised(u)
    for count in range(1, policy.iterations + 1):
        P = estimation.precision()
        weighting = estimation.weighting(point.residual, point.input_errors)
        step = _step(point, weighting, P, centre, A, 0.0)
        weighting = estimation.weighting(point.residual + point.jacobian @ step, point.input_errors)
        inverse = A @ NormalEquations.of(weighting.root(point.jacobian @ A), A.T @ P @ A).inverse() @ A.T
        covariance = weighting.covariance(point.jacobian, P, inverse)
        step, residual, lowered = damped_step(estimation, point, weighting, P, centre, A)
        sigmas = step / np.sqrt(np.maximum(np.diag(covariance), 1e-300))
        found = Posterior(estimation, point, weighting, inverse, covariance, sigmas, count)
        rms = float(np.sqrt(np.mean(point.residual**2)))
        tell(f"step {count}: {rms:.3g} times the noise, moves by {found.largest_move:.2g} sigma")
        converged = found.largest_move < policy.tolerance and lowered < policy.tolerance**2
        if (converged and point.exact) or count == policy.iterations:
            break
        if not allows("the estimates came to rest"):
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

    before, damping = objective(point.u, point.residual), 0.0
    for _ in range(policy.trials):
        step = _step(point, weighting, P, centre, A, damping)
        longest = float(np.abs(step[logarithmic]).max(initial=0.0))
        step *= min(1.0, policy.longest_step / max(longest, 1e-300))
        tried = [(np.inf, step, point.residual)]
        with suppress(*FIT_ERRORS):
            residual = estimation.residual(point.u + step, point.jacobian)
            tried.append((objective(point.u + step, residual), step, residual))
            if not _is_linear(point, step, residual, policy):
                moved = replace(point, u=point.u + step, residual=residual)
                bent = step + _step(moved, weighting, P, centre, A, damping)
                residual = estimation.residual(point.u + bent, point.jacobian)
                tried.append((objective(point.u + bent, residual), bent, residual))
        least, step, residual = min(tried, key=lambda each: each[0])
        if least <= before:
            return step, residual, before - least
        damping = 10 * damping or policy.damping
    return np.zeros_like(point.u), point.residual, 0.0


def posterior_of(estimation: Estimation, tell: Tell) -> Posterior:
    """Return the estimate of all parameters; families start from shared sizes."""
    u, policy = estimation.centre, estimation.policy
    if any(family.hierarchy.shared for family in estimation.families):
        u = multi_start(estimation, u, tell)
        brief = replace(policy, tolerance=policy.tolerance_first, iterations=policy.iterations_first)
        start, basis = replace(estimation, policy=brief), estimation.shared_columns()
        u = estimate(start, u, lambda what: tell(f"shared sizes, {what}"), basis).point.u
    return estimate(estimation, u, tell)
