"""The shared vocabulary of effects: every name, and the kind of place it acts at.

The order of `KNOWN_EFFECTS` is also the order in which effects of the mechanics are applied to the machine,
whatever their order in a file: drive trains, payloads, links, the base, points. So a link that is longer than
nominal carries its points along before a reflector sits beside its point. Effects at signals act on a reading
in this order too, as in a sensor: the transducer (scale, eccentricity, harmonics, offsets), its electronics
(range, steps) and what is made of the numbers (sign, unit, a broken wire, outliers); see
`flexarm.measurement.effects_of`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm

ANYWHERE = "joint, link, payload or base"
"""Kind of place of an effect that acts at several kinds."""
BASE = "base"
"""Name of the base as a place."""
_JOINT = """joint_compliance joint_stiffening joint_hysteresis backlash coulomb_friction viscous_friction
lugre_friction motor_friction transmission_error gear_ratio cable_torque joint_radial_compliance
joint_radial_clearance joint_tilt_compliance drive_lag oil_column end_cushion"""
_TABLE = "tabulated_law"
_PAYLOAD = "payload_mass payload_offset payload_inertia"
_LINK = "link_length link_stiffness link_mass link_damping link_bow"
_BASE = "base_tilt base_compliance external_vibration"
_SIGNAL = """encoder_scale encoder_eccentricity encoder_harmonics encoder_offset sensor_offset saturation
encoder_quantisation sign_error unit_error dead_channel outliers"""
_CLOCK = "time_delay clock_drift"
_FRAME = "frame_registration frame_drift frame_scale"

_BY_PLACE = {
    "joint": _JOINT,
    ANYWHERE: _TABLE,
    "payload": _PAYLOAD,
    "link": _LINK,
    "base": _BASE,
    "point": "reflector_offset",
    "signal": _SIGNAL,
    "signal or clock": _CLOCK,
    "frame": _FRAME,
}

KNOWN_EFFECTS: dict[str, str] = {name: place for place, names in _BY_PLACE.items() for name in names.split()}
"""Every name of the shared vocabulary, and the kind of place it acts at."""

_ORDER = {name: i for i, name in enumerate(KNOWN_EFFECTS)}


def order_of(name: str) -> int:
    """When an effect is applied, counted from 0."""
    return _ORDER[name]


def places(arm: Arm, kind: str) -> list[str] | None:
    """Names of the places of a kind that an arm has; None for kinds that only a record has."""
    if kind == ANYWHERE:
        each = (places(arm, one) or [] for one in ("joint", "link", "payload", "base"))
        return list(dict.fromkeys(name for names in each for name in names))
    if kind == "base":
        return ["base"]
    if kind == "joint":
        return [joint.name for joint in arm.joints if joint.moves]
    entries: dict[str, Iterable[str]] = {
        "payload": (load.name for load in arm.payloads),
        "link": (link.name for link in arm.links),
        "point": (point.name for point in arm.points),
    }
    return list(entries[kind]) if kind in entries else None
