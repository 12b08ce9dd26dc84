"""Motion of a chain of rods from rest, along a motor angle given as a function with two derivatives.

The unknowns of the differential equations are the rods' angles and rates, the states z of Dahl's laws whose
torque is not zero, and the angle beta of a compliant base. A rigid hinge on a rigid base prescribes rod 0; a
rigid hinge on a compliant one has beta = alpha_0 - tilt - psi. The base has no mass:

    k_b beta + c_b beta' = M(t) - T                                                                        (1)

with T the torque on the link. A compliant hinge makes T linear in beta', so that (1) gives it. The start is
static, without friction, hysteresis and vibration.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from chain import Base, Floats, Link
from hub import STICK_WIDTH, Hub, dahl
from scipy.integrate import solve_ivp
from scipy.optimize import root

Drive = Callable[[float], tuple[float, float, float]]
"""phi, phi' and phi'' of the motor over the ratio, at a time [rad, s]."""


@dataclass(frozen=True)
class Arm:
    """A link on a hinge on a base."""

    link: Link
    hub: Hub = field(default_factory=Hub)
    base: Base = field(default_factory=Base)

    def __post_init__(self) -> None:
        if self.soft_base and not self.hub.rigid and self.base.damping + self.hub.damping <= 0:
            raise ValueError("a compliant base under a compliant hinge needs damping in one of them")

    @property
    def soft_base(self) -> bool:
        """Whether the base turns."""
        return bool(np.isfinite(self.base.stiffness))

    @cached_property
    def n(self) -> int:
        """Rods."""
        return len(self.link.rods)

    @cached_property
    def free(self) -> slice:
        """Rods that are not prescribed."""
        return slice(1 if self.hub.rigid and not self.soft_base else 0, self.n)

    @cached_property
    def inner(self) -> tuple[str, ...]:
        """Further unknowns: states of hysteresis, bearing and motor, angle of the base."""
        wanted = {
            "hysteresis": self.hub.hysteresis > 0,
            "bearing": self.hub.coulomb > 0,
            "motor": self.hub.motor_coulomb > 0,
            "base": self.soft_base and not self.hub.rigid,
        }
        return tuple(name for name, there in wanted.items() if there)


@dataclass(frozen=True)
class Instant:
    """State at one time, columns of variations: angles, rates, accelerations, torques and inner rates."""

    alpha: Floats
    rate: Floats
    acceleration: Floats
    reducer_torque: Floats
    inner_rates: dict[str, Floats]


def instant(arm: Arm, drive: Drive, t: float, y: Floats) -> Instant:
    """Everything at a state y, shape (unknowns, columns)."""
    n_free = arm.free.stop - arm.free.start
    motor = drive(t)
    teeth = arm.hub.teeth(*map(np.asarray, motor))[:3]
    alpha, rate = np.empty((2, arm.n, y.shape[1]))
    alpha[0], rate[0] = teeth[0] + arm.base.tilt, teeth[1]
    alpha[arm.free], rate[arm.free] = y[:n_free], y[n_free : 2 * n_free]
    inner = dict(zip(arm.inner, y[2 * n_free :], strict=True))
    hinge = _soft_hinge if not arm.hub.rigid else _on_soft_base if arm.soft_base else _prescribed
    acceleration, reducer, theta_rate, beta_rate = hinge(arm, t, alpha, rate, teeth, inner)
    rates = {"base": beta_rate}
    if "hysteresis" in inner:
        rates["hysteresis"] = dahl(inner["hysteresis"], teeth[1] - theta_rate, arm.hub.hysteresis_width)
    if "bearing" in inner:
        rates["bearing"] = dahl(inner["bearing"], theta_rate, STICK_WIDTH)
    if "motor" in inner:
        rates["motor"] = dahl(inner["motor"], np.asarray(motor[1]), STICK_WIDTH)
    return Instant(alpha, rate, acceleration, reducer, rates)


Inner = dict[str, Floats]
Teeth = tuple[Floats, Floats, Floats]
Hinged = tuple[Floats, Floats, Floats, Floats]
"""Accelerations of the rods, torque of the reducer, theta' and beta'."""


