"""One flexible link on one revolute joint: an Euler-Bernoulli beam with a hub and a load.

The link turns about its hub at x = 0 in a vertical plane. The hub has a moment of inertia about the
joint, the tip x = L carries a load whose mass sits at the tip's section and whose rotary inertia
turns with it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from flexarm.errors import InvalidParameter
from flexarm.tables.ranges import out_of_range

_UNITS = {
    "length": "m",
    "bending_stiffness": "N m²",
    "mass_per_length": "kg/m",
    "tip_mass": "kg",
    "tip_inertia": "kg m²",
    "hub_inertia": "kg m²",
}
_POSITIVE = ("length", "bending_stiffness", "mass_per_length")


@dataclass(frozen=True)
class FlexibleLink:
    """Inextensible Euler-Bernoulli beam between a hub and a load."""

    length: float
    """Length L [m]."""
    bending_stiffness: float
    """EI [N m²]."""
    mass_per_length: float
    """ρA [kg/m]."""
    tip_mass: float = 0.0
    """Mass M_e of the load [kg]."""
    tip_inertia: float = 0.0
    """Moment of inertia J_e of the load about the tip, normal to the plane [kg m²]."""
    hub_inertia: float = 0.0
    """Moment of inertia J_h about the joint of what turns with the link's root [kg m²]."""

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            positive = item.name in _POSITIVE
            if not math.isfinite(value) or value < 0 or (positive and value == 0):
                need = "positive" if positive else "zero or positive"
                what = f"flexible link: {item.name} must be {need}, got {value} {_UNITS[item.name]}"
                raise InvalidParameter(what)
            if wrong := out_of_range(float(value), _UNITS[item.name].replace("²", "2"), size=True):
                raise InvalidParameter(f"flexible link: {item.name} {wrong}")

    @property
    def beam_mass(self) -> float:
        """Mass of the beam without its load, ρA L [kg]."""
        return self.mass_per_length * self.length

    @property
    def static_moment(self) -> float:
        """First moment of mass about the joint, S = ∫ x dm [kg m]."""
        return self.length * (self.beam_mass / 2 + self.tip_mass)

    @property
    def joint_inertia(self) -> float:
        """Moment of inertia of the straight arm about the joint, J_0 [kg m²]."""
        rod = self.length**2 * (self.beam_mass / 3 + self.tip_mass)
        return rod + self.tip_inertia + self.hub_inertia
