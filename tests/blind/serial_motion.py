"""Motion of a serial chain (serial_chain.py) from rest, with springs and the laws of hub.py in its joints.

A joint with a reducer bears (2) and (3) of hub.py, any other k x (1 + s |x|) + c x', x = q - rest(t).
Steps are Radau's of three stages, order five [HairerWanner1996, IV.5], with the accelerations as unknowns:

    q_s = q + c_s h q' + h^2 (A^2)_st a_t,   q'_s = q' + h A_st a_t,   residual(q_s, q'_s, a_s) = 0      (1)

so that joints without a mass cost nothing, and Newton's iteration uses delta_st M + h A_st C + h^2 (A^2)_st K
of springs and laws alone. Dahl's laws are solved along the way from stage to stage; of a turning point in
between less than 1e-6 rad is missed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from hub import CHANGES, FADING, LOOSE_DAMPING, LOOSE_STIFFNESS, STICK_WIDTH
from numba import njit
from numpy.typing import NDArray
from serial_chain import Floats, forces_inward, mass_matrix, move_outward

S6 = np.sqrt(6.0)
STAGES = np.array([(4 - S6) / 10, (4 + S6) / 10, 1.0])
"""Times of Radau's stages in a step of 1."""
WEIGHTS = np.array(
    [
        [(88 - 7 * S6) / 360, (296 - 169 * S6) / 1800, (-2 + 3 * S6) / 225],
        [(296 + 169 * S6) / 1800, (88 + 7 * S6) / 360, (-2 - 3 * S6) / 225],
        [(16 - S6) / 36, (16 + S6) / 36, 1 / 9],
    ]
)
TOLERANCE, MOST_ITERATIONS, AGE = 1e-11, 60, 40
"""Of q [rad, m]; iterations of a step; steps that may share a mass matrix."""


class Hubs(NamedTuple):
    """Reducers and bearings, one entry per driven joint: laws of hub.py. Rigid ones prescribe their dof."""

    dof: NDArray[np.int64]
    rigid: NDArray[np.bool_]
    stiffness: Floats
    damping: Floats
    cubic: Floats
    gap: Floats
    hysteresis: Floats
    width: Floats
    coulomb: Floats
    viscous: Floats
    cable: Floats
    cable_rest: Floats
    softened: Floats
    softens_at: Floats
    cracked: Floats
    rub: Floats
    rub_at: Floats
    rub_width: Floats
    stop: Floats
    stop_at: Floats


class Step(NamedTuple):
    """All stages of a step: q, v, a, z and dz/dx of the hubs, K and C, and those that the iteration uses."""

    q: Floats
    v: Floats
    a: Floats
    z: Floats
    K: Floats
    C: Floats
    K_used: Floats
    C_used: Floats
    residual: Floats


class Run(NamedTuple):
    """Motion at the ends of all steps, row 0 the start."""

    q: Floats
    v: Floats
    a: Floats
    z: Floats


@njit(cache=True)
def dahl(z, way, width):
    """z and dz/dx after a way [rad]: z' = (x' - z |x'|)/w, solved."""
    sign = 1.0 if way > 0 else -1.0
    z = sign + (z - sign) * np.exp(-abs(way) / width)
    return z, (1 - z * sign) / width


@njit(cache=True)
def reducer(hubs, j, d, rate, z, dz, t):
    """T_r of hub.py (2) and (6), and its derivatives by d and d'."""
    half = hubs.gap[j] / 2
    since = min(max((t - hubs.softens_at[j]) / CHANGES, 0.0), 1.0)
    left = 1.0 - hubs.softened[j] * since**3 * (10 - 15 * since + 6 * since * since)
    if d < 0:
        left *= 1.0 - hubs.cracked[j]
    stiffness = hubs.stiffness[j] * left
    play = min(max(d, -half), half)
    e = d - play
    depth = min(max((half - abs(d)) / FADING, 0.0), 1.0) if half > 0 else 0.0
    c = hubs.damping[j] * (1 - (1 - LOOSE_DAMPING) * depth)
    k = stiffness if abs(d) >= half else LOOSE_STIFFNESS * stiffness
    torque = stiffness * (e + LOOSE_STIFFNESS * play) + hubs.cubic[j] * e**3
    slope = k + 3 * hubs.cubic[j] * e * e + 1e-9
    if 0 < depth < 1:  # the damper's own derivative, where it does not push away
        slope += max(0.0, hubs.damping[j] * (1 - LOOSE_DAMPING) / FADING * rate * np.sign(d))
    torque += hubs.hysteresis[j] * z
    return torque + c * rate, slope + hubs.hysteresis[j] * dz, c


