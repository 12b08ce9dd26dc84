"""Estimator: fits to the same records, and the data that they share.

Clocks, frames and nominal values act nearly in proportion. Their derivatives J are therefore taken about one
model and kept, and its residuals are corrected for their discretisation error, c. With the nuisance
parameters of that model at x0, the residual of any model with effects is, at the centres of their priors,

    r = r(effects, x0) + c - J x0,                                                                     (1)

from which `diagnosis.fit` eliminates them all. An estimator *about* another model has J, x0 and c of that
one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.diagnosis.candidate import Candidate, transformed_parameters, with_members
from flexarm.diagnosis.family import with_spreads
from flexarm.diagnosis.fit import FIT_ERRORS, Fit, Projection, gls_nuisance
from flexarm.diagnosis.least_squares import LeastSquares
from flexarm.diagnosis.nuisance import NuisanceModel
from flexarm.diagnosis.policy import FIT
from flexarm.diagnosis.problem import Problem


@dataclass(eq=False)
class Estimator:
    """Records, nuisance parameters and derivatives at the nominal model, which all fits share."""

    problem: Problem
    """The records."""
    nuisance: NuisanceModel
    """Clocks, frames, nominal values; its `arm` is the nominal model."""
    jacobian: Floats
    """Derivatives of the residual by them, at `at`."""
    at: Floats
    """Values of the nuisance parameters, from the centres of their priors."""
    correction: Floats
    """Added to residuals: the discretisation error, at `at` or near by."""
    corrected: Floats
    """Residual of the model that has this error."""
    members: tuple[Candidate, ...] = ()
    """Effects of the model that derivatives are taken about."""

    def __post_init__(self) -> None:
        self._projections: dict[frozenset[str], tuple[NuisanceModel, Projection]] = {}
        centres = np.array([u.centre for u in self.nuisance.parameters])
        self.arm = self.nuisance.model(self.nuisance.arm, centres + self.at)

    @classmethod
    def nominal(cls, problem: Problem, nuisance: NuisanceModel) -> Estimator:
        """About the nominal model."""
        arm = nuisance.arm
        jacobian = problem.jacobian(arm, nuisance.keys, nuisance.steps(arm))
        nothing = np.zeros(len(nuisance.parameters))
        return cls(problem, nuisance, jacobian, nothing, problem.correction(arm), problem.residual(arm))

    def about(self, fit: Fit, part: float = 1.0) -> Estimator:
        """Return the same about a fitted model, where derivatives are those of the model with its effects.

        Unknowns go `part` of the way to where the fit has them.
        """
        return self._moved(self._found_at(fit, part), fit.members)

    def towards(self, fit: Fit, part: float = 1.0) -> Estimator:
        """Return the same about a fit of the same effects, with the same derivatives if these predict it.

        They may miss a sigma of a single value, or a small part of the move.
        """
        if {m.place for m in fit.members} != {m.place for m in self.members}:
            return self.about(fit, part)
        at = np.where(self.jacobian.any(axis=0), self._found_at(fit, part), 0.0)
        there = replace(self, at=at, members=fit.members)
        missed, move = there.residual(fit.members) - fit.residual, self.jacobian @ (at - self.at)
        if float(missed @ missed) > max(1.0, FIT.move_missed**2 * float(move @ move)):
            return self.about(fit, part)
        return there._corrected()

    def _found_at(self, fit: Fit, part: float) -> Floats:
        """Return the nuisance parameters of a fit, or `part` of the way to them."""
        best = dict(zip(fit.nuisance.keys, gls_nuisance(fit), strict=True))
        found = np.array(
            [unknown.limited(best.get(unknown.key, 0.0)) for unknown in self.nuisance.parameters]
        )
        return np.asarray(self.at + part * (found - self.at))

    def moved_to(self, values: Mapping[str, float]) -> Estimator:
        """Return the same with other values of some nuisance parameters, from their centres; derivatives
        stay.
        """
        at = [
            values.get(unknown.key, x) for unknown, x in zip(self.nuisance.parameters, self.at, strict=True)
        ]
        return replace(self, at=np.array(at))

    def nominal_residual(self) -> Floats:
        """Return the residual without effects, all nuisance parameters at the centres of their priors."""
        return self.moved_to(dict.fromkeys(self.nuisance.keys, 0.0)).residual(())

    def as_stated(self, keys: Iterable[str], members: Sequence[Candidate]) -> Estimator:
        """Return the same about a model with effects, some nuisance parameters of which are at the centres of
        their priors.
        """
        return self._moved(self.moved_to(dict.fromkeys(keys, 0.0)).at, tuple(members))

    def _moved(self, at: Floats, members: tuple[Candidate, ...]) -> Estimator:
        """Return the same with other nuisance parameters, except those that an effect overrules, such as a
        mass.

        Otherwise they would have moved, at no cost, in a model without that effect.
        """
        there = replace(self, at=at)
        arm = there.with_effects(members)
        keys = self.eliminated(members)[0].keys
        jacobian = self.jacobian.copy()
        jacobian[:, [self.nuisance.keys.index(key) for key in keys]] = self.problem.jacobian(
            arm, keys, self.nuisance.steps(arm)
        )
        acting = np.where(jacobian.any(axis=0), at, 0.0)
        return replace(self, at=acting, jacobian=jacobian, members=members)._corrected()

    def _corrected(self) -> Estimator:
        """Return the same with the discretisation error of its own model, unless that at hand is as good."""
        arm = self.with_effects(self.members)
        here = self.problem.residual(arm)
        if np.mean((here - self.corrected) ** 2) < FIT.same_error**2:
            return self
        return replace(self, correction=self.problem.correction(arm), corrected=here)

    def centred(self) -> Estimator:
        """Return the same about nominal values that fit better, as these act nonlinearly.

        Clocks and frames stay, since effects may replace them. Values stay within `FIT.centred_within`
        sigmas, and unchanged where there is no such model.
        """
        there, fit = self, self.fit(())
        nominal = np.array([unknown.kind == "nominal" for unknown in self.nuisance.parameters])
        reach = np.where(nominal, FIT.centred_within * self.nuisance.sigma, np.inf)
        for _ in range(FIT.centring_rounds):
            best = fit.projection.solve_within(fit.residual, reach)
            kept = [u.limited(float(x)) for u, x in zip(self.nuisance.parameters, best, strict=True)]
            try:
                about = there._moved(np.where(nominal, kept, 0.0), fit.members)
                better = about.fit(())
            except FIT_ERRORS:
                break
            if better.cost > FIT.better_share * fit.cost:
                break
            there, fit = about, better
        return there

    def residual(self, members: Sequence[Candidate]) -> Floats:
        """Eq. (1) for a set of effects."""
        raw = self.problem.residual(self.with_effects(members)) + self.correction
        taken = self.taken(members)
        at = np.array(
            [0.0 if u.key in taken else x for u, x in zip(self.nuisance.parameters, self.at, strict=True)]
        )
        return raw - self.jacobian @ at if at.any() else raw  # eq. (1)

    def taken(self, members: Sequence[Candidate]) -> frozenset[str]:
        """Return the keys of nuisance parameters that are effects of a set."""
        return self.nuisance.taken_by(frozenset().union(*(member.spots for member in members)))

    def eliminated(self, members: Sequence[Candidate]) -> tuple[NuisanceModel, Projection]:
        """Return the nuisance parameters that are no effects of a set, and their projection."""
        return self.without(self.taken(members))

    def without(self, taken: frozenset[str]) -> tuple[NuisanceModel, Projection]:
        """Return all nuisance parameters but some, and their projection."""
        if taken not in self._projections:
            left = self.nuisance.without(taken)
            keep = [k for k, u in enumerate(self.nuisance.parameters) if u.key not in taken]
            self._projections[taken] = (left, Projection(self.jacobian[:, keep], left.sigma))
        return self._projections[taken]

    def fit(self, members: Sequence[Candidate], limit: float = inf, nearby: Fit | None = None) -> Fit:
        """Return the least of (1) of `least_squares`, for a set of effects that start at their own values.

        A fit that would stay above the limit is not finished. The first derivatives are those of a model
        `nearby`, where that has them.

        Raise NotConverged or InvalidParameter if not even the start can be simulated.
        """
        solver = self.solver(tuple(members), nearby)
        z = solver.solve(solver.z_of(members), limit)
        jacobian = solver.jacobian_at(z) if solver.terminated else solver.differences(z)
        return self._found(solver, z, solver.members_at(z), jacobian)

    def trial(self, members: Sequence[Candidate], nearby: Fit, limit: float = inf) -> Fit:
        """Return a fit that is one of several, with the derivatives of its last step.

        A family with a shared size is fitted first, then with one size each and the spread that these have.

        Raise NotConverged or InvalidParameter if not even the start can be simulated.
        """
        solver = self.solver(tuple(members), nearby)
        shares = any(member.with_separate_sizes() is not member for member in members)
        z = solver.solve(solver.z_of(members), inf if shares else limit)
        fit = self._found(solver, z, solver.members_at(z), solver.jacobian_at(z))
        if shares:
            return self.trial([member.with_separate_sizes() for member in fit.members], fit, limit)
        return with_spreads(fit)

    def linearised(self, members: Sequence[Candidate]) -> Fit:
        """Return a model with effects as they are, and its derivatives."""
        solver = self.solver(tuple(members))
        z = solver.z_of(members)
        return self._found(solver, z, solver.members, solver.differences(z))

    def solver(self, members: tuple[Candidate, ...], nearby: Fit | None = None) -> LeastSquares:
        """Return the least squares of a set of effects."""
        parameters = transformed_parameters(members, self.with_effects(members))
        return LeastSquares(self, members, parameters, self.eliminated(members)[1], nearby)

    def _found(
        self, solver: LeastSquares, z: Floats, members: tuple[Candidate, ...], jacobian: Floats
    ) -> Fit:
        """Return the fit at z, which `members` have, with derivatives there."""
        residual, projection = solver.residual(z), solver.projection
        rest, left = projection.project(residual), self.eliminated(members)[0]
        return Fit(members, solver.parameters, z, residual, rest, jacobian, left, projection)

    def with_effects(self, members: Sequence[Candidate]) -> Arm:
        """Return the nominal model with effects, and with what they need."""
        return with_members(self.arm, members)
