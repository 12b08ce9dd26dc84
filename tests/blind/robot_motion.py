"""Motion of a robot of rods along its motors' angles, from rest in equilibrium."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from hub import STICK_WIDTH
from robot import Angle, Robot, Vector
from robot_chain import Built, build
from serial_chain import Chain, Floats, energies, places, scratch
from serial_motion import STAGES, WEIGHTS, Hubs, Run, Step, dahl, integrate, reducer_torques, unbalanced


@dataclass(frozen=True)
class Motion:
    """A chain at instants: q and v, motor angles and torques (output side), one column a joint."""

    built: Built
    time: Floats
    q: Floats
    v: Floats
    motor_angle: Floats
    motor_torque: Floats

    def place(self, link: str, fraction: float, offset: Vector = (0.0, 0.0, 0.0)) -> Floats:
        """x, y and z of a point fixed to a link's section at 0, half or all of its length, (m, 3) [m]."""
        dof, at = self.built.stations[link, fraction]
        return places(self.built.chain, self.q, dof, at + np.array(offset), scratch(self.q.shape[1]))

    def every(self, n: int) -> Motion:
        """The same at every n-th instant."""
        rows = {name: getattr(self, name)[::n] for name in ("time", "q", "v", "motor_angle", "motor_torque")}
        return replace(self, **rows)

    def energies(self) -> Floats:
        """Kinetic, elastic (without reducers) and gravity energy, (m, 3) [J]."""
        chain, s = self.built.chain, scratch(self.q.shape[1])
        return np.array([energies(chain, q, v, s) for q, v in zip(self.q, self.v, strict=True)])


def move(robot: Robot, angles: Mapping[str, Angle], end: float, h: float = 5e-3) -> Motion:
    """The motion from rest in equilibrium, at the ends of steps of h [s]; halved where the iteration fails.

    Accurate to 1e-7 m at a tip for smooth laws with steps of 5 ms, to 1e-6 m with friction; gaps want 2.5 ms.
    """
    for halving in range(4):
        moved = _moved(robot, angles, end, h / 2**halving)
        if moved is not None:
            return moved.every(2**halving)
    raise RuntimeError(f"Newton's iteration of the chain fails with steps of {h / 2**halving} s")


def _moved(robot: Robot, angles: Mapping[str, Angle], end: float, h: float) -> Motion | None:
    """The motion with one step, None if the iteration fails."""
    built = build(robot)
    chain, hubs = built.chain, built.hubs
    time = h * np.arange(round(end / h) + 1)
    staged = (time[:, None] - h) + h * STAGES  # stages of the step that ends at a time
    phi = np.stack([np.stack(angles[turn.name](staged), -1) for turn in robot.turns], 2)
    if robot.coupling:
        phi[..., -1, :] += robot.coupling * phi[..., 0, :]
    teeth = [turn.hub.teeth(*np.moveaxis(phi[:, :, j], -1, 0), staged) for j, turn in enumerate(robot.turns)]
    psi = np.ascontiguousarray(np.stack([np.stack(tooth[:3], -1) for tooth in teeth], 2))
    shaken = robot.base.vibration
    moment = shaken.amplitude * np.sin(2 * np.pi * shaken.frequency * staged + shaken.phase)
    run, s = _run(built, at_rest(built, psi[0, -1]), psi, moment, h), scratch(len(chain.axis))
    if run is None:
        return None
    reducers = np.empty((len(time), len(hubs.dof)))
    reducer_torques(chain, hubs, run, psi, h, s, reducers)
    slopes = np.stack([np.broadcast_to(tooth[3], staged.shape)[:, -1] for tooth in teeth], -1)
    torque = _motor_torque(robot, reducers, phi[:, -1], slopes)
    return Motion(built, time, run.q, run.v, phi[:, -1, :, 0], torque)


def _run(built: Built, q0: Floats, psi: Floats, moment: Floats, h: float) -> Run | None:
    """All steps from q0 at rest."""
    chain, hubs = built.chain, built.hubs
    n, joints, stages = len(chain.axis), len(hubs.dof), len(STAGES)
    run = Run(*(np.zeros((len(psi), n)) for _ in range(3)), np.zeros((len(psi), joints, 4)))
    angles, derivatives = ([np.zeros((stages, n)) for _ in range(count)] for count in (3, 4))
    step = Step(*angles, np.zeros((stages, joints, 4)), *derivatives, np.zeros(stages * len(chain.free)))
    run.q[0] = q0
    inverse = np.empty(2 * step.residual.shape, order="F")
    tables = (WEIGHTS, WEIGHTS @ WEIGHTS, STAGES)
    failed = integrate(chain, hubs, psi, moment, h, *tables, scratch(n), step, run, inverse)
    return run if failed < 0 else None


def at_rest(built: Built, psi: Floats) -> Floats:
    """Equilibrium without friction; a gap lies on its loaded flank."""
    chain, hubs = built.chain, built.hubs
    n = len(chain.axis)
    q = np.zeros(n)
    q[hubs.dof] = psi[:, 0]
    closed = hubs._replace(gap=np.zeros(len(hubs.dof)))
    _settle(chain, closed, q, psi)
    torque = closed.stiffness * (psi[:, 0] - q[hubs.dof])
    q[hubs.dof] -= np.sign(torque) * hubs.gap / 2
    _settle(chain, hubs, q, psi)
    return q


def _settle(chain: Chain, hubs: Hubs, q: Floats, psi: Floats) -> None:
    """Newton's iteration on the static balance, by differences."""
    n, zero, s = len(q), np.zeros(len(q)), scratch(len(q))
    z, still = np.zeros((len(hubs.dof), 4)), np.column_stack([psi[:, :1], np.zeros((len(psi), 2))])
    K, C, free = np.zeros(n), np.zeros(n), chain.free

    def residual(x: Floats) -> Floats:
        out = np.zeros(n)
        unbalanced(chain, hubs, x, zero, zero, z, still, 0.0, 0.0, s, out, K, C)
        return out[free]

    for _ in range(30):
        now = residual(q)
        step = 1e-7
        J = np.empty((len(free), len(free)))
        for column, k in enumerate(free):
            x = q.copy()
            x[k] += step
            J[:, column] = (residual(x) - now) / step
        change = np.linalg.solve(J, now)
        q[free] -= change
        if np.abs(change).max() < 1e-12:
            return
    raise RuntimeError(f"no equilibrium of the chain: {np.abs(now).max():.1e} N m are left")


def _motor_torque(robot: Robot, reducers: Floats, phi: Floats, slopes: Floats) -> Floats:
    """hub.py (5) at the ends of steps, (steps, joints)."""
    torque = reducers * slopes
    for j, turn in enumerate(robot.turns):
        hub = turn.hub
        torque[:, j] += (
            hub.gear_ratio**2 * hub.rotor_inertia * phi[:, j, 2] + hub.motor_viscous * phi[:, j, 1]
        )
        if hub.motor_coulomb:
            torque[:, j] += hub.motor_coulomb * _motor_friction(phi[:, j, 0])
    return torque


def _motor_friction(phi: Floats) -> Floats:
    """z of the motor's friction along its angle."""
    z = np.zeros(len(phi))
    for i, way in enumerate(np.diff(phi), 1):
        z[i] = dahl(z[i - 1], way, STICK_WIDTH)[0]
    return z
