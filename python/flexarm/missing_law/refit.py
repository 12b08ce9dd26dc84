r"""Knots of a law fitted through the simulation, with nuisance parameters and found effects along.

A law is the effect `tabulated_law` of a model, f its values at the knots. About a model,

.. math:: r \approx r_0 + J_f (f - f_0) + J_z (z - z_0) + J_x x + e, \quad
          f \sim N(0, s^2 K(\ell)), \quad x \sim N(0, \sigma^2)                                         (1)

z are parameters of found effects with a flat prior, x nuisance parameters. K is a Matern covariance plus
that of any straight line [Rasmussen2006, 2.7], which clocks and loads imitate: without it a small s would be
taken for knowledge of these. Sizes s and lengths l are weighted by their marginal likelihood (`gaussian`),
which the noise v maximises. The mean of (1) is the next model, unless it raises

.. math:: \Phi = (|r|^2 + |x/\sigma|^2)/v + |L^{-1} f|^2, \quad s^2 K = L L^T                            (2)

Then the step is halved. They end where the residual changes no more. Source: Gauss-Newton [Nocedal2006].

J_f are differences along smooth curves u of the knots, which span the priors,

.. math:: J_f u = (r(f + h u) - r(f - h u))/(2 h)                                                      (3)

Exact derivatives with respect to single values would not do: where a curve is level or turns, the slopes of
a monotone cubic are no smooth function of its values, so tangents hold for tiny changes only.

A change has two curves of the same prior, f = (f_0, f_1), and its instant is one more nuisance parameter,
with a flat prior; a law with memory has two as well. The derivative with respect to the instant is a
difference quotient too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.budget import allows
from flexarm.diagnosis.candidate import Candidate, members_at
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import FIT_ERRORS, Fit, Projection
from flexarm.diagnosis.policy import FIT
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.uncertainty import Estimates, estimates_at
from flexarm.effects.tabulated_law import TabulatedLaw
from flexarm.missing_law.gaussian import GaussianData, GaussianModel
from flexarm.missing_law.latent import noise_scale, nuisance_projection
from flexarm.missing_law.law import curve_matern
from flexarm.missing_law.policy import LawPolicy
from flexarm.named_effects import Estimate


@dataclass(frozen=True, eq=False)
class FittedLaw:
    """A law as an effect of a model."""

    law: TabulatedLaw
    """With the posterior mean of its values."""
    root: Floats
    """A root of their covariance, shape (b k, ...), of b branches one after the other."""
    instant: tuple[Estimate, ...]
    """When it changes; empty if it does not."""
    model: GaussianModel
    """Eq. (1) about the model before the last step."""
    fit: Fit
    """The model; the law is its last member."""
    sizes: Estimates
    """Values and deviations of all members, nuisance parameters and nominal values."""


def fitted_law(estimator: Estimator, fit: Fit, law: TabulatedLaw, policy: LawPolicy) -> FittedLaw:
    """Return a law whose values are fitted from a first guess, along with the effects of a fit without it.

    Raise InvalidParameter or NotConverged or LinAlgError if the model with the first guess cannot be
    simulated.
    """
    start = estimator.moved_to(dict.fromkeys(estimator.nuisance.keys, 0.0))
    here = _Linearised.about(start, (*fit.members, _member(law)), policy)
    step = here.step(policy)
    for _ in range(policy.refits):
        if not allows("a missing law was fitted until it rests"):
            break
        after = here.accepted(step, policy)
        if after is None:
            break
        here, step = after, after.step(policy)
        if step.converged(policy):
            break
    return here.fitted_law(step)


def _member(law: TabulatedLaw) -> Candidate:
    """Return a law as a member of a model without parameters of its own."""
    return Candidate(law, (), (), {})


def curve_root(knots: Floats, length: float, policy: LawPolicy) -> Floats:
    """Return a root of K of (1) for a branch, for a length over the range of the knots, shape (k, k + 2)."""
    across = 2 * (knots - knots[0]) / (knots[-1] - knots[0]) - 1
    line = policy.line_prior * np.column_stack([np.ones_like(across), across])
    return np.column_stack([curve_matern(len(knots), length), line])


def smooth_modes(knots: Floats, policy: LawPolicy) -> Floats:
    """Return orthonormal columns that span the priors of all lengths, shape (k, m)."""
    roots = [curve_root(knots, length, policy) for length in policy.curve_lengths]
    vectors, sizes, _ = np.linalg.svd(np.hstack(roots), full_matrices=False)
    return np.asarray(vectors[:, sizes > policy.least_mode * sizes[0]])


def law_jacobian(
    problem: Problem,
    model: Callable[[Floats], Arm],
    values: Floats,
    modes: Floats,
    policy: LawPolicy,
) -> Floats:
    """Return (3), shape (n, m), for the model of the values of a law."""
    size = policy.law_step * float(np.abs(values).max())
    ends = [[model(values + side * size * mode) for side in (1.0, -1.0)] for mode in modes.T]
    problem.prepare(arm for pair in ends for arm in pair)
    columns = [problem.residual(above) - problem.residual(below) for above, below in ends]
    return np.stack(columns, axis=1) / (2 * size)  # eq. (3)


@dataclass(frozen=True, eq=False)
class _Mixture:
    """Posterior of (1) over all likely sizes and lengths of the prior, each weighted by its evidence."""

    model: GaussianModel
    prior: Floats
    """The most likely one, and its L of (2)."""
    values: Floats
    root: Floats
    """Mean of f and a root of its covariance."""
    nuisance: Floats
    deviation: Floats
    """Of z - z_0 and x, shape (m,)."""

    @classmethod
    def of(cls, tried: Sequence[tuple[GaussianModel, Floats]]) -> _Mixture:
        """Return the mixture of models with their L."""
        model, prior = max(tried, key=lambda each: each[0].log_evidence)
        weight = np.exp([each.log_evidence - model.log_evidence for each, _ in tried])
        weight /= weight.sum()
        curves = [
            (root @ mean, root @ spread) for root, (mean, spread) in ((r, m.posterior()) for m, r in tried)
        ]
        others = [each.nuisance_posterior() for each, _ in tried]
        values = np.sum([w * value for w, (value, _) in zip(weight, curves, strict=True)], axis=0)
        nuisance = np.sum([w * x for w, (x, _) in zip(weight, others, strict=True)], axis=0)
        root = np.column_stack(
            [
                np.sqrt(w) * np.column_stack([spread, value - values])
                for w, (value, spread) in zip(weight, curves, strict=True)
            ]
        )
        square = [w * (std**2 + (x - nuisance) ** 2) for w, (x, std) in zip(weight, others, strict=True)]
        return cls(model, prior, values, root, nuisance, np.sqrt(np.sum(square, axis=0)))


@dataclass(frozen=True, eq=False)
class _Step:
    """Mean of (1) about a model."""

    mixture: _Mixture
    """Posterior of (1)."""
    values: Floats
    z: Floats
    x: Floats
    instant: Floats
    """f, parameters of found effects, nuisance parameters; instants, shape (0,) or (1,)."""
    moves: float
    """Squared change of the residual over its noise."""

    def converged(self, policy: LawPolicy) -> bool:
        """Return True if the step changes next to nothing."""
        return self.moves < policy.convergence

    def part(self, t: float, here: _Linearised) -> _Step:
        """Return a part of the step from a model."""
        values, z, x, instant = (
            old + t * (new - old)
            for old, new in zip(
                (here.law.values, here.fit.z, here.x, here.instant),
                (self.values, self.z, self.x, self.instant),
                strict=True,
            )
        )
        return replace(self, values=values, z=z, x=x, instant=instant)


@dataclass(frozen=True, eq=False)
class _Linearised:
    """A model with a law, and the derivatives of (1) about it over the noise's `scale`."""

    estimator: Estimator
    fit: Fit
    modes: Floats
    by_modes: Floats
    by_instant: Floats
    """Shape (n, 0) or (n, 1)."""
    scale: Floats

    @classmethod
    def about(
        cls,
        estimator: Estimator,
        members: tuple[Candidate, ...],
        policy: LawPolicy,
        by_modes: Floats | None = None,
    ) -> _Linearised:
        """Return the model with its derivatives; those along modes are computed unless given."""
        problem = estimator.problem
        there = estimator.as_stated((), members)
        fit = there.linearised(members)
        law = members[-1].effect
        assert isinstance(law, TabulatedLaw)
        scale = noise_scale(problem, fit)
        modes = block_diag(*[smooth_modes(np.array(law.x), policy)] * len(law.branches))

        def model(changed: TabulatedLaw) -> Arm:
            return there.with_effects((*members[:-1], _member(changed)))

        if by_modes is None:
            by_modes = law_jacobian(problem, lambda v: model(law.with_values(v)), law.values, modes, policy)
            by_modes /= scale[:, None]
        by_instant = np.zeros((len(problem), 0))
        if (instant := law.instant) is not None:
            h = 0.5 * law.duration
            after, before = (
                problem.residual(model(law.replace(instant=t))) for t in (instant + h, instant - h)
            )
            by_instant = (after - before)[:, None] / (2 * h)
        return cls(there, fit, modes, by_modes, by_instant / scale[:, None], scale)

    @property
    def jacobian(self) -> Floats:
        """J_f of curves that the modes hold, shape (n, k)."""
        found: Floats = self.by_modes @ self.modes.T
        return found

    @property
    def law(self) -> TabulatedLaw:
        law = self.fit.members[-1].effect
        assert isinstance(law, TabulatedLaw)
        return law

    @property
    def instant(self) -> Floats:
        """When the law changes, shape (0,) or (1,)."""
        return np.array([] if self.law.instant is None else [self.law.instant])

    @property
    def projection(self) -> Projection:
        """What eliminates z, x and the instant, in this order."""
        of = nuisance_projection(self.estimator.problem, self.fit)
        sigma = np.concatenate([of.sigma, np.full(len(self.instant), np.inf)])
        return Projection(np.column_stack([of.jacobian, self.by_instant]), sigma)

    @property
    def x(self) -> Floats:
        """Nuisance parameters where the model has them, those of the fit alone."""
        at = dict(zip(self.estimator.nuisance.keys, self.estimator.at.tolist(), strict=True))
        return np.array([at[key] for key in self.fit.nuisance.keys])

    def step(self, policy: LawPolicy) -> _Step:
        """Return the mean of (1)."""
        estimator, law = self.estimator, self.law
        knots, projection, jacobian = np.array(law.x), self.projection, self.jacobian
        y = jacobian @ law.values - self.fit.residual / self.scale
        data = GaussianData(y, projection, policy)
        tried = []
        for length in policy.curve_lengths:
            prior = block_diag(*[curve_root(knots, length, policy)] * len(law.branches))
            root = self.modes @ (self.modes.T @ prior)
            columns = jacobian @ root
            for model in GaussianModel.likely(data, columns, estimator.problem.policy.reach):
                tried.append((model, root * model.size))
        mixture = _Mixture.of(tried)
        ends = np.cumsum([len(self.fit.z), len(self.x)])
        dz, x, later = np.split(mixture.nuisance, ends)
        moves = jacobian @ (mixture.values - law.values)
        moves += projection.jacobian @ np.concatenate([dz, x - self.x, later])
        return _Step(mixture, mixture.values, self.fit.z + dz, x, self.instant + later, float(moves @ moves))

    def members(self, step: _Step) -> tuple[Candidate, ...]:
        """Return the members with the values of a step."""
        law = self.law.with_values(step.values)
        if len(step.instant):
            law = law.replace(instant=float(step.instant[0]))
        return (
            *members_at(self.fit.members, self.fit.parameters, step.z)[:-1],
            _member(law),
        )

    def estimator_at(self, step: _Step) -> Estimator:
        """Return the estimator about the nuisance parameters of a step."""
        known: Mapping[str, float] = {
            unknown.key: unknown.limited(float(x))
            for unknown, x in zip(self.fit.nuisance.parameters, step.x, strict=True)
        }
        return self.estimator.moved_to(known)

    def objective(self, step: _Step) -> float:
        """Return (2), simulated."""
        there = self.estimator_at(step).residual(self.members(step))
        rest = (there + self.fit.projection.jacobian @ step.x) / self.scale
        pulls = step.x / self.fit.nuisance.sigma
        latent = np.linalg.lstsq(step.mixture.prior, step.values, rcond=None)[0]
        return float((rest @ rest + pulls @ pulls) / step.mixture.model.noise + latent @ latent)  # eq. (2)

    def accepted(self, step: _Step, policy: LawPolicy) -> _Linearised | None:
        """Return the model after a step, halved until (2) falls; None if it does not."""
        before = self.objective(step.part(0.0, self))
        for t in (1.0, 0.5, 0.25):
            part = step.part(t, self)
            try:
                if self.objective(part) < before:
                    by_modes = self.by_modes if self.is_linear(part) else None
                    return self.about(self.estimator_at(part), self.members(part), policy, by_modes)
            except FIT_ERRORS:
                continue
        return None

    def is_linear(self, step: _Step) -> bool:
        """Return True if the derivatives miss less than one sigma, or a small part of the change."""
        move = (self.estimator_at(step).residual(self.members(step)) - self.fit.residual) / self.scale
        missed = move - self.predicted_change(step)
        return float(missed @ missed) < max(1.0, FIT.move_missed**2 * float(move @ move))

    def predicted_change(self, step: _Step) -> Floats:
        """Return the change of the residual over the noise that (1) predicts, with x eliminated."""
        by_law = self.jacobian @ (step.values - self.law.values) + self.by_instant @ (
            step.instant - self.instant
        )
        return np.asarray(by_law + self.fit.jacobian @ (step.z - self.fit.z) / self.scale)

    def fitted_law(self, step: _Step) -> FittedLaw:
        """Return the law at the mean of (1) with deviations of all that was fitted."""
        members = self.members(step)
        law = members[-1].effect
        assert isinstance(law, TabulatedLaw)
        root, fitted = step.mixture.root, len(self.fit.z) + len(self.x)
        residual = self.fit.residual + self.predicted_change(step) * self.scale
        fit = replace(self.fit, members=members, z=step.z, residual=residual)
        sizes = estimates_at(fit, step.mixture.deviation[:fitted])
        spread = np.concatenate([np.linalg.norm(root, axis=1), step.mixture.deviation[fitted:]])
        knots = tuple(
            Estimate.normal(name, value, std, unit)
            for (name, value, unit), std in zip(law.parameters(), spread.tolist(), strict=True)
        )
        return FittedLaw(
            law,
            root,
            tuple(each for each in knots if each.name == "instant"),
            step.mixture.model,
            fit,
            replace(sizes, effects=[*sizes.effects[:-1], knots]),
        )
