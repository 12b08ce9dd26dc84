r"""Harmonic error of an encoder: two, three or more periods per turn of the output.

.. math:: \text{reading} = \text{true}
   + \text{amplitude} \, \sin(\text{order} \cdot \text{true} + \text{phase})                          (1)

An oval disc or a pair of misplaced reading heads err twice per turn, resolvers with unequal windings too.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import pi

from flexarm.arm.arm import Arm
from flexarm.arm.effect import Search, Trial
from flexarm.arm.prior import Prior
from flexarm.effects.periodic_encoder_error import PeriodicEncoderError
from flexarm.tables import Number, value_in


class EncoderHarmonics(PeriodicEncoderError):
    """Error of an encoder several times per output turn."""

    name = "encoder_harmonics"
    shape = ("order", "phase")
    order: Number = value_in("-", "periods of the error per output turn", 2.0, ge=1)
    amplitude: Number = value_in("rad", "amplitude of the error", 0.0, ge=0, lt=1)
    phase: Number = value_in("rad", "phase of the error at the true angle zero", 0.0)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Also refuse a reading that turns back while the joint goes on."""
        yield from super().problems(arm)
        if self.amplitude * self.order >= 1:
            yield (
                "amplitude",
                f"must keep amplitude x order below 1, got {self.amplitude:g} rad x {self.order:g}: "
                "the reading would turn back at times",
            )

    def null(self, arm: Arm) -> dict[str, float]:
        """Return no amplitude, of the same order."""
        return {**super().null(arm), "order": self.order}

    def trials(self, search: Search) -> Iterator[Trial]:
        """Yield the orders of oval and three-lobed discs."""
        yield from (Trial(fixed={"order": order}) for order in (2.0, 3.0))

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of a disc that is clamped out of round by micrometres."""
        form = "engineering judgement: discs of 10 to 100 mm radius are out of round by up to 20 um"
        orders = "engineering judgement: twice a turn where a hub is oval, three times in a chuck's jaws"
        return {
            "order": Prior(1.5, 6.0, 2.0, "log", "-", orders),
            "amplitude": Prior(5e-6, 1e-3, 7e-5, "log", "rad", form),
            "phase": Prior(-pi, pi, 0.0, "uniform", "rad", "any angle"),
        }
