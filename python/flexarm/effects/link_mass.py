r"""Mass of a link that is not the nominal one.

.. math:: \rho A \leftarrow \text{scale} \, \rho A, \quad \rho I \leftarrow \text{scale} \, \rho I   (1)

of a beam; mass and inertia of a rigid link, and the mass matrix of a super-element, alike.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from flexarm.arm.effect import Effect
from flexarm.arm.link import Beam
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class LinkMass(Effect):
    """Factor on the mass of a link."""

    name = "link_mass"
    scale: Number = value_in("-", "factor on the mass per length", 1.0, gt=0)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Return problems: a factor on nothing changes nothing."""
        link = arm.link(self.at)
        mass = link.material.density if isinstance(link, Beam) else getattr(link, "mass", 1.0)
        if mass == 0:
            yield "at", f"{self.at!r} has no mass, of which a factor could be; give it one"

    def patch(self, machine: Machine) -> None:
        """Another mass, eq. (1)."""
        machine.links[self.at].mass_scale = self.scale  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """More often too light than too heavy in a model."""
        source = "engineering judgement: walls of tubes within 10 %; cables, paint and flanges left out"
        return {"scale": Prior(0.85, 1.4, 1.0, "log", "-", source)}
