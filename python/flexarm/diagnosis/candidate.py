"""An effect at a place: the parameters that are fitted, and the probes that screen it (`arm.effect`)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from flexarm.arm import Arm
from flexarm.arm.effect import Effect
from flexarm.arm.joint_units import priors_in
from flexarm.arm.prior import Prior


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
    def at(self) -> str:
        """Return the name of its place."""
        return self.effect.at

    @property
    def place(self) -> tuple[str, str]:
        """Return name and place: candidates of one place are variants of one effect."""
        return self.name, self.at

    @property
    def stands_on(self) -> tuple[str, str] | None:
        """Return name and place of the effect that it needs and the model has not."""
        return None if self.needs is None else (self.needs.name, self.needs.at)

    def priors_in(self, arm: Arm) -> dict[str, Prior]:
        """Return the priors of all parameters in a model."""
        return {**priors_in(self.effect, arm), **self.priors}

    def base(self, arm: Arm) -> Arm:
        """Return the model that a probe differs from: with what the effect needs, unless that is there."""
        if self.needs is None or arm.effect(self.needs.name, self.needs.at) is not None:
            return arm
        return arm.with_effect(self.needs)

    def sized(self, multiples: Sequence[float], least: float = 0.02) -> Effect:
        """Return the effect of multiples of its probes; `least` as in `Effect.sized`."""
        return self._at(self.effect.sized(multiples, self.probes, self.null, self.without, least))

    def nudged(self, probe: int, part: float) -> Effect:
        """Return the effect of a small part of one of its probes, for derivatives."""
        return self.sized([part if k == probe else 0.0 for k in range(len(self.probes))], least=0.0)

    def acting_as(self, other: Candidate) -> Candidate | None:
        """Return this candidate at the size that plays the part of another one; None where it has no such."""
        alike = self.effect.is_spring and other.effect.is_spring
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
        arm = member.base(arm).with_effect(member.effect)
    return arm


def carries(members: Sequence[Candidate], spring: Candidate) -> bool:
    """Return True if other effects require a spring that the model has not."""
    return any(member.stands_on == spring.place for member in members)


def nulls(effect: Effect, without: Effect | None, arm: Arm) -> dict[str, float]:
    """Return the value of every parameter at which the model is what it is without the effect."""
    names = [name for name, _, _ in effect.parameters()]
    return effect.null(arm) if without is None else {name: without.value_of(name) for name in names}


def value_of(effect: Effect | None, key: str) -> float:
    """Return a parameter, named as `Effect.parameters` spells it."""
    assert effect is not None
    return effect.value_of(key)
