"""A candidate, an effect at a place, and its free parameters on the scales of their priors.

    z = (u - m)/s,    u = ln p where the prior is logarithmic, else p                                  (1)

p is a parameter, m and s mode and sigma of its prior (of an asymmetric one that on the side where u is; of a
uniform one an eighth of its width). The density of z has the wide tails of Student's t with three degrees of
freedom, as some machines are unlike all others,

    ln p(z) = -2 ln(1 + z^2/3) + ln(2/(pi sqrt 3)).                                                    (2)
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import exp, log, log1p, pi

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.effect import Effect, Probes
from flexarm.arm.joint_units import parameters_in, priors_in
from flexarm.arm.prior import Prior
from flexarm.arrays import Floats
from flexarm.diagnosis.policy import FIT
from flexarm.errors import InvalidParameter
from flexarm.named_effects import Place


@dataclass(frozen=True)
class Candidate:
    """An effect at a place, with free parameters and probes."""

    effect: Effect
    """Fixed parameters at their values, free ones at typical ones."""
    free: tuple[str, ...]
    """Parameters that are fitted."""
    probes: tuple[Effect, ...]
    """The effect at plausible sizes, one for each direction of the prediction."""
    null: Mapping[str, float]
    """Values at which the effect vanishes."""
    without: Effect | None = None
    """The nominal effect, if the model has it."""
    needs: Effect | None = None
    """An effect that it requires and the model lacks."""
    priors: Mapping[str, Prior] = field(default_factory=dict)
    """Priors that records or model state, in place of those of the effect."""

    @property
    def name(self) -> str:
        """Return the name of the effect."""
        return self.effect.name

    @property
    def at(self) -> Place:
        """Return the name of its place."""
        return self.effect.at

    @property
    def place(self) -> tuple[str, Place]:
        """Return name and place: candidates of one place are variants of one effect."""
        return self.name, self.at

    @property
    def spot(self) -> tuple[str, str]:
        """Return name and place, of a family those of its first place."""
        return self.name, self.effect.at

    @property
    def spots(self) -> frozenset[tuple[str, str]]:
        """Return name and place of each effect that it adds to a model."""
        return frozenset({self.spot})

    @property
    def required_place(self) -> tuple[str, str] | None:
        """Return name and place of the required effect that the model lacks."""
        return None if self.needs is None else (self.needs.name, self.needs.at)

    def priors_in(self, arm: Arm) -> dict[str, Prior]:
        """Return the priors of all parameters in a model."""
        return {**priors_in(self.effect, arm), **self.priors}

    def prior_weight(self, name: str) -> float:
        """Return the weight of a parameter's prior in a fit."""
        return FIT.prior_weight

    @property
    def hyperprior_log_evidence(self) -> float:
        """Return the log evidence of estimated priors; 0 without any."""
        return 0.0

    def parameters_in(self, arm: Arm) -> list[tuple[str, float, str]]:
        """Return all parameters as (name, value, unit) in a model."""
        return parameters_in(self.effect, arm)

    def value_of(self, name: str) -> float:
        """Return a parameter."""
        return self.effect.value_of(name)

    def with_parameters(self, values: Mapping[str, float]) -> Candidate:
        """Return the same with other values."""
        return replace(self, effect=self.effect.with_parameters(values))

    def held(self) -> list[tuple[str, float, str]]:
        """Return shape parameters as (name, value, unit) that are chosen, not fitted."""
        shape = [each for each in self.effect.parameters() if each[0] in self.effect.shape]
        return [each for each in shape if each[0] not in self.free]

    def keys_of(self, name: str) -> list[str]:
        """Return the keys of the model's parameters that have the value of a parameter."""
        return [f"effects.{self.name}.{self.effect.at}.{name}"]

    def is_size(self, name: str) -> bool:
        """Return True if a parameter is the size of the effect."""
        return name == self.free[0]

    def vanishes_with(self, name: str) -> bool:
        """Return True if the effect of a parameter is none where it is 0, and grows with it."""
        of_law = name not in self.effect.shape and not self.effect.is_spring
        return of_law and self.null.get(name, 1.0) == 0.0

    def with_separate_sizes(self) -> Candidate:
        """Return the same with a size for each of its places."""
        return self

    def reshaped(self) -> Iterator[Candidate]:
        """Yield the same with one more part of its law's shape free, from each start of that."""
        for start in self.effect.shapes():
            if not start.keys() & set(self.free):
                yield replace(self, effect=self.effect.with_parameters(start), free=(*self.free, *start))

    def enter(self, arm: Arm) -> Arm:
        """Return a model with the effect, and with what it needs."""
        return self.base(arm).with_effect(self.effect)

    def base(self, arm: Arm) -> Arm:
        """Return the model that probes are compared with: with the required effect added if it is missing."""
        if self.needs is None or arm.effect(self.needs.name, self.needs.at) is not None:
            return arm
        return arm.with_effect(self.needs)

    def sized(self, multiples: Sequence[float], least: float = 0.02) -> Effect:
        """Return the effect of multiples of its probes; `least` as `arm.effect.Probes` has it."""
        return self._at(self.effect.sized(multiples, Probes(self.probes, self.null, self.without, least)))

    def at_size(self, multiples: Sequence[float]) -> Candidate:
        """Return the same, of multiples of its probes."""
        return replace(self, effect=self.sized(multiples))

    def nudged(self, probe: int, part: float) -> Effect:
        """Return the effect of a small part of one of its probes, for derivatives."""
        return self.sized([part if k == probe else 0.0 for k in range(len(self.probes))], least=0.0)

    def acting_as(self, other: Candidate) -> Candidate | None:
        """Return this candidate at the size that acts as another one; None if there is none."""
        alike = self.effect.is_spring and other.effect.is_spring
        if len(other.spots) > 1:
            return None
        if not alike and (self.effect.acts_as, self.at) != other.place:
            return None
        values = self.effect.acting_as(other.effect, other.without, self.without)
        return None if values is None else replace(self, effect=self._at(values))

    def shaped_as(self, other: Candidate) -> Candidate | None:
        """Return this candidate with what of its shape is free in another one alone; None if nothing is."""
        shape = {name for name in other.free if name in other.effect.shape and name in self.effect.shape}
        values = {name: other.value_of(name) for name in other.free if name in shape - set(self.free)}
        if not values or len(self.spots) > 1:
            return None
        return replace(self, effect=self.effect.with_parameters(values), free=(*self.free, *values))

    def _at(self, values: Mapping[str, float]) -> Effect:
        return self.effect.with_parameters({k: v for k, v in values.items() if k in self.free})


