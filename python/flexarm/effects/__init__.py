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
    from flexarm.effects.backlash import Backlash as Backlash
    from flexarm.effects.base_compliance import BaseCompliance as BaseCompliance
    from flexarm.effects.base_tilt import BaseTilt as BaseTilt
    from flexarm.effects.cable_torque import CableTorque as CableTorque
    from flexarm.effects.clock_drift import ClockDrift as ClockDrift
    from flexarm.effects.coulomb_friction import CoulombFriction as CoulombFriction
    from flexarm.effects.dead_channel import DeadChannel as DeadChannel
    from flexarm.effects.drive_lag import DriveLag as DriveLag
    from flexarm.effects.encoder_eccentricity import EncoderEccentricity as EncoderEccentricity
    from flexarm.effects.encoder_harmonics import EncoderHarmonics as EncoderHarmonics
    from flexarm.effects.encoder_offset import EncoderOffset as EncoderOffset
    from flexarm.effects.encoder_quantisation import EncoderQuantisation as EncoderQuantisation
    from flexarm.effects.encoder_scale import EncoderScale as EncoderScale
    from flexarm.effects.end_cushion import EndCushion as EndCushion
    from flexarm.effects.external_vibration import ExternalVibration as ExternalVibration
    from flexarm.effects.frame_drift import FrameDrift as FrameDrift
    from flexarm.effects.frame_registration import FrameRegistration as FrameRegistration
    from flexarm.effects.frame_scale import FrameScale as FrameScale
    from flexarm.effects.gear_ratio import GearRatio as GearRatio
    from flexarm.effects.joint_compliance import JointCompliance as JointCompliance
    from flexarm.effects.joint_hysteresis import JointHysteresis as JointHysteresis
    from flexarm.effects.joint_radial_clearance import JointRadialClearance as JointRadialClearance
    from flexarm.effects.joint_radial_compliance import JointRadialCompliance as JointRadialCompliance
    from flexarm.effects.joint_stiffening import JointStiffening as JointStiffening
    from flexarm.effects.joint_tilt_compliance import JointTiltCompliance as JointTiltCompliance
    from flexarm.effects.link_bow import LinkBow as LinkBow
    from flexarm.effects.link_damping import LinkDamping as LinkDamping
    from flexarm.effects.link_length import LinkLength as LinkLength
    from flexarm.effects.link_mass import LinkMass as LinkMass
    from flexarm.effects.link_stiffness import LinkStiffness as LinkStiffness
    from flexarm.effects.lugre_friction import LugreFriction as LugreFriction
    from flexarm.effects.motor_friction import MotorFriction as MotorFriction
    from flexarm.effects.oil_column import OilColumn as OilColumn
    from flexarm.effects.outliers import Outliers as Outliers
    from flexarm.effects.payload_inertia import PayloadInertia as PayloadInertia
    from flexarm.effects.payload_mass import PayloadMass as PayloadMass
    from flexarm.effects.payload_offset import PayloadOffset as PayloadOffset
    from flexarm.effects.reflector_offset import ReflectorOffset as ReflectorOffset
    from flexarm.effects.saturation import Saturation as Saturation
    from flexarm.effects.sensor_offset import SensorOffset as SensorOffset
    from flexarm.effects.sign_error import SignError as SignError
    from flexarm.effects.tabulated_law import TabulatedLaw as TabulatedLaw
    from flexarm.effects.time_delay import TimeDelay as TimeDelay
    from flexarm.effects.transmission_error import TransmissionError as TransmissionError
    from flexarm.effects.unit_error import UnitError as UnitError
    from flexarm.effects.viscous_friction import ViscousFriction as ViscousFriction

_CLASSES = ["".join(word.capitalize() for word in name.split("_")) for name in KNOWN_EFFECTS]

__all__ = ["KNOWN_EFFECTS", "Effect", "effect_class", *_CLASSES]


def __getattr__(name: str) -> Any:
    file = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name).lstrip("_")
    if name[:1].isupper() and util.find_spec(f"{__name__}.{file}") is not None:
        return getattr(import_module(f"{__name__}.{file}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
