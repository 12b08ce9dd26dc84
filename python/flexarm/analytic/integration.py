"""Motion of equations (1) and (2) under a torque or a prescribed motor angle."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from flexarm.analytic.drives import MotorAngle
from flexarm.analytic.exponential import Propagator, march
from flexarm.analytic.jointed_arm import Drive, JointedArm
from flexarm.analytic.linear_modal import LinearModal
from flexarm.analytic.motion import ArmMotion
from flexarm.analytic.nonlinear_modal import Array
from flexarm.analytic.statics import Equation, equilibrium, rigid_rotation
from flexarm.errors import InvalidParameter, NotConverged

Method = Literal["exponential", "DOP853", "Radau", "BDF", "LSODA"]


def simulate(
    arm: Equation,
    drive: Drive,
    time: ArrayLike,
    *,
    initial_angle: float = 0.0,
    initial_rate: float = 0.0,
    initial_state: tuple[Array, Array] | None = None,
    method: Method = "exponential",
    step: float = 2e-3,
    rtol: float = 1e-9,
    atol: float = 1e-11,
) -> ArmMotion:
    """Integrate equation (1) or (2).

    Parameters
    ----------
    arm : NonlinearModal or LinearModal
        Equation (1) or (2).
    drive : MotorAngle or JointTorque
        What moves the joint. A motor angle starts from rest, in equilibrium under its first value.
    time : array_like, shape (n,)
        Rising instants of the result [s]; the motion starts at the first.
    initial_angle, initial_rate : float
        With a torque drive: the hub angle [rad] at which the arm is held in equilibrium before it is
        let go, and the rate [rad/s] with which it then turns, straight.
    initial_state : pair of ndarray, shape (n_modes,), optional
        q and its rate at the start instead.
    method : str
        exponential: equation (1) at order four in `step`, equation (2) exactly where the loads are
        cubics in each step. DOP853 (follows every vibration), Radau, BDF, LSODA: SciPy's `solve_ivp`;
        friction needs one of these, and so does a stiff spring under a strongly bent arm, because c of
        `jointed_arm` times the spring is not in the linear part.
    step : float
        Longest step of the exponential method [s]; those between two instants of `time` are equal.
    rtol, atol : float
        Tolerances of `solve_ivp`; q is some kg^½ m large.

    Raises
    ------
    NotConverged
        If there is no equilibrium to start from or the integration stops.
    """
    instants = np.asarray(time, dtype=float)
    if instants.ndim != 1 or len(instants) < 2 or not np.all(np.diff(instants) > 0):
        raise InvalidParameter("times must be at least two rising numbers [s]")
    system = JointedArm.of(arm, drive)
    if initial_state is None:
        initial_state = _start(arm, drive, instants[0], initial_angle, initial_rate)
    start = system.reduce(instants[0], *initial_state)
    if method == "exponential":
        states = _exponential(system, start, instants, step)
    else:
        states = _solve_ivp(system, start, instants, method, rtol, atol)
    return system.motion(instants, states)


def _exponential(system: JointedArm, start: Array, time: Array, step: float) -> Array:
    """Return the states z by (E2) for equation (1), by (E3) for equation (2)."""
    if system.drive.friction is not None:
        raise InvalidParameter("friction is stiff and not linear: choose method Radau, not exponential")
    if not (step > 0 and math.isfinite(step)):
        raise InvalidParameter(f"step must be positive, got {step} s")
    A = system.linear_part()

    def remainder(t: float, z: Array) -> Array:
        return system.rhs(t, z) - A @ z

    def advance(by: Propagator, t: float, z: Array) -> Array:
        if isinstance(system.arm, LinearModal):
            return by.forced(lambda s: system.rhs(s, np.zeros_like(z)), t, z)
        return by.runge_kutta(remainder, t, z)

    return march(A, advance, start, time, step)


def _solve_ivp(
    system: JointedArm, start: Array, time: Array, method: Method, rtol: float, atol: float
) -> Array:
    from scipy.integrate import solve_ivp

    solution = solve_ivp(
        system.rhs, (time[0], time[-1]), start, method=method, t_eval=time, rtol=rtol, atol=atol
    )
    if not solution.success:
        reached = float(solution.t[-1]) if len(solution.t) else float(time[0])
        raise NotConverged(f"t = {reached:.4g} s: {solution.message}", time=reached)
    states: Array = solution.y.T
    return states


def _start(arm: Equation, drive: Drive, t: float, angle: float, rate: float) -> tuple[Array, Array]:
    """Return the equilibrium at rest, or held at `angle` and then released straight with `rate`."""
    if isinstance(drive, MotorAngle):
        phi, phi_rate = float(drive.angle(t)), float(drive.angle(t, 1))
        turning = phi_rate if drive.rigid else 0.0  # a hub that follows φ has φ's rate
        return equilibrium(arm, phi, drive.stiffness), rigid_rotation(arm) * turning
    return equilibrium(arm, angle, math.inf), rigid_rotation(arm) * rate