@njit(cache=True)
def bearing(hubs, j, theta, rate, z, dz):
    """What hub.py (3) and (7) take from it, and its derivatives."""
    torque = hubs.coulomb[j] * z + hubs.viscous[j] * rate + hubs.cable[j] * (theta - hubs.cable_rest[j])
    slope = hubs.coulomb[j] * dz + hubs.cable[j]
    if hubs.rub[j] > 0:
        near = (theta - hubs.rub_at[j]) / hubs.rub_width[j]
        rubs = hubs.rub[j] * np.exp(-near * near)
        torque += rubs * z
        slope += rubs * (dz - 2 * near / hubs.rub_width[j] * z)
    if theta > hubs.stop_at[j]:
        torque += hubs.stop[j] * (theta - hubs.stop_at[j])
        slope += hubs.stop[j]
    return torque, slope, hubs.viscous[j]


@njit(cache=True)
def unbalanced(chain, hubs, q, v, a, z, psi, t, moment, s, out, K, C):
    """tau of (6) less what springs and reducers give, and the derivatives K, C of the latter."""
    move_outward(chain, q, v, a, chain.gravity, s)
    forces_inward(chain, s, out)
    for k in range(len(q)):
        grown = 1.0 - np.exp(-t / chain.rest_time[k]) if chain.rest_time[k] > 0 else 1.0
        grows = chain.rest[k] * np.exp(-t / chain.rest_time[k]) / chain.rest_time[k] if grown < 1 else 0.0
        x = q[k] - chain.rest[k] * grown
        out[k] += chain.stiffness[k] * x * (1 + chain.hardening[k] * abs(x))
        out[k] += chain.damping[k] * (v[k] - grows)
        K[k], C[k] = chain.stiffness[k] * (1 + 2 * chain.hardening[k] * abs(x)), chain.damping[k]
    if chain.shaken >= 0:
        out[chain.shaken] -= moment
    for j in range(len(hubs.dof)):
        k = hubs.dof[j]
        taken, K_b, C_b = bearing(hubs, j, q[k], v[k], z[j, 1], z[j, 3])
        out[k] += taken
        K[k], C[k] = K[k] + K_b, C[k] + C_b
        if not hubs.rigid[j]:
            torque, K_r, C_r = reducer(hubs, j, psi[j, 0] - q[k], psi[j, 1] - v[k], z[j, 0], z[j, 2], t)
            out[k] -= torque
            K[k], C[k] = K[k] + K_r, C[k] + C_r


@njit(cache=True)
def iteration_matrix(M, K, C, h, A, AA, free):
    """Inverse of delta_st M + h A_st C_t + h^2 (A^2)_st K_t, stages s and t."""
    n, stages = len(M), len(A)
    J = np.zeros((stages * n, stages * n))
    for s in range(stages):
        for i in range(n):
            for j in range(n):
                J[s * n + i, s * n + j] = M[i, j]
            for t in range(stages):
                J[s * n + i, t * n + i] += h * A[s, t] * C[s, free[i]] + h * h * AA[s, t] * K[s, free[i]]
    return np.linalg.inv(J)


@njit(cache=True)
def states_of_friction(hubs, z, q0, psi0, q, psi, out):
    """z of reducers and bearings, and dz/dx, at every stage along the way from the one before."""
    for j in range(len(hubs.dof)):
        k = hubs.dof[j]
        z_h, z_b, x, d = z[j, 0], z[j, 1], q0[k], psi0[j, 0] - q0[k]
        for s in range(len(q)):
            deflection = psi[s, j, 0] - q[s, k]
            z_h, out[s, j, 2] = dahl(z_h, deflection - d, hubs.width[j])
            z_b, out[s, j, 3] = dahl(z_b, q[s, k] - x, STICK_WIDTH)
            out[s, j, 0], out[s, j, 1] = z_h, z_b
            x, d = q[s, k], deflection


@njit(cache=True)
def advance_stages(hubs, step, run, i, psi, h, A, AA, times):
    """q, v and z of all stages from a; a rigid reducer prescribes its own."""
    for s in range(len(times)):
        for k in range(step.q.shape[1]):
            q, v = run.q[i - 1, k] + times[s] * h * run.v[i - 1, k], run.v[i - 1, k]
            for other in range(len(times)):
                q += h * h * AA[s, other] * step.a[other, k]
                v += h * A[s, other] * step.a[other, k]
            step.q[s, k], step.v[s, k] = q, v  # eq. (1)
        for j in range(len(hubs.dof)):
            if hubs.rigid[j]:
                k = hubs.dof[j]
                step.q[s, k], step.v[s, k], step.a[s, k] = psi[i, s, j, 0], psi[i, s, j, 1], psi[i, s, j, 2]
    states_of_friction(hubs, run.z[i - 1], run.q[i - 1], psi[i - 1, -1], step.q, psi[i], step.z)


