r"""Length of a beam that is not the nominal one.

.. math:: L \leftarrow L + \text{error}                                                              (1)

Payloads and points keep their fraction of the length (those beyond an end their distance from it), joints
with `at = "end"` follow. Section and density stay, so the mass grows with the length. The nominal arm, from
which displacements are counted, does not change.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from flexarm.arm.effect import Effect
from flexarm.arm.link import Beam
from flexarm.arm.prior import Prior
from flexarm.arm.rotation import added, dot, scaled
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Load, Machine, Place


class LinkLength(Effect):
    """Error of a beam's length.

    `error` is positive where the link is longer than nominal.
    """

    name = "link_length"
    error: Number = value_in("m", "what the link is longer than nominal", 0.0)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Only a beam has a length, and it stays positive."""
        link = arm.link(self.at)
        if not isinstance(link, Beam):
            what = (
                f"{self.at!r} is a {link.type} link and has no length; "
                "what hangs on it stands where joints and positions say"
            )
            yield "at", what
        elif link.length + self.error <= 0:
            yield "error", f"must leave a length of {self.at!r}, {link.length:g} m long, got {self.error:g} m"

    def patch(self, machine: Machine) -> None:
        """Another end, eq. (1), and places that follow."""
        member = machine.links[self.at]
        beam = member.table
        assert isinstance(beam, Beam)
        carried: list[Load | Place] = [*machine.payloads.values(), *machine.points.values()]
        carried += machine.ends.values()
        for place in carried:
            if place.link == self.at:
                fraction = min(max(dot(place.position, beam.end) / beam.length / beam.length, 0.0), 1.0)
                place.position = added(place.position, scaled(fraction * self.error / beam.length, beam.end))
        member.table = beam.replace(end=scaled(1 + self.error / beam.length, beam.end))  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of a welded link."""
        link = arm.link(self.at)
        size = 2e-3 * (link.length if isinstance(link, Beam) else 1.0)
        source = "ISO 2768-1, class c: 3 mm on 1 to 2 m, 4 mm on 2 to 4 m; joints sit no better than that"
        return {"error": Prior(-size, size, 0.0, "linear", "m", source)}
