"""An effect at a place, with what is free in it and how it is probed.

A candidate is probed by finite steps: the model with the effect at a plausible size, one probe for each
direction in which its parameters can move the prediction,

    f(model with probe_i) - f(model without) = d_i                                                    (1)

and how much of it is there follows from least squares, measured - f ~ sum alpha_i d_i. Most laws are linear
in their amplitudes, springs in their flexibility, waves in amplitude and phase (two probes a quarter of a
turn apart); `Candidate.sized` turns the alphas into parameters that start a fit of the true, nonlinear law.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import atan2, hypot, isinf

from flexarm.arm import Arm
from flexarm.arm.effect import Effect
from flexarm.arm.joint_units import priors_in
from flexarm.arm.prior import Prior
from flexarm.effects.joint_compliance import TYPICAL_DAMPING

WAVES = ("transmission_error", "encoder_eccentricity", "external_vibration")
SPRINGS = ("joint_compliance", "base_compliance")
SHAPES = ("width", "time_constant")
"""Parameters that shape what others size: they start a fit as they are probed."""
POSITIVE = ("torque", "gap", "coefficient", "coulomb", "viscous", "cubic_stiffness", "damping_ratio")
"""Parameters that cannot be negative."""
LEAST = 0.02
"""Of these, the least part of a probe that a fit starts from."""


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
        Of (1).
    without : Effect or None
        The nominal effect, if the model has it.
    null : dict of str to float
        Values at which the model is what it is without.
    needs : Effect or None
        What the model must have besides, and has not.
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
        """Of the effect."""
        return self.effect.name

    @property
    def at(self) -> str:
        """Its place."""
        return self.effect.at

    @property
    def place(self) -> tuple[str, str]:
        """Name and place: candidates of one place are variants of one effect."""
        return self.name, self.at

    @property
    def stands_on(self) -> tuple[str, str] | None:
        """Name and place of what it needs: a law on a spring that is not there comes only with that."""
        return None if self.needs is None else (self.needs.name, self.needs.at)

    def priors_in(self, arm: Arm) -> dict[str, Prior]:
        """Of all parameters in a model."""
        return {**priors_in(self.effect, arm), **self.priors}

    def base(self, arm: Arm) -> Arm:
        """The model that a probe differs from: with what the effect needs, unless that is there."""
        if self.needs is None or arm.effect(self.needs.name, self.needs.at) is not None:
            return arm
        return arm.with_effect(self.needs)

    def sized(self, alphas: Sequence[float], least: float = LEAST) -> Effect:
        """The effect of the size that least squares give to its probes.

        What cannot be negative has at least so much of them, from where a fit can start.
        """
        if self.name in SPRINGS:
            return self._spring(float(alphas[0]), least)
        if self.name in WAVES:
            sine, cosine = (float(a) for a in alphas)
            size = value_of(self.probes[0], "amplitude")
            return self._at(
                {"amplitude": max(hypot(sine, cosine), 1e-3) * size, "phase": atan2(cosine, sine)}
            )
        if self.name == "cable_torque":
            first, second = (float(a) for a in alphas)
            k = (first + second) * value_of(self.probes[0], "stiffness")
            size = value_of(self.probes[1], "stiffness") * value_of(self.probes[1], "rest_angle")
            return self._at({"stiffness": k, "rest_angle": second * size / k if k else 0.0})
        return self._linear(alphas, least)

    def nudged(self, probe: int, part: float) -> Effect:
        """The effect of a small part of one of its probes, for derivatives."""
        return self.sized([part if k == probe else 0.0 for k in range(len(self.probes))], least=0.0)

    def _linear(self, alphas: Sequence[float], least: float) -> Effect:
        values: dict[str, float] = {}
        for name in self.free:
            null = self.null[name]
            moves = [value_of(probe, name) - null for probe in self.probes]
            if not any(moves) or name in SHAPES:
                continue
            values[name] = null + sum(a * m for a, m in zip(alphas, moves, strict=True))
            if name in POSITIVE:
                values[name] = max(values[name], least * max(abs(m) for m in moves))
            elif null > 0:
                values[name] = max(values[name], 0.3 * null)
        return self._at(values)

    def _spring(self, alpha: float, least: float) -> Effect:
        soft = 1.0 / value_of(self.probes[0], "stiffness")
        there = value_of(self.without, "stiffness") if self.without is not None else float("inf")
        nominal = 0.0 if isinf(there) else 1.0 / there
        flexibility = max(nominal + alpha * (soft - nominal), least * soft)
        stiffness = 1.0 / flexibility
        return self._at({"stiffness": stiffness, "damping": TYPICAL_DAMPING * stiffness})

    def as_soft_as(self, other: Candidate) -> Candidate:
        """This spring, giving way and losing as much more than the nominal one as another spring does.

        1/(k + i w c) is 1/k - i w c/k^2 to first order: flexibilities 1/k add up in series, and so do c/k^2.
        """
        soft, loss = (
            here + there - before
            for here, there, before in zip(
                _given_way(self.without), _given_way(other.effect), _given_way(other.without), strict=True
            )
        )
        if soft <= 0:
            return self
        stiffness = 1.0 / soft
        damping = loss * stiffness**2 if loss > 0 else TYPICAL_DAMPING * stiffness
        return replace(self, effect=self._at({"stiffness": stiffness, "damping": damping}))

    def as_stiff_as(self, spring: Candidate) -> Candidate | None:
        """This hysteresis, T_h/w stiff while it sticks, for a spring stiffer than its joint's nominal one.

        None if that is softer.
        """
        if spring.without is None or isinf(value_of(spring.without, "stiffness")):
            return None
        stiffer = value_of(spring.effect, "stiffness") - value_of(spring.without, "stiffness")
        if stiffer <= 0:
            return None
        return replace(self, effect=self._at({"torque": stiffer * value_of(self.effect, "width")}))

    def _at(self, values: Mapping[str, float]) -> Effect:
        return self.effect.with_parameters({k: v for k, v in values.items() if k in self.free})


def _given_way(spring: Effect | None) -> tuple[float, float]:
    """1/k and c/k^2 of a spring; 0 without one."""
    if spring is None or isinf(stiffness := value_of(spring, "stiffness")):
        return 0.0, 0.0
    return 1.0 / stiffness, value_of(spring, "damping") / stiffness**2


def springs_first(members: Iterable[Candidate]) -> list[Candidate]:
    """Effects in the order in which they enter a model: a law finds the spring that it acts on."""
    return sorted(members, key=lambda member: member.name not in SPRINGS)


def with_members(arm: Arm, members: Iterable[Candidate]) -> Arm:
    """A model with effects, and with what they need."""
    for member in springs_first(members):
        arm = member.base(arm).with_effect(member.effect)
    return arm


def carries(members: Sequence[Candidate], spring: Candidate) -> bool:
    """Whether other effects stand on a spring."""
    return any(member.stands_on == spring.place for member in members)


def value_of(effect: Effect | None, key: str) -> float:
    """A parameter, as `Effect.parameters` spells it."""
    field, _, axis = key.partition(".")
    found = getattr(effect, field)
    return float(found["xyz".index(axis)] if axis else found)
