"""An effect at a place: the parameters that are fitted, and the probes that screen it (`arm.effect`)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from flexarm.arm import Arm
from flexarm.arm.effect import Effect
from flexarm.arm.joint_units import parameters_in, priors_in
from flexarm.arm.prior import Prior
from flexarm.named_effects import Place

WEIGHT = 1 / 3
"""Of priors in fits: `diagnosis.least_squares`."""


@dataclass(frozen=True)
class Candidate:
    """An effect at a place, and how it may be there.

    Attributes
    ----------
    effect : Effect
        With what is not free at its value, and the rest at typical ones.
    free : tuple of str
        Parameters that are fitted.
    probes : tuple of Effect
        The effect at plausible sizes, one for each direction of the prediction.
    null : dict of str to float
        Values at which the model is what it is without.
    without : Effect or None
        The nominal effect, if the model has it.
    needs : Effect or None
        An effect that it requires and the model has not.
    priors : dict of str to Prior
        Those that records or model state better than the effect does, which does not know them.
    """

    effect: Effect
    free: tuple[str, ...]
    probes: tuple[Effect, ...]
    null: Mapping[str, float]
    without: Effect | None = None
    needs: Effect | None = None
    priors: Mapping[str, Prior] = field(default_factory=dict)

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
        """Return name and place of each effect that it puts into a model."""
        return frozenset({self.spot})

    @property
    def stands_on(self) -> tuple[str, str] | None:
        """Return name and place of the effect that it needs and the model has not."""
        return None if self.needs is None else (self.needs.name, self.needs.at)

    def priors_in(self, arm: Arm) -> dict[str, Prior]:
        """Return the priors of all parameters in a model."""
        return {**priors_in(self.effect, arm), **self.priors}

    def prior_weight(self, name: str) -> float:
        """Return the weight of a parameter's prior in a fit, which need not know this machine."""
        return WEIGHT

    @property
    def hyperprior_cost(self) -> float:
        """Return ln of the evidence of what its priors were estimated from, 0 where nothing was."""
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
        """Return the parameters as (name, value, unit) that say how it acts and are chosen, not fitted."""
        shape = [each for each in self.effect.parameters() if each[0] in self.effect.shape]
        return [each for each in shape if each[0] not in self.free]

    def keys_of(self, name: str) -> list[str]:
        """Return the model's parameters that a parameter is the value of."""
        return [f"effects.{self.name}.{self.effect.at}.{name}"]

    def is_size(self, name: str) -> bool:
        """Return True if a parameter says how much of the effect there is."""
        return name == self.free[0]

    def opened(self) -> Candidate:
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
        """Return the model that a probe differs from: with what the effect needs, unless that is there."""
        if self.needs is None or arm.effect(self.needs.name, self.needs.at) is not None:
            return arm
        return arm.with_effect(self.needs)

    def sized(self, multiples: Sequence[float], least: float = 0.02) -> Effect:
        """Return the effect of multiples of its probes; `least` as in `Effect.sized`."""
        return self._at(self.effect.sized(multiples, self.probes, self.null, self.without, least))

    def at_size(self, multiples: Sequence[float]) -> Candidate:
        """Return the same, of multiples of its probes."""
        return replace(self, effect=self.sized(multiples))

    def nudged(self, probe: int, part: float) -> Effect:
        """Return the effect of a small part of one of its probes, for derivatives."""
        return self.sized([part if k == probe else 0.0 for k in range(len(self.probes))], least=0.0)

    def acting_as(self, other: Candidate) -> Candidate | None:
        """Return this candidate at the size that plays the part of another one; None where it has no such."""
        alike = self.effect.is_spring and other.effect.is_spring
        if len(other.spots) > 1:
            return None
        if not alike and (self.effect.acts_as, self.at) != other.place:
            return None
        values = self.effect.acting_as(other.effect, other.without, self.without)
        return None if values is None else replace(self, effect=self._at(values))

    def _at(self, values: Mapping[str, float]) -> Effect:
        return self.effect.with_parameters({k: v for k, v in values.items() if k in self.free})


def springs_first(members: Iterable[Candidate]) -> list[Candidate]:
    """Return effects in the order in which they enter a model: a law finds the spring that it acts on."""
    return sorted(members, key=lambda member: not member.effect.is_spring)


def with_members(arm: Arm, members: Iterable[Candidate]) -> Arm:
    """Return a model with effects, and with what they need."""
    for member in springs_first(members):
        arm = member.enter(arm)
    return arm


def carries(members: Sequence[Candidate], spring: Candidate) -> bool:
    """Return True if other effects require a spring that the model has not."""
    return any(member.stands_on in spring.spots for member in members)


def nulls(effect: Effect, without: Effect | None, arm: Arm) -> dict[str, float]:
    """Return the value of every parameter at which the model is what it is without the effect."""
    names = [name for name, _, _ in effect.parameters()]
    return effect.null(arm) if without is None else {name: without.value_of(name) for name in names}


def value_of(effect: Effect | None, key: str) -> float:
    """Return a parameter, named as `Effect.parameters` spells it."""
    assert effect is not None
    return effect.value_of(key)
