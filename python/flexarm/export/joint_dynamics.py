r"""Springs, friction and rotor of a joint, as programs of multibody dynamics state them.

On the output side, with \varphi the motor's angle over the ratio n and \theta the link's,

.. math:: J n^2 \ddot\varphi = T_m - T - T_m^f \operatorname{sgn}\dot\varphi - c_m \dot\varphi, \qquad
          T = k (\varphi - \theta) + c (\dot\varphi - \dot\theta)                                      (1)

while T_b^f and c_b act on \theta in the bearing. A rigid joint has \varphi = \theta, so that both frictions
add.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

from flexarm.arm.friction_effect import FrictionEffect

if TYPE_CHECKING:
    from flexarm.arm import Arm

_WRITTEN = {
    "joint_compliance": {"stiffness": "stiffness", "damping": "damping"},
    "viscous_friction": {"coefficient": "bearing_viscous"},
    "coulomb_friction": {"torque": "bearing_dry"},
    "motor_friction": {"viscous": "motor_viscous", "coulomb": "motor_dry"},
}
"""Effects that are exported: their parameters, and the fields below."""


@dataclass(frozen=True)
class JointDynamics:
    """The numbers of (1), output side [N m/rad, N m s/rad, N m, kg m2; N/m, ... of a prismatic joint]."""

    joint: str
    stiffness: float = inf
    damping: float = 0.0
    """k and c of the reducer; an infinite k is a rigid joint."""
    bearing_viscous: float = 0.0
    bearing_dry: float = 0.0
    motor_viscous: float = 0.0
    motor_dry: float = 0.0
    """c_b, T_b^f, c_m, T_m^f."""
    rotor_inertia: float = 0.0
    gear_ratio: float = 1.0
    """J [kg m2], motor side, and n."""
    states: frozenset[str] = frozenset()
    """Which friction the model has, "viscous" and "dry"; a file's own stays where it has none."""
    left_out: tuple[str, ...] = ()
    """Names of the joint's other effects, for which the formats have no word."""

    @property
    def armature(self) -> float:
        """J n^2, the rotor's inertia as the output feels it [kg m2]."""
        return self.rotor_inertia * self.gear_ratio**2

    @property
    def elastic(self) -> bool:
        """True if the reducer gives."""
        return self.stiffness < inf

    @property
    def viscous(self) -> float:
        """c_b + c_m, of a joint whose reducer is rigid."""
        return self.bearing_viscous + self.motor_viscous

    @property
    def dry(self) -> float:
        """T_b^f + T_m^f, of a joint whose reducer is rigid."""
        return self.bearing_dry + self.motor_dry


def joint_dynamics(arm: Arm) -> Iterator[JointDynamics]:
    """Yield the dynamics of every moving joint."""
    for joint in arm.joints:
        if not joint.moves:
            continue
        values: dict[str, float] = {}
        left_out = []
        for effect in arm.effects_at(joint.name):
            if effect.name not in _WRITTEN:
                left_out.append(effect.name)
                continue
            if isinstance(effect, FrictionEffect) and effect.is_shaped:
                left_out.append(f"the shape of {effect.name}")
            values |= {field: effect.value_of(key) for key, field in _WRITTEN[effect.name].items()}
        yield JointDynamics(
            joint.name,
            rotor_inertia=joint.rotor_inertia,
            gear_ratio=joint.gear_ratio,
            states=frozenset(kind for kind in ("viscous", "dry") if any(kind in field for field in values)),
            left_out=tuple(left_out),
            **values,
        )


def not_written(arm: Arm) -> list[str]:
    """Return a note on each closure and gear, for which the formats have no joint dynamics."""
    notes = [f"closure {closure.name} is not written" for closure in arm.closures]
    return notes + [f"gear {gear.name} is not written" for gear in arm.gears]


def left_out(dynamics: JointDynamics) -> list[str]:
    """Return a note on each effect that is not written."""
    return [
        f"joint {dynamics.joint}: {name} is not written, the format has no word for it"
        for name in dynamics.left_out
    ]


def own_friction(dynamics: JointDynamics, attributes: Mapping[str, str], viscous: str, dry: str) -> list[str]:
    """Return a note on friction in the attributes of a file that stays, as the model has none."""
    kept = {"viscous": viscous, "dry": dry}
    return [
        f"joint {dynamics.joint}: {key} {attributes[key]} of the file stays, as the model has no "
        f"{kind} friction"
        for kind, key in kept.items()
        if kind not in dynamics.states and attributes.get(key, "").strip("0.")
    ]
