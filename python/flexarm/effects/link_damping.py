r"""Damping of a link that is not the nominal one.

.. math:: \zeta \leftarrow \text{damping\_ratio}, \qquad \eta = 2 \zeta / \omega_1                   (1)

of the link alone in its first clamped mode, without payload; \eta [s] is the factor of its
stiffness-proportional damping. On an arm with a payload and a soft hub, whose mode is slower, the ratio seen
is smaller, \eta \omega / 2. Of a super-element the ratio replaces the damping in its file; zero leaves that.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from flexarm.arm.effect import Effect
from flexarm.arm.link import WEIGHTLESS, Beam, RigidLink
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class LinkDamping(Effect):
    """Another damping ratio of a link."""

    name = "link_damping"
    in_motion = ("damping_ratio",)
    non_negative = ("damping_ratio",)
    varies_with = "rate"
    damping_ratio: Number = value_in("-", "damping ratio of the link's first clamped mode", 0.0, ge=0, lt=1)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Return problems: a rigid link does not deform, one without mass does not vibrate."""
        link = arm.link(self.at)
        if isinstance(link, Beam) and link.material.density == 0 and self.damping_ratio > 0:
            yield "damping_ratio", WEIGHTLESS.format(ratio=self.damping_ratio)
        if link.type == "rigid":
            yield "at", f"{self.at!r} is rigid and damps nothing; joint_compliance of its joint has a damping"

    def patch(self, machine: Machine) -> None:
        """Another ratio, eq. (1)."""
        member = machine.links[self.at]
        assert not isinstance(member.table, RigidLink)
        member.table = member.table.replace(damping_ratio=self.damping_ratio)  # eq. (1)

    def null(self, arm: Arm) -> dict[str, float]:
        """Return the link's own damping ratio."""
        return {"damping_ratio": getattr(arm.link(self.at), "damping_ratio", None) or 0.0}

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From welded steel to a link full of cables."""
        source = "engineering judgement: welded steel from 5e-4, bolted and with cables up to 5e-2"
        return {"damping_ratio": Prior(5e-4, 5e-2, 5e-3, "log", "-", source)}
