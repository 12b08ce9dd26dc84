r"""A family: one effect at all places of a kind as one candidate.

Its places share each positive parameter at first. Families with separate sizes have one parameter a place,
named after it, such as "j1.stiffness", with a hierarchical prior. Parameters that shape a law, such as a
damping, keep the effect's own priors.

**Hierarchical prior.** Mean and spread of the sizes at several places are estimated (empirical Bayes), and
their uncertainty is part of the evidence. Sizes that are positive scatter in the logarithm u = ln p,

.. math:: u_i \sim N(\mu, \tau^2), \quad \mu \sim N(m, s^2)                                            (1)

with mode m and s of the effect's own prior: a member that the data hardly know stays near exp(mu). Errors
that may have either sign have no common value but a common size, about the value m without error,

.. math:: u_i \sim N(m, \tau^2)                                                                        (2)

The spread tau is estimated: its posterior mode given estimates u and their variances v,

.. math:: \tau^2 = \frac{\nu \tau_0^2 + \sum_i \left((u_i - \mu)^2 + v_i\right)}{\nu + n}             (3)

where a prior spread tau_0 counts as nu members: of (1) a spread of its own, of (2) the effect's sigma. So
x = ln tau^2 has the density

.. math:: \ln p(x) = \tfrac{\nu}{2} \ln \tfrac{\nu \tau_0^2}{2} - \ln\Gamma(\tfrac{\nu}{2})
          - \tfrac{\nu}{2} x - \tfrac{\nu \tau_0^2}{2} e^{-x}                                          (4)

Members given mu and tau have evidence of their own. By Laplace's approximation about (3), with the curvatures
n/tau^2 + 1/s^2 and (nu + n)/2, the uncertainty of mu and x costs

.. math:: \ln p(\mu) + \tfrac12 \ln\frac{2\pi}{n/\tau^2 + 1/s^2}
          + \ln p(x) + \tfrac12 \ln\frac{4\pi}{\nu + n}                                                (5)

Fits and the evidence of members replace the normal density of (1) and (2) by one of Student's, as of every
prior (`candidate.TransformedParameter.log_density`), so that one odd place does not move the others.

Source: [Gelman2013], chapter 5; (3) is a step of expectation maximisation [Dempster1977].
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import exp, lgamma, log, pi, sqrt
from typing import ClassVar

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.prior import QUANTILE, Prior
from flexarm.arrays import Floats
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.fit import Fit, posterior_covariance
from flexarm.diagnosis.policy import FIT, FamilyPolicy
from flexarm.named_effects import Place


@dataclass(frozen=True)
class HierarchicalPrior:
    """Eq. (1) or (2) of one parameter."""

    prior: Prior
    """Prior of the size in one machine."""
    prior_spread: float
    count: float
    """tau_0 and nu of (3); `family_spread` and `family_count` of the policy."""
    spread: float
    """tau of (1) or (2)."""
    mean: float = 0.0
    """mu of (1); m of (2)."""

    @classmethod
    def of(cls, prior: Prior, policy: FamilyPolicy) -> HierarchicalPrior:
        """Return the prior before any data."""
        own = policy.family_spread if prior.scale == "log" else (prior.high - prior.low) / (2 * QUANTILE)
        found = cls(prior, own, policy.family_count, own)
        return replace(found, mean=found.hyperprior[0])

    @property
    def has_mean(self) -> bool:
        """Return True if the members scatter about a mean, eq. (1)."""
        return self.prior.scale == "log"

    @property
    def hyperprior(self) -> tuple[float, float]:
        """Return m and s of (1); m and 0 of (2)."""
        if not self.has_mean:
            return self.prior.typical, 0.0
        low, mode, high = (log(value) for value in (self.prior.low, self.prior.typical, self.prior.high))
        return mode, (high - low) / (2 * QUANTILE)

    def precision(self, n: int) -> Floats:
        """Return the inverse of the prior covariance of n members, shape (n, n)."""
        covariance = self.hyperprior[1] ** 2 * np.ones((n, n)) + self.spread**2 * np.eye(n)
        return np.asarray(np.linalg.inv(covariance))

    def shared_value(self, u: Floats) -> float:
        """Return the posterior mean of mu given the members' u; m of (2)."""
        m, s = self.hyperprior
        if not self.has_mean:
            return m
        weights = 1 / self.spread**2, 1 / s**2
        return float((weights[0] * u.sum() + weights[1] * m) / (weights[0] * len(u) + weights[1]))

    def updated(self, u: Floats, variance: Floats) -> HierarchicalPrior:
        """Return the same with the mean of the members' u and the spread of (3)."""
        mean = self.shared_value(u)
        squares = float(np.sum((u - mean) ** 2 + variance))
        spread = sqrt((self.count * self.prior_spread**2 + squares) / (self.count + len(u)))  # eq. (3)
        return replace(self, mean=mean, spread=spread)

    def member_prior(self) -> Prior:
        """Return the prior of each member given mu and tau."""
        ends = (self.mean + sign * QUANTILE * self.spread for sign in (-1, 0, 1))
        low, mode, high = (exp(end) for end in ends) if self.has_mean else ends
        source = f"{self.prior.source}; shared with the other places"
        return replace(self.prior, low=low, typical=mode, high=high, source=source)

    def log_evidence(self, n: int) -> float:
        """Return the log evidence of mu and tau of n members, eq. (5)."""
        nu, x = self.count, 2 * log(self.spread)
        scale = nu * self.prior_spread**2 / 2
        density = nu / 2 * (log(scale) - x) - lgamma(nu / 2) - scale / self.spread**2  # eq. (4)
        found = density + log(4 * pi / (nu + n)) / 2
        if self.has_mean:
            m, s = self.hyperprior
            of_mean = -(((self.mean - m) / s) ** 2) / 2 - log(2 * pi * s**2) / 2
            found += of_mean + log(2 * pi / (n / self.spread**2 + 1 / s**2)) / 2
        return found  # eq. (5)


