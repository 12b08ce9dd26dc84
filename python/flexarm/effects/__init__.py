"""Effects that can be simulated, one a file; the file is named after the effect.

The shared vocabulary is `flexarm.arm.vocabulary.KNOWN_EFFECTS`. A new effect is one new file here; its class
is then found by its name, `joint_compliance` in files and `JointCompliance` in Python, and imported when
first used.
"""

from importlib import import_module, util
from typing import TYPE_CHECKING, Any

from flexarm.arm.effect import Effect, effect_class
from flexarm.arm.vocabulary import KNOWN_EFFECTS

if TYPE_CHECKING:
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


def __getattr__(name: str) -> Any:
    file = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name).lstrip("_")
    if name[:1].isupper() and util.find_spec(f"{__name__}.{file}") is not None:
        return getattr(import_module(f"{__name__}.{file}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
