r"""Maximum a posteriori estimates of all free parameters together, and their covariance.

With residuals r over their noise, weights W of the rows and the normal prior of u,

.. math:: \min_u \; r(u)^T W r(u) + (u - c)^T P (u - c)                                                (1)

is solved by Levenberg-Marquardt steps [Marquardt1963]. Each takes all derivatives J of the model at hand, or
those of the step before where they foretold it,

.. math:: (H + \lambda \, \mathrm{diag} H) \Delta u = -(J^T W r + P (u - c)), \quad H = J^T W J + P   (2)

with lambda = 0 first. Where derivatives miss more than a part of what a step changes, another one with the
same J follows it, which bends it along a curved valley of (1): stiffness and modulus that share a
compliance have one. An estimation ends where a step moves nothing by more than a fifth of its sigma, and
lowers (1) by less than the square of that. W is that of `diagnosis.discrepancy`, eq. (4): where a gap stays,
rows count for as much as they leave, and priors count as they should. Estimates err by what all errors do to
them, as in a diagnosis (`diagnosis.uncertainty`):

.. math:: V = H^{-1} (J^T W C W J + P) H^{-1} + \frac{1}{K} \sum_k (H^{-1} J^T W e_k)(H^{-1} J^T W e_k)^T (3)

with C of noise and discrepancy, and e_k what draws of input noise move; errors of the simulation come on top.

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
from flexarm.diagnosis.evidence import discrepancies_of, simulation_errors
from flexarm.diagnosis.fit import FIT_ERRORS, NormalEquations, Projection
from flexarm.diagnosis.noise_model import input_noise_errors
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.residual_rows import is_non_smooth
from flexarm.diagnosis.uncertainty import robust_covariance, surrogates

Tell = Callable[[str], object]


@dataclass(eq=False)
class Estimation:
    """A model with free parameters beside records."""

    problem: Problem
    arm: Arm
    """The model, which has all effects that parameters belong to."""
    parameters: tuple[FreeParameter, ...]
    """In the order of u."""
    families: tuple[Family, ...]
    """Some of the parameters, by family."""
    policy: CalibrationPolicy
    """When an estimate is at rest."""

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
            found[self.columns(family)] = family.hyperprior[0]
        return found

    def precision(self) -> Floats:
        """Return P of (1)."""
        found = np.diag([1 / parameter.sigma**2 for parameter in self.parameters])
        for family in self.families:
            columns = self.columns(family)
            found[np.ix_(columns, columns)] = family.precision()
        return found

    def columns(self, family: Family) -> list[int]:
        """Return the places of a family's members in u."""
        keys = [parameter.key for parameter in self.parameters]
        return [keys.index(member.key) for member in family.members]

    def shared_columns(self) -> Floats:
        """Return A, with one shared size a family."""
        shared = [self.columns(family) for family in self.families if family.shared]
        taken = {k for columns in shared for k in columns}
        groups = [*shared, *([k] for k in range(len(self.parameters)) if k not in taken)]
        found = np.zeros((len(self.parameters), len(groups)))
        for j, columns in enumerate(groups):
            found[columns, j] = 1.0
        return found

    def linearised(self, u: Floats) -> Point:
        """Return residual and derivatives about u."""
        arm = self.model(u)
        steps = {p.key: p.step for p in self.parameters if p.step is not None}
        jacobian = self.problem.jacobian(arm, [parameter.key for parameter in self.parameters], steps)
        jacobian *= [parameter.slope(float(x)) for parameter, x in zip(self.parameters, u, strict=True)]
        return Point(u, self.residual(u, jacobian), jacobian, input_noise_errors(self.problem, arm))

    def residual(self, u: Floats, jacobian: Floats) -> Floats:
        """Return r of (1), with what time steps miss, and what belongs to records in proportion."""
        arm = self.model(u)
        own = [k for k, parameter in enumerate(self.parameters) if parameter.of_record]
        found: Floats = self.problem.residual(arm) + self.problem.correction(arm)
        return found + jacobian[:, own] @ (u - self.centre)[own]

    def with_spreads(self, u: Floats, variance: Floats) -> Estimation:
        """Return the same with spreads of families about estimates with these variances."""
        places = [self.columns(family) for family in self.families]
        families = (
            family.with_spread(u[columns], variance[columns])
            for family, columns in zip(self.families, places, strict=True)
        )
        return replace(self, families=tuple(families))

    def weighting(self, residual: Floats, input_errors: Floats) -> Weighting:
        """Return W of (1) and C of (3), given what is left."""
        left = discrepancies_of(residual, self.problem, is_non_smooth(self.arm), input_errors)
        return Weighting(self.problem, left, input_errors)


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
        found = np.empty_like(values)
        for (_, where), each in zip(self.problem.channels(), self.discrepancies, strict=True):
            found[where] = each.weighted(values[where])
        return found

    def covariance_times(self, values: Floats) -> Floats:
        """Return C times values of shape (n, ...)."""
        found = np.empty_like(values)
        for (_, where), each in zip(self.problem.channels(), self.discrepancies, strict=True):
            found[where] = each.times(values[where])
        return found

    def covariance(self, jacobian: Floats, prior: Floats, inverse: Floats) -> Floats:
        """Return V of (3) from J, P and H^-1."""
        weighted = self.root(self.root(jacobian))
        found = robust_covariance(
            weighted, self.covariance_times(weighted), prior, inverse, self.input_errors
        )
        size = simulation_errors(self.problem, False)
        return found + np.diag(surrogates(self.problem, jacobian, weighted @ inverse, size) ** 2)