def _soft_hinge(arm: Arm, t: float, alpha: Floats, rate: Floats, teeth: Teeth, inner: Inner) -> Hinged:
    """A reducer with a spring; the base gives way or stands."""
    hub, base, zero = arm.hub, arm.base, np.zeros(alpha.shape[1])
    beta = inner.get("base", zero)
    theta = alpha[0] - base.tilt - beta
    d = teeth[0] - theta
    c = hub.damper(d)
    still = hub.spring(d) + c * (teeth[1] - rate[0]) + hub.hysteresis * inner.get("hysteresis", zero)
    held = still - hub.bearing(theta, inner.get("bearing", zero)) - hub.viscous * rate[0]
    beta_rate = zero  # still and held are T_r and T at beta' = 0
    if arm.soft_base:
        moment = base.vibration(t) - held - base.stiffness * beta
        beta_rate = moment / (base.damping + c + hub.viscous)  # eq. (1)
    torque = held + (c + hub.viscous) * beta_rate
    M, Q = arm.link.equations(t, alpha, rate)
    return solved(M, Q, torque), still + c * beta_rate, rate[0] - beta_rate, beta_rate


def _on_soft_base(arm: Arm, t: float, alpha: Floats, rate: Floats, teeth: Teeth, inner: Inner) -> Hinged:
    """A rigid reducer on a base that gives way: what the base bears is the torque on the link."""
    base, zero = arm.base, np.zeros(alpha.shape[1])
    beta, beta_rate = alpha[0] - base.tilt - teeth[0], rate[0] - teeth[1]
    torque = base.vibration(t) - base.stiffness * beta - base.damping * beta_rate  # eq. (1)
    M, Q = arm.link.equations(t, alpha, rate)
    return solved(M, Q, torque), _behind(arm, torque, teeth, inner), teeth[1] + zero, beta_rate


def _prescribed(arm: Arm, t: float, alpha: Floats, rate: Floats, teeth: Teeth, inner: Inner) -> Hinged:
    """Rod 0 follows the teeth; its row of the equations of motion is the torque that this takes."""
    M, Q = arm.link.equations(t, alpha, rate)
    acceleration = np.empty_like(alpha)
    acceleration[0] = teeth[2]
    known = Q[:, 1:] - M[:, 1:, 0] * teeth[2]
    acceleration[1:] = np.linalg.solve(M[:, 1:, 1:], known[..., None])[..., 0].T
    torque = np.einsum("kj,jk->k", M[:, 0], acceleration) - Q[:, 0]
    zero = np.zeros_like(torque)
    return acceleration, _behind(arm, torque, teeth, inner), teeth[1] + zero, zero


def _behind(arm: Arm, torque: Floats, teeth: Teeth, inner: Inner) -> Floats:
    """Torque of a rigid reducer from that on the link: what the bearing takes comes on top."""
    z_b = inner.get("bearing", np.zeros_like(torque))
    return torque + arm.hub.bearing(teeth[0] + 0 * torque, z_b) + arm.hub.viscous * teeth[1]


def solved(M: Floats, Q: Floats, torque: Floats) -> Floats:
    """Accelerations of all rods under a torque on rod 0, shape (n, columns)."""
    Q = Q.copy()
    Q[:, 0] += torque
    return np.linalg.solve(M, Q[..., None])[..., 0].T


def slope(arm: Arm, drive: Drive, t: float, y: Floats) -> Floats:
    """y' for one state or for columns of them."""
    now = instant(arm, drive, t, y.reshape(len(y), -1))
    inner = [np.broadcast_to(now.inner_rates[name], now.alpha.shape[1:]) for name in arm.inner]
    parts = [now.rate[arm.free], now.acceleration[arm.free], *(row[None] for row in inner)]
    return np.concatenate(parts).reshape(y.shape)


