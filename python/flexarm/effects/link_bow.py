r"""Bow of a link: a curvature without load, from the mill, from welding, or from heat on one side.

.. math:: u(t) = u \, (1 - e^{-t/\tau})                                                              (1)

u [m] is where the tip of the unloaded beam is, from its place on a straight one, in the link's frame; t is
the time since the start of the run. With \tau = 0 the bow is there from the start; with \tau > 0 statics,
modes and the start of a run see none. Across the link the curvature is uniform, \kappa = 2 u / L^2, so that
at x

.. math:: w(x) = u \, (x/L)^2, \qquad \theta(x) = 2 u x / L^2                                        (2)

and the part along the link is a uniform stretch. To second order a bow also draws the tip in, by 2 u^2/(3 L).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from flexarm.arm.effect import Derivative, Effect, Search, Trial
from flexarm.arm.link import Beam
from flexarm.arm.prior import Prior
from flexarm.tables import Number, Vector3, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class LinkBow(Effect):
    """Curvature of an unloaded beam.

    `tip_offset` is u of (1), in the link's frame, and `time_constant` tau.
    """

    name = "link_bow"
    shape = ("time_constant",)
    tip_offset: Vector3 = value_in("m", "where the unloaded tip is, from a straight link's", (0.0, 0.0, 0.0))
    time_constant: Number = value_in("s", "time constant with which it grows; 0: constant", 0.0, ge=0)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Only beams have a curvature."""
        kind = arm.link(self.at).type
        if kind != "beam":
            yield "at", f"{self.at!r} is a {kind} link; only a beam has a bow: turn the joint that it carries"

    def patch(self, machine: Machine) -> None:
        """Set a rest curvature, eq. (1), (2)."""
        member = machine.links[self.at]
        member.bow, member.bow_time = self.tip_offset, self.time_constant  # eq. (1)

    def trials(self, search: Search) -> Iterator[Trial]:
        """Yield a constant bow and growing ones to start from; what stretches the link is no bow.

        A bow that takes hours grows straight in a record.
        """
        straight = {key: self.value_of(key) for key in self.along(search.arm)}
        yield Trial(fixed={"time_constant": 0.0, **straight})
        yield from (Trial({"time_constant": seconds}, straight) for seconds in (10.0, 100.0))

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Straightness of tubes, and the sun on one side of them."""
        link, along = arm.link(self.at), self.along(arm)
        length = link.length if isinstance(link, Beam) else 1.0
        source = (
            "engineering judgement: tubes straight to 1 in 1000, whose arc puts the tip four times as far; "
            "10 K across a steel tube of 60 mm bend 3 m of it by 9 mm"
        )
        stretch = "engineering judgement: 20 K of steel are 1 in 4000 of the length"
        heat = "engineering judgement: a steel wall of 2 to 20 mm follows the air in minutes to hours"
        return {
            **{
                f"tip_offset.{axis}": Prior(-4e-3 * length, 4e-3 * length, 0.0, "linear", "m", source)
                if f"tip_offset.{axis}" not in along
                else Prior(-3e-4 * length, 3e-4 * length, 0.0, "linear", "m", stretch)
                for axis in "xyz"
            },
            "time_constant": Prior(20.0, 1e4, 600.0, "log", "s", heat),
        }

    def along(self, arm: Arm) -> tuple[str, ...]:
        """Keys of the part of the tip's offset that runs along the beam and stretches it."""
        link = arm.link(self.at)
        if not isinstance(link, Beam):
            return ()
        return tuple(
            f"tip_offset.{k}" for k, x in zip("xyz", link.end, strict=True) if abs(x) > 0.9 * link.length
        )

    def derivative(self, parameter: str) -> Derivative:
        """None by a time constant of zero, which is not the limit of short ones."""
        return "none" if parameter == "time_constant" and self.time_constant == 0 else "smooth"
