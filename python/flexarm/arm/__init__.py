"""The model file (TOML) as frozen, checked objects."""

from flexarm.arm.arm import Arm
from flexarm.arm.attachment import Payload, Point
from flexarm.arm.closure import Closure
from flexarm.arm.controller import Cascade, Controller, StateFeedback
from flexarm.arm.effect import Effect, effect_class
from flexarm.arm.inertia import inertia_matrix
from flexarm.arm.joint import Gear, Joint, Origin
from flexarm.arm.link import Beam, Link, RigidLink, SuperElementLink
from flexarm.arm.motor import Motor
from flexarm.arm.prior import Prior
from flexarm.arm.section import General, Rectangle, Round, Section, Tube
from flexarm.arm.sensor import Measurement, Sensor
from flexarm.arm.vocabulary import KNOWN_EFFECTS
from flexarm.material import Material

__all__ = [
    "KNOWN_EFFECTS",
    "Arm",
    "Beam",
    "Cascade",
    "Closure",
    "Controller",
    "Effect",
    "Gear",
    "General",
    "Joint",
    "Link",
    "Material",
    "Measurement",
    "Motor",
    "Origin",
    "Payload",
    "Point",
    "Prior",
    "Rectangle",
    "RigidLink",
    "Round",
    "Section",
    "Sensor",
    "StateFeedback",
    "SuperElementLink",
    "Tube",
    "effect_class",
    "inertia_matrix",
]
