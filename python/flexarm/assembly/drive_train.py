"""What stands between a motor and its link, as effects find and patch it."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, isinf

from flexarm import _core

Law = _core.LinearSpring | _core.CubicSpring | _core.ViscousFriction | _core.DahlFriction


@dataclass
class DriveTrain:
    """Motor, reducer and output bearing of one joint; all laws output-referred.

    Attributes
    ----------
    gear_ratio, rotor_inertia : float
        Of the model: motor angle over output angle [-], inertia at the motor's shaft [kg m2].
    stiffness, damping : float
        Of the reducer [N m/rad], [N m s/rad]; an infinite stiffness makes it rigid.
    motor, bearing : list
        Laws on the motor's angle, and at the output bearing on the link's.
    """

    gear_ratio: float = 1.0
    rotor_inertia: float = 0.0
    stiffness: float = inf
    damping: float = 0.0
    motor: list[Law] = field(default_factory=list)
    bearing: list[Law] = field(default_factory=list)

    def core(self) -> _core.DriveTrain:
        """The same as the core takes it: a rigid train has no stage between motor and link."""
        stages = [] if isinf(self.stiffness) else [[_core.LinearSpring(self.stiffness, self.damping)]]
        return _core.DriveTrain(
            gear_ratio=self.gear_ratio,
            rotor_inertia=self.rotor_inertia,
            stages=stages,
            motor=self.motor,
            bearing=self.bearing,
        )