@dataclass(frozen=True, eq=False)
class Point:
    """A linearisation: u, r and J of (2); J and e_k may be those of a model nearby."""

    u: Floats
    residual: Floats
    jacobian: Floats
    input_errors: Floats
    """e_k of (3), shape (draws, n)."""
    exact: bool = True


@dataclass(frozen=True, eq=False)
class Posterior:
    """Estimates and their covariance, a normal posterior about the most probable values."""

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
    def converged(self) -> bool:
        """Return True if the last step moved nothing by more than a fifth of its sigma."""
        return float(np.abs(self.last_move).max(initial=0.0)) < self.estimation.policy.tolerance


def best_start(estimation: Estimation, u: Floats, tell: Tell) -> Floats:
    """Return u with the shared sizes of families at the best of some tried ones, one after the other.

    All else is fitted along to first order.
    """
    for family in (family for family in estimation.families if family.shared):
        tell(f"sizes of {family.effect}")
        columns = estimation.columns(family)
        others = [k for k in range(len(u)) if k not in columns]
        jacobian = estimation.linearised(u).jacobian
        sigma = np.array([estimation.parameters[k].sigma for k in others])
        projection = Projection(jacobian[:, others], sigma)
        factor = estimation.policy.range_factor
        sizes = np.geomspace(family.prior.low / factor, family.prior.high * factor, estimation.policy.sizes)
        tried = []
        for size in np.log(sizes):
            there = u.copy()
            there[columns] = size
            try:
                left = projection.project(estimation.residual(there, jacobian))
            except FIT_ERRORS:
                continue
            tried.append((float(left @ left), there))
        u = min(tried, key=lambda each: each[0], default=(0.0, u))[1]
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
        ahead = _step(point, weighting, P, centre, A, 0.0)
        weighting = estimation.weighting(point.residual + point.jacobian @ ahead, point.input_errors)
        inverse = A @ NormalEquations.of(weighting.root(point.jacobian @ A), A.T @ P @ A).inverse() @ A.T
        covariance = weighting.covariance(point.jacobian, P, inverse)
        move, there, lowered = _damped_step(estimation, point, weighting, P, centre, A)
        sigmas = move / np.sqrt(np.maximum(np.diag(covariance), 1e-300))
        found = Posterior(estimation, point, weighting, inverse, covariance, sigmas, count)
        largest = float(np.abs(sigmas).max(initial=0.0))
        left = float(np.sqrt(np.mean(point.residual**2)))
        tell(f"step {count}: {left:.3g} times the noise, moves by {largest:.2g} sigma")
        rests = largest < policy.tolerance and lowered < policy.tolerance**2
        if (rests and point.exact) or count == policy.iterations:
            break
        if not allows("the estimates came to rest"):
            break
        kept = not rests and _is_linear(point, move, there, policy.linearisation_error)
        u = point.u + move
        point = replace(point, u=u, residual=there, exact=False) if kept else estimation.linearised(u)
        if basis is None:
            estimation = estimation.with_spreads(u, np.diag(covariance))
    return found


