r"""Radial clearance of a joint: play of its pin in its hole, in which the bearing takes no force.

.. math:: F_i = k \max(e - c_r, 0) \, u_i/e + c \, g(e) \, \dot u_i, \qquad e = |u|, \quad i = 1, 2     (1)

u_i [m] and F_i [N] are those of the joint's `joint_radial_compliance`, which it needs: its stiffness k, one
for both axes, and its damping c are those of the contact. Within the radial clearance c_r, the radius of the
hole less that of the pin, the damping fades within 2e-5 m to a hundredth of it, and a 1e-4 part of the
stiffness is left, so that a pin without force rests in the middle. At rest the pin lies where its force
pushes it. There is no friction between the two.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from flexarm.arm.closure import PINNED
from flexarm.arm.effect import Derivative, Effect
from flexarm.arm.prior import Prior
from flexarm.effects.joint_radial_compliance import JointRadialCompliance
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from collections.abc import Iterable

    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class JointRadialClearance(Effect):
    """Play between a pin and its hole.

    `clearance` is c_r of (1).
    """

    name = "joint_radial_clearance"
    pins_of_loops_only = True
    requires = "joint_radial_compliance"
    at_closures = PINNED
    always_turns = True
    smooth = False
    one_signed = True
    non_negative = ("clearance",)
    multistart = "clearance"
    varies_with = "torque"
    clearance: Number = value_in("m", "radius of the hole less that of the pin", 0.0, ge=0)

    def patch(self, machine: Machine) -> None:
        """Open a gap in the springs of both slides, eq. (1)."""
        from flexarm import _core

        mount = machine.mounts[self.at]
        slides = [k for k, hinge in enumerate(mount) if hinge.slides]
        for k, across in zip(slides, (1, -1), strict=True):
            spring = _core.ReducerSpring(mount[k].stiffness, mount[k].damping, gap=2 * self.clearance)
            mount[k] = replace(mount[k], laws=(_core.RadialClearance(spring, across),))  # eq. (1)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Return that the bearing has no spring, or one that differs between its axes."""
        found = list(super().problems(arm))
        for spring in arm.effects_at(self.at):
            if not isinstance(spring, JointRadialCompliance) or spring.inert:
                continue
            if len({*spring.about_both_axes()}) > 1 or spring.softest >= spring.rigid:
                what = (
                    f"needs one stiffness below {spring.rigid:g} N/m and one damping for both axes of "
                    f"{self.at!r}; its {self.requires} has stiffness = {list(spring.stiffnesses.values())}"
                )
                found.append(("at", f"{self.name} {what}"))
        return found

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From a fitted pin to a worn bush."""
        source = "catalogues: running fits of pins of 30 to 100 mm leave 10 to 100 um, worn bushes 1 mm"
        return {"clearance": Prior(5e-6, 1e-3, 5e-5, "log", "m", source)}

    def derivative(self, parameter: str) -> Derivative:
        """One-sided at zero, where a play can only open."""
        return "smooth" if self.clearance > 0 else "one-sided"
