"""Drives of the joint: a torque, or a motor angle through a spring or rigidly; and friction.

Prescribed angles and torques are functions of time `f(t, nu)` that return their nu-th derivative,
as SciPy's `PPoly`, `CubicSpline` and `BSpline` do. Angles are in rad, torques in N m, both at the
joint's output side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

from flexarm.errors import InvalidParameter


class TimeFunction(Protocol):
    """A function of time with derivatives, such as `scipy.interpolate.CubicSpline`."""

    def __call__(self, t: Any, nu: int = 0, /) -> Any:
        """Return the nu-th derivative at `t` [s]."""
        ...


@dataclass(frozen=True)
class CoulombFriction:
    """Friction of constant size against the joint's motion, the largest static torque of the paper.

    τ_fric = -T tanh(θ_dot/v), θ_dot being the hub's rate: the sign function, smoothed over v.
    """

    torque: float
    """T [N m]."""
    rate: float = 1e-3
    """v [rad/s]; below it the joint creeps instead of sticking."""

    def __post_init__(self) -> None:
        if not (self.torque >= 0 and math.isfinite(self.torque)):
            raise InvalidParameter(f"friction torque must be zero or positive, got {self.torque} N m")
        if not self.rate > 0:
            raise InvalidParameter(f"friction's smoothing rate must be positive, got {self.rate} rad/s")

    def __call__(self, hub_rate: float) -> float:
        """Return τ_fric [N m]."""
        return -self.torque * math.tanh(hub_rate / self.rate)


@dataclass(frozen=True)
class MotorAngle:
    """A prescribed motor angle φ, such as an encoder's, output-referred.

    The joint's torque is τ = k (φ - θ) + c (φ_dot - θ_dot); k = inf makes the hub follow φ.
    """

    angle: TimeFunction
    """φ(t, nu) [rad], nu = 0 to 2."""
    stiffness: float = math.inf
    damping: float = 0.0
    """k [N m/rad] and c [N m s/rad] between motor and hub."""
    friction: CoulombFriction | None = None
    """At the joint's bearing; without effect where the hub follows φ."""

    def __post_init__(self) -> None:
        if not self.stiffness > 0:
            what = f"joint stiffness must be positive (inf: rigid), got {self.stiffness} N m/rad"
            raise InvalidParameter(what)
        if not (self.damping >= 0 and math.isfinite(self.damping)):
            raise InvalidParameter(f"joint damping must be zero or positive, got {self.damping} N m s/rad")

    @property
    def rigid(self) -> bool:
        """True if the hub follows φ."""
        return math.isinf(self.stiffness)


@dataclass(frozen=True)
class JointTorque:
    """A prescribed torque at the hub."""

    torque: TimeFunction | float = 0.0
    """τ(t) [N m]."""
    friction: CoulombFriction | None = None

    def __call__(self, t: float) -> float:
        """Return τ at `t` [N m]."""
        return float(self.torque(t)) if callable(self.torque) else float(self.torque)
