r"""Springs with dampers: effects whose prediction is linear in the flexibility 1/k, not in the stiffness k.

.. math:: 1/(k + i \omega c) = 1/k - i \omega c / k^2 + \dots                                           (1)

In series flexibilities 1/k add up, and so do the losses c/k^2.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import isinf
from typing import TYPE_CHECKING, ClassVar, Self

from flexarm.arm.effect import Effect, Trial
from flexarm.arm.joint_units import priors_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arm.prior import Prior


class SpringEffect(Effect):
    """A spring and damper; a subclass has `stiffness`, infinite where it is rigid, and `damping`."""

    is_spring = True
    one_signed = True
    shape = ("damping",)
    in_motion = ("damping",)
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

    @property
    def inert(self) -> bool:
        """Return True if it is rigid."""
        return isinf(self.value_of("stiffness"))

    def stated_priors(self, arm: Arm) -> dict[str, Prior]:
        """Return priors about this spring as a model states it: near that, whatever others have."""
        if self.inert:
            return {}
        k, within = self.value_of("stiffness"), self.stated_within
        source = f"engineering judgement: data sheets and earlier fits hold to a factor of {within:g}"
        usual = priors_in(self, arm)["stiffness"]
        return {"stiffness": replace(usual, low=k / within, high=k * within, typical=k, source=source)}

    def trials(
        self, stated: Effect | None, arm: Arm, frequencies: Sequence[float], softer: Sequence[float]
    ) -> Iterator[Trial]:
        """Yield softer and softer springs, from the typical or the stated one on."""
        if stated is None or stated.inert:
            stiffness = self.typical_stiffness
        else:
            stiffness = stated.value_of("stiffness") / self.least_softer
        yield from (Trial(start={"stiffness": stiffness / times}) for times in softer)

    def probes(
        self,
        stated: Effect | None,
        free: Sequence[str],
        null: Mapping[str, float],
        priors: Mapping[str, Prior],
    ) -> Iterator[Self]:
        """Yield this spring, with a damping in proportion."""
        k = self.value_of("stiffness")
        if stated is None or stated.inert:
            damping = self.typical_damping * k
        else:
            damping = stated.value_of("damping") * self.least_softer * k / stated.value_of("stiffness")
        yield self.with_parameters({"stiffness": k, "damping": damping})

    def sized(
        self,
        multiples: Sequence[float],
        probes: Sequence[Effect],
        null: Mapping[str, float],
        stated: Effect | None,
        least: float,
    ) -> dict[str, float]:
        """Return the spring of a multiple of its probe's flexibility, eq. (1)."""
        soft, nominal = 1.0 / probes[0].value_of("stiffness"), flexibility(stated)[0]
        return self._of_flexibility(max(nominal + multiples[0] * (soft - nominal), least * soft), 0.0)

    def acting_as(
        self, other: Effect, other_stated: Effect | None, stated: Effect | None
    ) -> dict[str, float]:
        """Return a spring as much softer and more lossy than stated as another spring is, eq. (1).

        It stays as it is where nothing softer than rigid would do that.
        """
        soft, loss = (
            here + there - before
            for here, there, before in zip(
                flexibility(stated), flexibility(other), flexibility(other_stated), strict=True
            )
        )
        return self._of_flexibility(soft, loss) if soft > 0 else {}

    def _of_flexibility(self, soft: float, loss: float) -> dict[str, float]:
        """Return k and c of 1/k and c/k^2; a typical damping where there is no loss."""
        stiffness = 1.0 / soft
        damping = loss * stiffness**2 if loss > 0 else self.typical_damping * stiffness
        return {"stiffness": stiffness, "damping": damping}


def flexibility(spring: Effect | None) -> tuple[float, float]:
    """Return 1/k and c/k^2 of a spring; zeros without one."""
    if spring is None or spring.inert:
        return 0.0, 0.0
    k = spring.value_of("stiffness")
    return 1.0 / k, spring.value_of("damping") / k**2
