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
    from flexarm.effects.backlash import Backlash
    from flexarm.effects.base_compliance import BaseCompliance
    from flexarm.effects.base_tilt import BaseTilt
    from flexarm.effects.cable_torque import CableTorque
    from flexarm.effects.clock_drift import ClockDrift
    from flexarm.effects.coulomb_friction import CoulombFriction
    from flexarm.effects.dead_channel import DeadChannel
    from flexarm.effects.drive_lag import DriveLag
    from flexarm.effects.encoder_eccentricity import EncoderEccentricity
    from flexarm.effects.encoder_harmonics import EncoderHarmonics
    from flexarm.effects.encoder_offset import EncoderOffset
    from flexarm.effects.encoder_quantisation import EncoderQuantisation
    from flexarm.effects.encoder_scale import EncoderScale
    from flexarm.effects.end_cushion import EndCushion
    from flexarm.effects.external_vibration import ExternalVibration
    from flexarm.effects.frame_drift import FrameDrift
    from flexarm.effects.frame_registration import FrameRegistration
    from flexarm.effects.frame_scale import FrameScale
    from flexarm.effects.gear_ratio import GearRatio
    from flexarm.effects.joint_compliance import JointCompliance
    from flexarm.effects.joint_hysteresis import JointHysteresis
    from flexarm.effects.joint_radial_clearance import JointRadialClearance
    from flexarm.effects.joint_radial_compliance import JointRadialCompliance
    from flexarm.effects.joint_stiffening import JointStiffening
    from flexarm.effects.joint_tilt_compliance import JointTiltCompliance
    from flexarm.effects.link_bow import LinkBow
    from flexarm.effects.link_damping import LinkDamping
    from flexarm.effects.link_length import LinkLength
    from flexarm.effects.link_mass import LinkMass
    from flexarm.effects.link_stiffness import LinkStiffness
    from flexarm.effects.lugre_friction import LugreFriction
    from flexarm.effects.motor_friction import MotorFriction
    from flexarm.effects.oil_column import OilColumn
    from flexarm.effects.outliers import Outliers
    from flexarm.effects.payload_inertia import PayloadInertia
    from flexarm.effects.payload_mass import PayloadMass
    from flexarm.effects.payload_offset import PayloadOffset
    from flexarm.effects.reflector_offset import ReflectorOffset
    from flexarm.effects.saturation import Saturation
    from flexarm.effects.sensor_offset import SensorOffset
    from flexarm.effects.sign_error import SignError
    from flexarm.effects.tabulated_law import TabulatedLaw
    from flexarm.effects.time_delay import TimeDelay
    from flexarm.effects.transmission_error import TransmissionError
    from flexarm.effects.unit_error import UnitError
    from flexarm.effects.viscous_friction import ViscousFriction

__all__ = [
    "KNOWN_EFFECTS",
    "Backlash",
    "BaseCompliance",
    "BaseTilt",
    "CableTorque",
    "ClockDrift",
    "CoulombFriction",
    "DeadChannel",
    "DriveLag",
    "Effect",
    "EncoderEccentricity",
    "EncoderHarmonics",
    "EncoderOffset",
    "EncoderQuantisation",
    "EncoderScale",
    "EndCushion",
    "ExternalVibration",
    "FrameDrift",
    "FrameRegistration",
    "FrameScale",
    "GearRatio",
    "JointCompliance",
    "JointHysteresis",
    "JointRadialClearance",
    "JointRadialCompliance",
    "JointStiffening",
    "JointTiltCompliance",
    "LinkBow",
    "LinkDamping",
    "LinkLength",
    "LinkMass",
    "LinkStiffness",
    "LugreFriction",
    "MotorFriction",
    "OilColumn",
    "Outliers",
    "PayloadInertia",
    "PayloadMass",
    "PayloadOffset",
    "ReflectorOffset",
    "Saturation",
    "SensorOffset",
    "SignError",
    "TabulatedLaw",
    "TimeDelay",
    "TransmissionError",
    "UnitError",
    "ViscousFriction",
    "effect_class",
]


def __getattr__(name: str) -> Any:
    file = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name).lstrip("_")
    if name[:1].isupper() and util.find_spec(f"{__name__}.{file}") is not None:
        return getattr(import_module(f"{__name__}.{file}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
