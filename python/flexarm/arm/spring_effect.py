r"""Springs with dampers: effects whose prediction is linear in the flexibility 1/k, not in the stiffness k.

.. math:: 1/(k + i \omega c) = 1/k - i \omega c / k^2 + \dots                                           (1)

In series flexibilities 1/k add up, and so do the losses c/k^2. A spring about two axes has a stiffness for
each; a search then begins with one of them soft and the other as good as rigid.

Reducers and bearings are chosen by their load, and their stiffness goes with it. Typical stiffnesses are
stated for the paper's arm, which carries S_0 = 63 kg m. Where joints carry S = sum m d, of masses m at
distances d,

.. math:: k_{typical} \to k_{typical} \max(1, S/S_0)                                                  (2)

with the greatest S of the machine. Small joints at its end are no stiffer for that: the range of plausible
stiffnesses gains at its upper end only.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isinf
from typing import Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, model_validator

from flexarm.arm.arm import Arm
from flexarm.arm.effect import Effect, Probes, Search, Trial
from flexarm.arm.joint_units import along, priors_in
from flexarm.arm.prior import Prior, Priors, Values
from flexarm.arm.rotation import Vector
from flexarm.arm.weight import carried_moment
from flexarm.tables import Inconsistent, Number, Vector2, to_python


def one_or_two(unit: str, positive: bool) -> BeforeValidator:
    """Return a check of one number, or of two for two axes, in a unit."""

    def check(value: Any) -> Any:
        value = to_python(value)
        numbers = tuple(value) if isinstance(value, list | tuple) else (value,)
        right = all(isinstance(number, int | float) and not isinstance(number, bool) for number in numbers)
        if len(numbers) not in (1, 2) or not right:
            raise ValueError(f"must be one number or two, one for each axis [{unit}], got {value!r}")
        for number in numbers:
            if number < 0 or (positive and number == 0):
                what = "be positive" if positive else "not be negative"
                raise ValueError(f"must {what}, got {number:g} {unit}")
        return tuple(map(float, numbers)) if len(numbers) == 2 else float(numbers[0])

    return BeforeValidator(check)


Stiffness = Annotated[Number | Vector2, one_or_two("N m/rad", positive=True)]
Damping = Annotated[Number | Vector2, one_or_two("N m s/rad", positive=False)]
"""About one axis, or about each of two."""


class SpringEffect(Effect):
    """A spring and damper; a subclass has `stiffness`, infinite where it is rigid, and `damping`."""

    is_spring = True
    one_signed = True
    shape = ("damping", "damping.x", "damping.y")
    in_motion = ("damping", "damping.x", "damping.y")
    varies_with = "torque"
    typical_stiffness: ClassVar[float] = 1e5
    """Of a rotary reducer that moves such arms [N m/rad]; a rigid spring is probed with it."""
    typical_damping: ClassVar[float] = 2e-3
    """Damping over stiffness [s]: zeta = omega c/(2 k) is 1.6 % of critical at 2.5 Hz."""
    softer: ClassVar[tuple[float, ...]] = (1.0, 30.0, 300.0)
    """Factors by which it is probed softer than typical: once it moves a mode, it is no small step."""
    least_softer: ClassVar[float] = 1.2
    """The same of a stated spring, besides `softer`."""
    stated_within: ClassVar[float] = 5.0
    """Factor within which 95 % of springs are as stated."""
    usual_load: ClassVar[float] = 63.0
    """S_0 of (2) [kg m]."""
    rigid: ClassVar[float] = 1e12
    """About one of two axes a spring as stiff as this counts as rigid [N m/rad]."""

    @model_validator(mode="after")
    def _as_many(self) -> Self:
        if len(self.stiffnesses) < len(self._keyed("damping")):
            raise Inconsistent((("damping",), "has two numbers and the stiffness one; give it two as well"))
        return self

    @property
    def stiffnesses(self) -> dict[str, float]:
        """Stiffness [N m/rad] about its axis, or about each of two, by its key."""
        return self._keyed("stiffness")

    def _keyed(self, name: str) -> dict[str, float]:
        value = getattr(self, name)
        if isinstance(value, tuple):
            return {f"{name}.{axis}": item for axis, item in zip("xy", value, strict=True)}
        return {name: value}

    def about_both_axes(self) -> list[tuple[float, float]]:
        """Return stiffness and damping about each of two axes; a single number holds for both."""
        k, c = (list(self._keyed(name).values()) for name in ("stiffness", "damping"))
        return list(zip(k * (2 // len(k)), c * (2 // len(c)), strict=True))

    def soft_about(self, axes: Sequence[Vector]) -> list[tuple[Vector, float, float]]:
        """Return axis, stiffness and damping about such axes, without those about which it is rigid."""
        each = zip(axes, self.about_both_axes(), strict=False)
        return [(axis, k, c) for axis, (k, c) in each if k < self.rigid]

    @property
    def softest(self) -> float:
        """Return the least stiffness [N m/rad]."""
        return min(self.stiffnesses.values())

    @property
    def inert(self) -> bool:
        """Return True if it is rigid."""
        return isinf(self.softest)

    def null(self, arm: Arm) -> dict[str, float]:
        """Return no damping, and of two stiffnesses both rigid."""
        soft = self.stiffnesses
        return {**super().null(arm), **(dict.fromkeys(soft, self.rigid) if len(soft) == 2 else {})}

    def spring_priors(self, arm: Arm, low: float, high: float, source: str) -> dict[str, Prior]:
        """Return priors of stiffnesses within a range and, in proportion, of dampings [their units].

        `high` is that of a usual load, see (2).
        """
        typical = self.typical_in(arm)
        k = typical if self.inert else self.softest
        loss = "engineering judgement: 0.1 to 10 % of critical for an arm that swings at a few Hz"
        spring = Prior(low, high * self.heavier(arm), typical, "log", self.unit("stiffness"), source)
        damper = Prior(1e-4 * k, 1e-2 * k, self.typical_damping * k, "log", self.unit("damping"), loss)
        return {**dict.fromkeys(self.stiffnesses, spring), **dict.fromkeys(self._keyed("damping"), damper)}

    def stated_priors(self, arm: Arm) -> dict[str, Prior]:
        """Return priors about this spring as a model states it: near that, whatever others have."""
        if self.inert:
            return {}
        within = self.stated_within
        source = f"engineering judgement: data sheets and earlier fits hold to a factor of {within:g}"
        usual = priors_in(self, arm)
        return {
            key: replace(usual[key], low=k / within, high=k * within, typical=k, source=source)
            for key, k in self.stiffnesses.items()
        }

    def first_stiffness(self, arm: Arm) -> float:
        """Return the stiffness [N m/rad, N/m] that a search begins with where the model states none."""
        return self.typical_in(arm) * along(self, arm, "stiffness", "N m/rad")

    def typical_in(self, arm: Arm) -> float:
        """Return the typical stiffness about a joint of a machine as heavy as this one, eq. (2)."""
        return self.typical_stiffness * self.heavier(arm)

    def heavier(self, arm: Arm) -> float:
        """Return the factor of (2)."""
        return max(1.0, carried_moment(arm) / self.usual_load)

    def trials(self, search: Search) -> Iterator[Trial]:
        """Yield softer and softer springs, from the typical or the stated one on."""
        start, stated = dict.fromkeys(self.stiffnesses, self.first_stiffness(search.arm)), search.stated
        if isinstance(stated, SpringEffect) and not stated.inert:
            start = {key: k / self.least_softer for key, k in stated.stiffnesses.items()}
        yield from (Trial(start={key: k / times for key, k in start.items()}) for times in search.softer)

    def probes(
        self, stated: Effect | None, free: Sequence[str], null: Values, priors: Priors
    ) -> Iterator[Self]:
        """Yield this spring, about one axis after the other, with a damping in proportion."""
        for key, k in self.stiffnesses.items():
            rest = {other: null[other] for other in self.stiffnesses if other != key}
            soft, loss = flexibility(stated, key)
            seconds = self.least_softer * loss / soft if soft else self.typical_damping
            damping = dict.fromkeys(self._keyed("damping"), seconds * k)
            yield self.with_parameters({**rest, key: k, **damping})

    def sized(self, multiples: Sequence[float], probed: Probes) -> dict[str, float]:
        """Return the spring of a multiple of the flexibility of each of its probes, eq. (1)."""
        found: dict[str, float] = {}
        for multiple, probe in zip(multiples, probed.effects, strict=True):
            assert isinstance(probe, SpringEffect)
            key = next(key for key, k in probe.stiffnesses.items() if k != probed.null[key])
            soft, nominal = 1.0 / probe.stiffnesses[key], flexibility(probed.stated, key)[0]
            found[key] = 1.0 / max(
                nominal + multiple * (soft - nominal), probed.least * soft, 1.0 / self.rigid
            )
        return {**found, **self._damped(min(found.values()))}

    def acting_as(
        self, other: Effect, other_stated: Effect | None, stated: Effect | None
    ) -> dict[str, float]:
        """Return a spring as much softer and more lossy than stated as another spring is, eq. (1).

        It stays as it is where nothing softer than rigid would do that. Of two axes both become as soft.
        """
        soft, loss = (
            here + there - before
            for here, there, before in zip(
                flexibility(stated), flexibility(other), flexibility(other_stated), strict=True
            )
        )
        if soft <= 0:
            return {}
        stiffness = 1.0 / soft
        return {**dict.fromkeys(self.stiffnesses, stiffness), **self._damped(stiffness, loss * stiffness)}

    def _damped(self, stiffness: float, seconds: float = 0.0) -> dict[str, float]:
        """Return a damping over stiffness of so many seconds; a typical one where that is no loss."""
        damping = (seconds if seconds > 0 else self.typical_damping) * stiffness
        return dict.fromkeys(self._keyed("damping"), damping)


def flexibility(spring: Effect | None, key: str | None = None) -> tuple[float, float]:
    """Return 1/k and c/k^2 of a spring about an axis, by default the softest; zeros without one."""
    if not isinstance(spring, SpringEffect) or spring.inert:
        return 0.0, 0.0
    about = dict(zip(spring.stiffnesses, spring.about_both_axes(), strict=False))
    k, c = about[key] if key else min(about.values())
    return 1.0 / k, c / k**2