@dataclass(frozen=True)
class EffectFamily(Candidate):
    """One effect at several places."""

    members: tuple[Candidate, ...] = ()
    """Candidates, one a place; other fields equal those of the first, except `free`."""
    hierarchy: Mapping[str, HierarchicalPrior] = field(default_factory=dict)
    """Prior of each parameter that the members share in kind, by name."""
    shared: bool = False
    """True if the members have one value of each parameter."""
    least_places: ClassVar[int] = 3
    """Least places of a family: two are a pair of effects."""

    @classmethod
    def of(
        cls, members: Sequence[Candidate], hierarchy: Mapping[str, HierarchicalPrior], shared: bool
    ) -> EffectFamily:
        """Return the family of candidates that differ in their places only."""
        first = members[0]
        free = first.free if shared else tuple(f"{m.effect.at}.{name}" for m in members for name in m.free)
        return cls(
            first.effect, free, first.probes, first.null, members=tuple(members), hierarchy=hierarchy,
            shared=shared,
        )  # fmt: skip

    def _with(self, members: Sequence[Candidate]) -> EffectFamily:
        return replace(self, effect=members[0].effect, members=tuple(members))

    @property
    def at(self) -> Place:
        """Return the names of its places."""
        return tuple(member.effect.at for member in self.members)

    @property
    def spots(self) -> frozenset[tuple[str, str]]:
        """Return name and place of each effect that it adds to a model."""
        return frozenset().union(*(member.spots for member in self.members))

    @cached_property
    def _values(self) -> dict[str, list[tuple[int, str]]]:
        """Members and their parameters that a parameter is the value of."""
        names = [[name for name, _, _ in member.effect.parameters()] for member in self.members]
        if self.shared:
            return {name: [(k, name) for k in range(len(self.members))] for name in names[0]}
        return {
            f"{member.effect.at}.{name}": [(k, name)]
            for k, member in enumerate(self.members)
            for name in names[k]
        }

    def priors_in(self, arm: Arm) -> dict[str, Prior]:
        """Return the priors of all parameters in a model."""
        own = [member.priors_in(arm) for member in self.members]
        found = {}
        for name, ((k, parameter), *_) in self._values.items():
            prior = self.prior_of(name) or own[k].get(parameter)
            if prior is not None:
                found[name] = prior
        return found

    def prior_of(self, name: str) -> Prior | None:
        """Return the hierarchical prior of a member's parameter; None for other parameters."""
        prior = None if self.shared else self.hierarchy.get(self._values[name][0][1])
        return None if prior is None else prior.member_prior()

    def prior_weight(self, name: str) -> float:
        """Return the weight of a parameter's prior in a fit: one for a hierarchical prior."""
        return super().prior_weight(name) if self.prior_of(name) is None else 1.0

    @property
    def hyperprior_log_evidence(self) -> float:
        """Return the log evidence of the means and spreads."""
        return sum(each.log_evidence(len(self.members)) for each in self.hierarchy.values())

    def parameters_in(self, arm: Arm) -> list[tuple[str, float, str]]:
        """Return all parameters as (name, value, unit) in a model."""
        known = [{n: (value, unit) for n, value, unit in m.parameters_in(arm)} for m in self.members]
        return [(name, *known[k][parameter]) for name, ((k, parameter), *_) in self._values.items()]

    def value_of(self, name: str) -> float:
        """Return a parameter."""
        k, parameter = self._values[name][0]
        return self.members[k].value_of(parameter)

    def with_parameters(self, values: Mapping[str, float]) -> EffectFamily:
        """Return the same with other values."""
        own: list[dict[str, float]] = [{} for _ in self.members]
        for name, value in values.items():
            for k, parameter in self._values[name]:
                own[k][parameter] = value
        return self._with([m.with_parameters(each) for m, each in zip(self.members, own, strict=True)])

    def held(self) -> list[tuple[str, float, str]]:
        """Return shape parameters as (name, value, unit) that are chosen, not fitted."""
        return self.members[0].held()

    def keys_of(self, name: str) -> list[str]:
        """Return the keys of the model's parameters that have the value of a parameter."""
        return [key for k, parameter in self._values[name] for key in self.members[k].keys_of(parameter)]

    def is_size(self, name: str) -> bool:
        """Return True if a parameter is the size of the effect at a place."""
        k, parameter = self._values[name][0]
        return self.members[k].is_size(parameter)

    def enter(self, arm: Arm) -> Arm:
        """Return a model with the effect at all places."""
        for member in self.members:
            arm = member.enter(arm)
        return arm

    def at_size(self, multiples: Sequence[float]) -> EffectFamily:
        """Return the same, of multiples of probes: shared ones, or those of one member after the other."""
        each = len(multiples) if self.shared else len(multiples) // len(self.members)
        parts = [multiples[k * each :][:each] for k in range(len(self.members))]
        if self.shared:
            parts = [list(multiples)] * len(self.members)
        return self._with([m.at_size(part) for m, part in zip(self.members, parts, strict=True)])

    def acting_as(self, other: Candidate) -> Candidate | None:
        """Return None: no other effect acts at so many places."""
        return None

    def with_separate_sizes(self) -> EffectFamily:
        """Return the same with a size for each of its places, which scatter by the prior spread."""
        if not self.shared:
            return self
        hierarchy = {
            name: replace(each, mean=log(self.value_of(name)), spread=each.prior_spread)
            for name, each in self.hierarchy.items()
        }
        return EffectFamily.of(self.members, hierarchy, shared=False)

    def reshaped(self) -> Iterator[Candidate]:
        """Yield nothing: a family's members are alike, shapes are of single laws."""
        yield from ()

    def without_place(self, at: str) -> EffectFamily:
        """Return the same without one of its places."""
        return EffectFamily.of([m for m in self.members if m.effect.at != at], self.hierarchy, self.shared)

    def owner_of(self, name: str) -> tuple[str, str]:
        """Return the place of a parameter of this name, and its own name there."""
        k, parameter = self._values[name][0]
        return self.members[k].effect.at, parameter