@njit(cache=True)
def residuals(chain, hubs, step, i, psi, moment, h, times, s, out):
    """What is unbalanced at all stages, in the free degrees of freedom."""
    n = len(chain.free)
    for stage in range(len(times)):
        t = (i - 1 + times[stage]) * h
        q, v, a, z = step.q[stage], step.v[stage], step.a[stage], step.z[stage]
        K, C = step.K[stage], step.C[stage]
        unbalanced(chain, hubs, q, v, a, z, psi[i, stage], t, moment[i, stage], s, out, K, C)
        for k in range(n):
            step.residual[stage * n + k] = out[chain.free[k]]


@njit(cache=True)
def differ(now, used, free):
    """Whether derivatives are far from those that Newton's iteration uses; these are set then."""
    far = False
    for stage in range(len(now)):
        for k in free:
            far = far or abs(now[stage, k] - used[stage, k]) > 0.2 * abs(used[stage, k])
    if far:
        copy_rows(used, now)
    return far


@njit(cache=True)
def copy_rows(out, rows):
    """out = rows."""
    for i in range(len(rows)):
        for k in range(rows.shape[1]):
            out[i, k] = rows[i, k]


@njit(cache=True)
def correct(step, change, free, factor):
    """Accelerations of all stages less a part of the change; the largest change."""
    n, largest = len(free), 0.0
    for stage in range(len(step.a)):
        for k in range(n):
            step.a[stage, free[k]] -= factor * change[stage * n + k]
            largest = max(largest, abs(change[stage * n + k]))
    return largest


@njit(cache=True)
def keep(step, run, i):
    """The last stage, end of the step, as row i of the run."""
    for k in range(run.q.shape[1]):
        run.q[i, k], run.v[i, k], run.a[i, k] = step.q[-1, k], step.v[-1, k], step.a[-1, k]
    copy_rows(run.z[i], step.z[-1])


@njit(cache=True)
def integrate(chain, hubs, psi, moment, h, A, AA, times, s, step, run, inverse):
    """Motion from rest at row 0 of `run`, which it fills; returns the step that failed, or -1.

    `psi` (steps, stages, hubs, 3): teeth of hub.py (1) with two derivatives at every stage, the last stage of
    step 0 being the start; `moment` (steps, stages) shakes the base. A new step begins with the last a, a new
    mass matrix every AGE steps and where the iteration is slow.
    """
    age, out = AGE, np.zeros(run.q.shape[1])
    M = mass_matrix(chain, run.q[0], s)
    for i in range(1, len(psi)):
        for stage in range(len(times)):
            for k in range(len(out)):
                step.a[stage, k] = run.a[i - 1, k]
        left = 1.0
        for iteration in range(MOST_ITERATIONS):
            advance_stages(hubs, step, run, i, psi, h, A, AA, times)
            residuals(chain, hubs, step, i, psi, moment, h, times, s, out)
            fresh = (iteration == 0 and age >= AGE) or iteration == 5 or iteration == 10
            if fresh:
                M, age = mass_matrix(chain, step.q[-1], s), 0
            stiff, damped = differ(step.K, step.K_used, chain.free), differ(step.C, step.C_used, chain.free)
            if fresh or stiff or damped:
                inverse = iteration_matrix(M, step.K, step.C, h, A, AA, chain.free)
            change = inverse @ step.residual
            left = h * h * correct(step, change, chain.free, 0.5 ** (iteration // 12))
            if left < TOLERANCE:
                break
        if not left < TOLERANCE:
            return i
        age += 1
        keep(step, run, i)
    return -1


@njit(cache=True)
def reducer_torques(chain, hubs, run, psi, h, s, torques):
    """T_r of hub.py (2) after all steps; of a rigid reducer, what joint and bearing need."""
    n = run.q.shape[1]
    out, K, C = np.zeros(n), np.zeros(n), np.zeros(n)
    for i in range(len(psi)):
        q, v, z, teeth = run.q[i], run.v[i], run.z[i], psi[i, -1]
        unbalanced(chain, hubs, q, v, run.a[i], z, teeth, i * h, 0.0, s, out, K, C)
        for j in range(len(hubs.dof)):
            k = hubs.dof[j]
            torques[i, j] = out[k]
            if not hubs.rigid[j]:
                d, rate = teeth[j, 0] - q[k], teeth[j, 1] - v[k]
                torques[i, j] = reducer(hubs, j, d, rate, z[j, 0], z[j, 2], i * h)[0]
