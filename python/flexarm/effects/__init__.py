"""Effects that can be simulated, one a file; the file is named after the effect.

The shared vocabulary is `flexarm.arm.effect.KNOWN_EFFECTS`. A new effect is one new file here.
"""

from flexarm.arm.effect import KNOWN_EFFECTS, Effect, effect_class
from flexarm.effects.coulomb_friction import CoulombFriction
from flexarm.effects.joint_compliance import JointCompliance
from flexarm.effects.motor_friction import MotorFriction
from flexarm.effects.viscous_friction import ViscousFriction

__all__ = [
    "KNOWN_EFFECTS",
    "CoulombFriction",
    "Effect",
    "JointCompliance",
    "MotorFriction",
    "ViscousFriction",
    "effect_class",
]