def springs_first(members: Iterable[Candidate]) -> list[Candidate]:
    """Return effects in the order in which they enter a model: a law finds the spring that it acts on."""
    return sorted(members, key=lambda member: not member.effect.is_spring)


def with_members(arm: Arm, members: Iterable[Candidate]) -> Arm:
    """Return a model with effects, and with what they need.

    Raise InvalidParameter if one effect is twice at a place, such as alone and in a family.
    """
    spots: set[tuple[str, str]] = set()
    for member in springs_first(members):
        if spots & member.spots:
            raise InvalidParameter(f"{member.name} is twice at one place", where="members")
        spots |= member.spots
        arm = member.enter(arm)
    return arm


def is_required(members: Sequence[Candidate], spring: Candidate) -> bool:
    """Return True if other effects require a spring that the model has not."""
    return any(member.required_place in spring.spots for member in members)


def nulls(effect: Effect, without: Effect | None, arm: Arm) -> dict[str, float]:
    """Return the value of every parameter at which the effect vanishes."""
    names = [name for name, _, _ in effect.parameters()]
    return effect.null(arm) if without is None else {name: without.value_of(name) for name in names}


BOUNDS = {"log": 8.0, "linear": 400.0, "uniform": 40.0}
"""Bounds of a parameter in sigmas of its prior, by the prior's scale: factors of thousands, or turns."""


