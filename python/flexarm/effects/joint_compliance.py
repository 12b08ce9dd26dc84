r"""Compliance of a joint: a linear spring and damper between motor and link.

.. math:: T = k (\varphi - \theta) + c (\dot\varphi - \dot\theta)                                    (1)

T [N m] is the torque on the link about +axis, \varphi the motor's angle over the ratio, \theta the link's
angle relative to its parent [rad]. Without this effect the drive train is rigid, \varphi = \theta.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import inf, isinf
from typing import TYPE_CHECKING, ClassVar

from flexarm.arm.effect import Effect
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine

TYPICAL_STIFFNESS = 1e5
"""Of a rotary reducer that moves such arms [N m/rad]."""
TYPICAL_DAMPING = 2e-3
"""Of a spring, over its stiffness [s]: zeta = omega c/(2 k) is 1.6 % of critical at 2.5 Hz."""


class JointCompliance(Effect):
    """Linear spring and damper between motor and link, output side.

    Parameters
    ----------
    at : str
        The joint.
    stiffness : float
        k of (1) [N m/rad]; N/m for a prismatic joint. Left out: infinite, so without effect.
    damping : float
        c of (1) [N m s/rad]; default 0.
    """

    name: ClassVar[str] = "joint_compliance"
    stiffness: Number = value_in("N m/rad", "stiffness of the joint", inf, gt=0)
    damping: Number = value_in("N m s/rad", "damping of the joint", 0.0, ge=0)

    def patch(self, machine: Machine) -> None:
        """Gives the reducer its spring and damper, eq. (1); damping cannot act in a rigid joint."""
        train = machine.drive_trains[self.at]
        train.stiffness, train.damping = self.stiffness, self.damping  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From small strain-wave to large cycloidal reducers; damping in proportion to the stiffness."""
        stiffness = TYPICAL_STIFFNESS if isinf(self.stiffness) else self.stiffness
        return {
            "stiffness": Prior(
                3e3,
                4e6,
                TYPICAL_STIFFNESS,
                "log",
                "N m/rad",
                "catalogues: small strain-wave reducers (some 1e3) to large cycloidal ones (1200 N m/arcmin)",
            ),
            "damping": Prior(
                1e-4 * stiffness,
                1e-2 * stiffness,
                TYPICAL_DAMPING * stiffness,
                "log",
                "N m s/rad",
                "engineering judgement: 0.1 to 10 % of critical for an arm that swings at a few Hz",
            ),
        }


def spring_at(arm: Arm, joint: str) -> float:
    """Stiffness of the joint's compliance [N m/rad]; a typical one where it has none."""
    found = [effect.stiffness for effect in arm.effects_at(joint) if isinstance(effect, JointCompliance)]
    return found[-1] if found and not isinf(found[-1]) else TYPICAL_STIFFNESS


def without_spring(effect: Effect, arm: Arm) -> Iterable[tuple[str, str]]:
    """What an effect of the reducer's deflection has to say of a joint that is rigid."""
    springs = (other for other in arm.effects_at(effect.at) if isinstance(other, JointCompliance))
    if all(isinf(spring.stiffness) for spring in springs):
        yield (
            "at",
            f"{effect.name} needs a joint_compliance with a stiffness at the same joint, and {effect.at!r} "
            f'is rigid; add [[effects]] name = "joint_compliance", at = "{effect.at}", stiffness = ...',
        )