def family_of(members: Sequence[Candidate], arm: Arm, policy: FamilyPolicy) -> EffectFamily | None:
    """Return the family of candidates that are alike but for their places; None if nothing is alike."""
    first = members[0]
    hierarchy = {
        name: HierarchicalPrior.of(prior, policy)
        for name, prior in first.priors_in(arm).items()
        if name in first.free and name not in first.effect.shape and prior.scale != "uniform"
    }
    if not hierarchy:
        return None
    return EffectFamily.of(members, hierarchy, all(each.has_mean for each in hierarchy.values()))


def clear_places(fit: Fit, family: EffectFamily, strong: float) -> list[str]:
    """Return the places of a family whose sizes the data determine.

    A size is known to a part f of itself if its effect has a signal to noise ratio of 1/f, which is an
    evidence of 1/(2 f^2): more than `strong` [-].
    """
    std, found = np.sqrt(np.diag(posterior_covariance(fit))), []
    for j, (parameter, z) in enumerate(zip(fit.parameters, fit.z, strict=True)):
        if fit.members[parameter.candidate] is family and family.is_size(parameter.name):
            relative = abs(parameter.slope(float(z)) / parameter.value(float(z))) * std[j]
            if relative < (2 * strong) ** -0.5:
                found.append(family.owner_of(parameter.name)[0])
    return list(dict.fromkeys(found))