@dataclass(frozen=True)
class TransformedParameter:
    """A free parameter on the scale of its prior."""

    candidate: int
    """Which effect of the set."""
    name: str
    """Name of the parameter."""
    prior: Prior
    """At the start of the fit."""
    smooth: bool = True
    """True if its law is smooth."""
    weight: float = FIT.prior_weight
    """Weight of its prior in a fit, unless that is uniform."""

    @property
    def held(self) -> float:
        """Return the root of the weight with which its prior holds z in a fit."""
        return 1e-3 if self.prior.scale == "uniform" else self.weight

    def z(self, value: float) -> float:
        """Sigmas from the mode.

        Raise InvalidParameter if there is no such logarithm.
        """
        if self.prior.scale == "log" and not value > 0:
            raise InvalidParameter(f"{self.name} must be positive, got {value:g} {self.prior.unit}")
        mode, below, above = self._pieces()
        u = log(value) if self.prior.scale == "log" else value
        return (u - mode) / (below if u < mode else above)

    def value(self, z: float) -> float:
        """Return the parameter."""
        mode, below, above = self._pieces()
        u = mode + z * (below if z < 0 else above)
        return exp(u) if self.prior.scale == "log" else u

    def slope(self, z: float) -> float:
        """d(value)/dz."""
        _, below, above = self._pieces()
        size = below if z < 0 else above
        return size * self.value(z) if self.prior.scale == "log" else size

    def step(self, z: float, seconds: float) -> float:
        """Return the step of differences; that of a frequency keeps its wave in phase for so many seconds."""
        if self.name != "frequency" or seconds == 0:
            return self.widest_step
        return min(self.widest_step, FIT.phase_step / (2 * pi * seconds * self.slope(z)))

    @property
    def widest_step(self) -> float:
        """Return the widest step of differences."""
        return FIT.smooth_step if self.smooth else FIT.non_smooth_step

    def log_density(self, z: float) -> float:
        """Eq. (2); of a uniform prior, the same everywhere."""
        if self.prior.scale == "uniform":
            return -log(8.0)
        return -2.0 * log1p(z * z / 3.0) - 1.0008889  # eq. (2)

    def _pieces(self) -> tuple[float, float, float]:
        if self.prior.scale != "uniform":
            return self.prior.two_pieces()
        eighth = (self.prior.high - self.prior.low) / 8
        return self.prior.typical, eighth, eighth

    @property
    def bound(self) -> float:
        """Greatest size of z in a fit."""
        bound = BOUNDS[self.prior.scale]
        if self.prior.scale != "log":
            return bound
        return max(bound, log(FIT.least_factor) / min(self._pieces()[1:]))


def transformed_parameters(members: Sequence[Candidate], arm: Arm) -> tuple[TransformedParameter, ...]:
    """Return the free parameters of a set of effects, in their order."""
    return tuple(
        TransformedParameter(k, name, prior, member.effect.smooth, member.prior_weight(name))
        for k, member in enumerate(members)
        for name, prior in member.priors_in(arm).items()
        if name in member.free
    )


def prior_rows(parameters: Sequence[TransformedParameter], z: Floats) -> tuple[Floats, Floats]:
    """Return the rows of priors in least squares, with squares ln(1 + (w z)^2), and their derivatives.

    The weight w is that of `TransformedParameter.held`.
    """
    weak = np.array([c.held for c in parameters])
    x = weak * z
    rows = np.sign(x) * np.sqrt(np.log1p(x**2))
    near = np.abs(x) < 1e-4  # where the row is x
    jacobian = np.where(near, 1.0, x / (1 + x**2) / np.where(near, 1.0, rows))
    return rows, weak * jacobian


def members_at(
    members: Sequence[Candidate], parameters: Sequence[TransformedParameter], z: Floats
) -> tuple[Candidate, ...]:
    """Return the effects with these parameters."""
    found = list(members)
    for k, member in enumerate(found):
        values = {c.name: c.value(float(x)) for c, x in zip(parameters, z, strict=True) if c.candidate == k}
        found[k] = member.with_parameters(values)
    return tuple(found)
