r"""Sines: effects whose prediction is linear in the parts of a sine and a cosine.

.. math:: A \sin(x + \beta) = A \cos\beta \, \sin x + A \sin\beta \, \cos x                             (1)
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import atan2, hypot, pi
from typing import ClassVar, Self

from flexarm.arm.effect import Effect, Probes
from flexarm.arm.prior import Priors, Values


class WaveEffect(Effect):
    """A sine; a subclass has `amplitude` and `phase`."""

    is_wave = True
    shape: ClassVar[tuple[str, ...]] = ("phase",)

    def probes(
        self, stated: Effect | None, free: Sequence[str], null: Values, priors: Priors
    ) -> Iterator[Self]:
        """Yield a sine and a cosine of typical size."""
        for phase in (0.0, pi / 2):
            yield self.with_parameters({"phase": phase, "amplitude": priors["amplitude"].typical})

    def sized(self, multiples: Sequence[float], probed: Probes) -> dict[str, float]:
        """Return amplitude and phase of the sum of a sine and a cosine, eq. (1)."""
        sine, cosine = multiples
        size = probed.effects[0].value_of("amplitude")
        return {"amplitude": max(hypot(sine, cosine), 1e-3) * size, "phase": atan2(cosine, sine)}