def with_spreads(fit: Fit) -> Fit:
    """Return a fit with the means and spreads of its families' sizes, of which the posterior is greatest."""
    if not any(isinstance(member, EffectFamily) and not member.shared for member in fit.members):
        return fit
    for _ in range(FIT.spread_rounds):
        variance = np.diag(posterior_covariance(fit))
        fit = _on_scales_of(fit, [_updated(fit, k, variance) for k in range(len(fit.members))])
    return fit


def _updated(fit: Fit, k: int, variance: Floats) -> Candidate:
    """Return a member of a fit; a family with the mean and spread of its sizes."""
    member = fit.members[k]
    if not isinstance(member, EffectFamily) or member.shared:
        return member
    hierarchy = dict(member.hierarchy)
    for parameter, prior in member.hierarchy.items():
        own = (j for j, c in enumerate(fit.parameters) if c.candidate == k)
        where = [j for j in own if member.owner_of(fit.parameters[j].name)[1] == parameter]
        values = np.array([fit.parameters[j].value(float(fit.z[j])) for j in where])
        u = np.log(values) if prior.has_mean else values
        hierarchy[parameter] = prior.updated(u, variance[where] * prior.spread**2)
    return replace(member, hierarchy=hierarchy)


def _on_scales_of(fit: Fit, members: Sequence[Candidate]) -> Fit:
    """Return the same fit with its parameters on the scales of other priors."""
    parameters = []
    for c in fit.parameters:
        member = members[c.candidate]
        prior = member.prior_of(c.name) if isinstance(member, EffectFamily) else None
        parameters.append(replace(c, prior=prior or c.prior))
    values = [c.value(float(x)) for c, x in zip(fit.parameters, fit.z, strict=True)]
    z = np.array([c.z(value) for c, value in zip(parameters, values, strict=True)])
    times = [
        new.slope(float(x)) / old.slope(float(y))
        for new, old, x, y in zip(parameters, fit.parameters, z, fit.z, strict=True)
    ]
    return replace(
        fit,
        members=tuple(members),
        parameters=tuple(parameters),
        z=z,
        jacobian=fit.jacobian * np.array(times),
    )
