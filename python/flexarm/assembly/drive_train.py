"""The drive train between a motor and its link, as effects find and patch it.

motor phi -> transmission psi(phi) -> reducer on psi - theta -> link theta; docs/theory.md, "Joints and drive
trains".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, isinf
from typing import TYPE_CHECKING, Any, Literal

from flexarm import _core

if TYPE_CHECKING:
    Law = (
        _core.CableTorque
        | _core.ViscousFriction
        | _core.DahlFriction
        | _core.LugreFriction
        | _core.TabulatedFriction
        | _core.TabulatedTorque
        | _core.EndCushion
    )


@dataclass
class Transmission:
    """Map of the motor's angle to psi = phi/scale + amplitude sin(multiple n phi + phase) - w(phi)."""

    scale: float = 1.0
    """True over nominal gear ratio [-]."""
    amplitude: float = 0.0
    multiple: float = 0.0
    phase: float = 0.0
    """Of the transmission error: at the output [rad], periods per motor turn, [rad]."""
    windup: _core.MonotoneCubic | None = None
    """w [rad], a table of phi [rad]."""

    def core(self) -> _core.Transmission:
        """Return the transmission as the core takes it."""
        table: dict[str, Any] = {} if self.windup is None else {"windup": self.windup}
        return _core.Transmission(
            scale=self.scale, amplitude=self.amplitude, multiple=self.multiple, phase=self.phase, **table
        )


@dataclass
class DriveTrain:
    """Motor, reducer and output bearing of one joint; all laws output-referred."""

    gear_ratio: float = 1.0
    rotor_inertia: float = 0.0
    """Of the model: motor angle over output angle [-], inertia at the motor's shaft [kg m2]."""
    transmission: Transmission | None = None
    """None: exact teeth."""
    stiffness: float = inf
    damping: float = 0.0
    cubic_stiffness: float = 0.0
    gap: float = 0.0
    """Of the reducer [N m/rad], [N m s/rad], [N m/rad3], [rad]; an infinite stiffness makes it rigid."""
    hysteresis: list[tuple[float, float]] = field(default_factory=list)
    """Beside the reducer's spring, on its deflection [N m], [rad]."""
    windup: tuple[Literal["angle", "rate", "torque"], _core.ChangingTable] | None = None
    """By how much more than its torque makes of it the reducer winds up: a table of the link's angle, of its
    rate, or of the spring's torque [rad]."""
    oil: _core.OilColumn | None = None
    """Between the valve, whose stroke the motor's angle is, and the reducer."""
    motor: list[Law] = field(default_factory=list)
    bearing: list[Law] = field(default_factory=list)
    """Laws on the motor's angle, and at the output bearing on the link's."""

    def teeth(self) -> Transmission:
        """Return the transmission, exact until it is patched."""
        if self.transmission is None:
            self.transmission = Transmission()
        return self.transmission

    def core(self) -> _core.DriveTrain:
        """Return the train as the core takes it: a rigid one has no stage between motor and link."""
        stages: list[list[Any]] = [] if self.oil is None else [[self.oil]]
        return _core.DriveTrain(
            gear_ratio=self.gear_ratio,
            rotor_inertia=self.rotor_inertia,
            transmission=None if self.transmission is None else self.transmission.core(),
            stages=stages if isinf(self.stiffness) else [*stages, self._reducer()],
            motor=self.motor,
            bearing=self.bearing,
        )

    def _reducer(self) -> list[_core.ReducerSpring | _core.WoundSpring | _core.DahlFriction]:
        spring = _core.ReducerSpring(
            self.stiffness, self.damping, cubic_stiffness=self.cubic_stiffness, gap=self.gap
        )
        hysteresis = [_core.DahlFriction(torque, width) for torque, width in self.hysteresis]
        if self.windup is None:
            return [spring, *hysteresis]
        of, table = self.windup
        return [_core.WoundSpring(spring, _core.Of[of], table), *hysteresis]