def _is_linear(point: Point, move: Floats, there: Floats, part: float) -> bool:
    """Return True if derivatives missed no more than a part of what a step changed."""
    missed = there - point.residual - point.jacobian @ move
    return float(missed @ missed) < part**2 * float(np.sum((there - point.residual) ** 2))


def _step(point: Point, weighting: Weighting, P: Floats, centre: Floats, A: Floats, damping: float) -> Floats:
    """Return du of (2)."""
    jacobian = weighting.root(point.jacobian @ A)
    held = A.T @ P @ A
    if damping > 0:
        held = held + damping * np.diag(np.sum(jacobian**2, axis=0) + np.diag(held))
    gradient = jacobian.T @ weighting.root(point.residual) + A.T @ (P @ (point.u - centre))
    return -A @ NormalEquations.of(jacobian, held).solved(gradient)


def _damped_step(
    estimation: Estimation, point: Point, weighting: Weighting, P: Floats, centre: Floats, A: Floats
) -> tuple[Floats, Floats, float]:
    """Return the least damped step of (2) that does not lead up, r after it, and by how much it lowers (1).

    The step is none where all lead up.
    """
    policy = estimation.policy
    logarithmic = np.array([parameter.scale == "log" for parameter in estimation.parameters])

    def cost(u: Floats, residual: Floats) -> float:
        return float(np.sum(weighting.root(residual) ** 2) + (u - centre) @ P @ (u - centre))

    here, damping = cost(point.u, point.residual), 0.0
    for _ in range(policy.trials):
        step = _step(point, weighting, P, centre, A, damping)
        longest = float(np.abs(step[logarithmic]).max(initial=0.0))
        step *= min(1.0, policy.longest_step / max(longest, 1e-300))
        tried = []
        with suppress(*FIT_ERRORS):
            residual = estimation.residual(point.u + step, point.jacobian)
            tried.append((cost(point.u + step, residual), step, residual))
            if not _is_linear(point, step, residual, policy.linearisation_error):
                from_there = replace(point, u=point.u + step, residual=residual)
                bent = step + _step(from_there, weighting, P, centre, A, damping)
                residual = estimation.residual(point.u + bent, point.jacobian)
                tried.append((cost(point.u + bent, residual), bent, residual))
        best, step, residual = min(tried, key=lambda each: each[0], default=(np.inf, step, point.residual))
        if best <= here:
            return step, residual, here - best
        damping = 10 * damping or policy.damping
    return np.zeros_like(point.u), point.residual, 0.0


def estimates_from_shared_sizes(estimation: Estimation, u: Floats, tell: Tell) -> list[Posterior]:
    """Return the estimate with one shared size a family, if there are families, and that of all members."""
    found: list[Posterior] = []
    if any(family.shared for family in estimation.families):
        u = best_start(estimation, u, tell)
        rules = estimation.policy
        brief = replace(rules, tolerance=rules.tolerance_first, iterations=rules.iterations_first)
        start = replace(estimation, policy=brief)
        found.append(
            estimate(start, u, lambda what: tell(f"shared sizes, {what}"), estimation.shared_columns())
        )
        u = found[-1].point.u
    found.append(estimate(estimation, u, tell))
    return found
