r"""Families: one effect at all places of a kind, as one hypothesis with a hierarchical prior.

Sizes that are positive are alike in the logarithm u = ln p,

.. math:: u_i \sim N(\mu, \tau^2), \quad \mu \sim N(m, s^2)                                            (1)

with mode m and s of the effect's own prior: a member that the data hardly know stays near the shared size
exp(mu). Errors that may have either sign have no shared value but a shared size,

.. math:: u_i \sim N(0, \tau^2)                                                                        (2)

The spread tau is estimated: its posterior mode given estimates u and their variances v,

.. math:: \tau^2 = \frac{\nu \tau_0^2 + \sum_i \left((u_i - \mu)^2 + v_i\right)}{\nu + n}             (3)

where a prior spread tau_0 counts as nu members: of (1) `CalibrationPolicy.spread`, of (2) the effect's own
sigma. Source: [Gelman2013], chapter 5; (3) is a step of expectation maximisation [Dempster1977].
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import log, sqrt

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.effect import Effect, effect_class
from flexarm.arm.joint_units import priors_in
from flexarm.arm.prior import QUANTILE, Prior
from flexarm.arm.vocabulary import KNOWN_EFFECTS
from flexarm.arrays import Floats
from flexarm.calibration.parameters import FreeParameter
from flexarm.calibration.policy import CalibrationPolicy
from flexarm.diagnosis.candidate_places import places_of
from flexarm.diagnosis.nuisance import bare_key
from flexarm.diagnosis.parameters import ACROSS
from flexarm.diagnosis.problem import Problem
from flexarm.errors import InvalidParameter


@dataclass(frozen=True)
class Family:
    """One parameter of an effect at all its places.

    Attributes
    ----------
    effect, parameter : str
        Their names.
    prior : Prior
        Of one machine's size.
    members : tuple of FreeParameter
        One a place.
    places : tuple of str
        Of the members.
    spread : float
        tau of (1) or (2).
    prior_spread : float
        tau_0 of (3).
    """

    effect: str
    parameter: str
    prior: Prior
    members: tuple[FreeParameter, ...]
    places: tuple[str, ...]
    spread: float
    prior_spread: float

    @property
    def shared(self) -> bool:
        """Return True if the members have a shared value, eq. (1)."""
        return self.prior.scale == "log"

    @property
    def hyperprior(self) -> tuple[float, float]:
        """Return m and s of (1); zeros of (2)."""
        if not self.shared:
            return 0.0, 0.0
        low, mode, high = (log(value) for value in (self.prior.low, self.prior.typical, self.prior.high))
        return mode, (high - low) / (2 * QUANTILE)

    def precision(self) -> Floats:
        """Return the inverse of the prior covariance of the members, shape (n, n)."""
        n = len(self.members)
        covariance = self.hyperprior[1] ** 2 * np.ones((n, n)) + self.spread**2 * np.eye(n)
        return np.asarray(np.linalg.inv(covariance))

    def shared_value(self, u: Floats) -> float:
        """Return the posterior mean of mu given the members' u; 0 of (2)."""
        m, s = self.hyperprior
        if not self.shared:
            return 0.0
        weights = 1 / self.spread**2, 1 / s**2
        return float((weights[0] * u.sum() + weights[1] * m) / (weights[0] * len(u) + weights[1]))

    def with_spread(self, u: Floats, variance: Floats, policy: CalibrationPolicy) -> Family:
        """Return the same with the spread of (3)."""
        nu, n = policy.spread_members, len(u)
        squares = float(np.sum((u - self.shared_value(u)) ** 2 + variance))
        return replace(self, spread=sqrt((nu * self.prior_spread**2 + squares) / (nu + n)))  # eq. (3)


def with_families(
    problem: Problem, arm: Arm, names: Sequence[str], policy: CalibrationPolicy
) -> tuple[Arm, list[Family]]:
    """Return the model with the effects of the families at all their places, and the families.

    Places where the model states the parameter and its uncertainty are left to that.

    Raises
    ------
    InvalidParameter
        If there is no such effect, or it cannot act anywhere in these records.
    """
    uncertain = {bare_key(arm, key) for key in arm.uncertainty}
    families: list[Family] = []
    for kind in family_kinds(names):
        name = kind.name
        entries: dict[tuple[str, str], list[tuple[str, Prior, Effect]]] = {}
        for effect in _members(kind, problem, arm):
            arm = arm.with_effect(effect)
            for parameter, prior in _free(effect, problem, arm):
                if f"effects.{name}.{effect.at}.{parameter.split('.')[0]}" not in uncertain:
                    entries.setdefault((parameter, prior.unit), []).append((parameter, prior, effect))
        if not entries:
            raise InvalidParameter(_nowhere(kind), where=f"families.{name}")
        families += [_family(members, policy) for members in entries.values()]
    return arm, families


def family_kinds(names: Sequence[str]) -> list[type[Effect]]:
    """Return the effects of families, each once.

    Raises
    ------
    InvalidParameter
        If there is no such effect, or it cannot be calibrated.
    """
    return [_kind(name) for name in dict.fromkeys(names)]


def _kind(name: str) -> type[Effect]:
    try:
        kind = effect_class(name)
    except InvalidParameter as error:
        raise InvalidParameter(str(error), where="families") from None
    if not kind.competes:
        allowed = ", ".join(each for each in KNOWN_EFFECTS if effect_class(each).competes)
        raise InvalidParameter(
            f"{name!r} is a fault of a sensor and cannot be calibrated; allowed are {allowed}",
            where="families",
        )
    return kind


def _members(kind: type[Effect], problem: Problem, arm: Arm) -> Iterator[Effect]:
    """Yield the effect at each place where the model accepts it, as stated there or typical."""
    for at in places_of(kind, problem, arm):
        stated = arm.effect(kind.name, at)
        required = None if kind.requires is None else arm.effect(kind.requires, at)
        if kind.requires is not None and (required is None or required.inert):
            continue
        effect = kind.typical(at, arm) if stated is None or stated.inert else stated
        try:
            arm.with_effect(effect)
        except InvalidParameter:
            continue
        yield effect


def _free(effect: Effect, problem: Problem, arm: Arm) -> Iterator[tuple[str, Prior]]:
    """Yield the parameters that these records can show, with their priors."""
    poses = all(record.kind == "static" for record in problem.records.values())
    there = {name for name, _, _ in effect.parameters()}
    for name, prior in priors_in(effect, arm).items():
        if name in there and not (poses and name in effect.in_motion):
            yield name, prior


def _nowhere(kind: type[Effect]) -> str:
    needs = f"; it needs {kind.requires} there, so name that family first" if kind.requires else ""
    return f"{kind.name} can act nowhere in these records, or is uncertain in the model already{needs}"


def _family(members: Sequence[tuple[str, Prior, Effect]], policy: CalibrationPolicy) -> Family:
    parameter, prior, first = members[0]
    spread = policy.spread if prior.scale == "log" else (prior.high - prior.low) / (2 * QUANTILE)
    free = tuple(
        FreeParameter.of_family(
            f"effects.{effect.name}.{effect.at}.{name}",
            each,
            spread,
            None if effect.smooth else ACROSS * (each.high - each.low) / (2 * QUANTILE),
        )
        for name, each, effect in members
    )
    return Family(
        first.name, parameter, prior, free, tuple(effect.at for _, _, effect in members), spread, spread
    )
