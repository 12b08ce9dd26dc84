r"""Cables and hoses that bend with a joint and pull it back to where they are at rest.

.. math:: T \leftarrow T - k_c (\theta - \theta_r)                                                      (1)

T [N m] is the torque on the link about +axis, \theta [rad] the link's angle relative to its parent.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import pi
from typing import TYPE_CHECKING, Self

from flexarm.arm.closure import PINNED
from flexarm.arm.effect import Effect, Probes
from flexarm.arm.prior import Prior, Priors, Values
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class CableTorque(Effect):
    """A spring of the cables at the output.

    `stiffness` is k_c and `rest_angle` theta_r of (1).
    """

    name = "cable_torque"
    torque_at = "output"
    at_closures = PINNED
    stiffness: Number = value_in("N m/rad", "stiffness of the cables", 0.0, ge=0)
    rest_angle: Number = value_in("rad", "angle of the joint where they pull at nothing", 0.0)

    def patch(self, machine: Machine) -> None:
        """Add the cables' spring at the output bearing, eq. (1)."""
        from flexarm import _core

        machine.drive_trains[self.at].bearing.append(
            _core.CableTorque(self.stiffness, self.rest_angle)
        )  # eq. (1)

    def probes(
        self, stated: Effect | None, free: Sequence[str], null: Values, priors: Priors
    ) -> Iterator[Self]:
        """Yield two rest angles: (1) is linear in k_c and k_c theta_r."""
        for angle in (0.0, 0.5):
            yield self.with_parameters({"stiffness": priors["stiffness"].typical, "rest_angle": angle})

    def sized(self, multiples: Sequence[float], probed: Probes) -> dict[str, float]:
        """Return stiffness and rest angle of a sum of the probes' torques."""
        first, second = probed.effects
        k = sum(multiples) * first.value_of("stiffness")
        pull = multiples[1] * (second.value_of("stiffness") * second.value_of("rest_angle"))
        return {"stiffness": k, "rest_angle": pull / k if k else 0.0}

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From a signal cable to a dress pack with hoses."""
        bundles = "engineering judgement: bundles and hoses bent at radii of 0.1 to 0.5 m"
        dressed = "engineering judgement: dressed near the middle of the range"
        return {
            "stiffness": Prior(0.3, 300.0, 10.0, "log", "N m/rad", bundles),
            "rest_angle": Prior(-pi / 2, pi / 2, 0.0, "linear", "rad", dressed),
        }
