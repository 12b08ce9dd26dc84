r"""Bending stiffness of a link that is not the nominal one.

.. math:: EI \leftarrow \text{scale} \, EI                                                           (1)

in both planes of a beam; stretch, twist and shear keep their stiffness, and mass its value. Of a
super-element the whole stiffness matrix is scaled.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from flexarm.arm.effect import Effect
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class LinkStiffness(Effect):
    """Factor on the bending stiffness of a link."""

    name = "link_stiffness"
    varies_with = "torque"
    scale: Number = value_in("-", "factor on the bending stiffness EI", 1.0, gt=0)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Return problems: a rigid link does not bend."""
        if arm.link(self.at).type == "rigid":
            what = f"{self.at!r} is rigid and does not bend; make it a beam, or give its joint a compliance"
            yield "at", what

    def patch(self, machine: Machine) -> None:
        """Another stiffness, eq. (1)."""
        machine.links[self.at].bending_scale = self.scale  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Walls, moduli, and what joins the link at its ends."""
        source = "engineering judgement: walls of tubes within 10 %, moduli within 5 %, flanges that give way"
        return {"scale": Prior(0.6, 1.25, 1.0, "log", "-", source)}