def at_rest(arm: Arm, phi: float) -> Floats:
    """State y of the equilibrium at a motor angle; friction holds nothing, a gap lies on its loaded flank."""
    quiet = Arm(arm.link, arm.hub, Base(arm.base.stiffness, arm.base.damping, arm.base.tilt))
    n_free = arm.free.stop - arm.free.start
    n_y = 2 * n_free + len(arm.inner)
    varied = [*range(n_free)] + ([n_y - 1] if "base" in arm.inner else [])

    def state(x: Floats) -> Floats:
        y = np.zeros(n_y)
        y[varied] = x
        return y

    def unrest(x: Floats) -> Floats:
        now = instant(quiet, lambda _: (phi, 0.0, 0.0), 0.0, state(x)[:, None])
        M = quiet.link.equations(0.0, now.alpha, now.rate)[0]
        forces = np.einsum("kij,jk->i", M, now.acceleration)[arm.free]
        base = now.inner_rates["base"] * (arm.base.damping + arm.hub.damping)
        return np.append(forces, base) if "base" in arm.inner else forces

    psi = float(arm.hub.teeth(*map(np.asarray, (phi, 0.0, 0.0)))[0])
    lean = np.copysign(arm.hub.gap / 2, np.sin(psi + arm.base.tilt))  # upright it falls to +x
    start = np.full(len(varied), psi + arm.base.tilt + lean)
    if "base" in arm.inner:
        start[-1] = 0.0
    found = root(unrest, start, tol=1e-13)
    worst = np.abs(unrest(found.x)).max()
    if worst > 1e-5:
        raise RuntimeError(f"no equilibrium at phi = {phi} rad: {worst:.1e} N m are left")
    return state(found.x)


@dataclass(frozen=True)
class Motion:
    """States at instants: time (m,), alpha and rate (m, n), motor angle and torque (m,)."""

    arm: Arm
    time: Floats
    alpha: Floats
    rate: Floats
    motor_angle: Floats
    motor_torque: Floats
    inner: dict[str, Floats]

    def place(self, fraction: float, offset: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """x and z of a point of the link, shape (m, 2) [m]."""
        return self.arm.link.place(self.alpha.T, fraction, offset)


def move(arm: Arm, drive: Drive, time: Floats, rtol: float = 1e-6, start: Floats | None = None) -> Motion:
    """The motion at the given instants; it begins at the first, in equilibrium unless `start` says otherwise.

    Absolute tolerances are 1e-2 of the relative one in angles (3e-8 m at a tip 3 m away), and as they are in
    rates and states of friction.
    """
    n_free = arm.free.stop - arm.free.start
    y0 = at_rest(arm, drive(float(time[0]))[0]) if start is None else start
    atol = np.full(len(y0), rtol)
    atol[:n_free] = 1e-2 * rtol
    solution = solve_ivp(
        lambda t, y: slope(arm, drive, t, y),
        (time[0], time[-1]),
        y0,
        method="Radau",
        t_eval=time,
        rtol=rtol,
        atol=atol,
        vectorized=True,
    )
    if not solution.success:
        raise RuntimeError(solution.message)
    return _motion(arm, drive, np.asarray(time), solution.y)


def _motion(arm: Arm, drive: Drive, time: Floats, y: Floats) -> Motion:
    hub = arm.hub
    phi = np.array([drive(t) for t in time])
    states = [instant(arm, drive, t, column[:, None]) for t, column in zip(time, y.T, strict=True)]
    slopes = np.array([hub.teeth(*row)[3] for row in phi])
    inner = dict(zip(arm.inner, y[2 * (arm.free.stop - arm.free.start) :], strict=True))
    torque = slopes * np.array([now.reducer_torque[0] for now in states])
    torque += hub.gear_ratio**2 * hub.rotor_inertia * phi[:, 2] + hub.motor_viscous * phi[:, 1]
    torque += hub.motor_coulomb * inner.get("motor", 0.0)
    return Motion(
        arm,
        time,
        np.array([now.alpha[:, 0] for now in states]),
        np.array([now.rate[:, 0] for now in states]),
        phi[:, 0],
        torque,
        inner,
    )
