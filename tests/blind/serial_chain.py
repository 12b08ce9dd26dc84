"""A serial chain of rigid bodies, written apart from flexarm and compiled: what its joints must bear.

Degree of freedom k turns about, or slides along, axis i_k (x, y or z) of the body before it. What a body must
have is summed outward, what its joint must bear inward (Newton and Euler), in the
axes of the base; u_k is the axis, r_k the way from the joint before, c_k that to the centre of mass:

    turns    w_k = w_(k-1) + u_k q_k',   w_k' = w_(k-1)' + u_k q_k'' + w_(k-1) x u_k q_k'                (1)
             a_k = a_(k-1) + w_(k-1)' x r_k + w_(k-1) x (w_(k-1) x r_k),   a_0 = -g                      (2)
    slides   w_k = w_(k-1),   a_k of (2) + u_k q_k'' + 2 w_(k-1) x u_k q_k'                              (3)
    F_k = m_k (a_k + w_k' x c_k + w_k x (w_k x c_k)) + F_(k+1)                                           (4)
    N_k = I_k w_k' + w_k x I_k w_k + c_k x m_k(..) + N_(k+1) + r_(k+1) x F_(k+1)                         (5)
    tau_k = u_k . N_k where it turns, u_k . F_k where it slides                                          (6)

Numba keeps what it compiled beside the sources and does not see that serial_motion.py calls what changed
here: after a change, remove tests/blind/__pycache__.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Chain(NamedTuple):
    """Bodies and springs; one row per degree of freedom, SI units.

    `slides`, `axis`, `offset` (from the joint before, in its body's axes), `mass`, `com`, `inertia` (about
    the centre), spring and damper, its rest value, reached as 1 - exp(-t/time) or at once, its hardening;
    `free` are those that nothing prescribes, `turn` is the base's rotation, `drag` [N s2/m2] acts at `tip` of
    the last body, `shaken` bears the base's moment (-1: none).
    """

    slides: NDArray[np.bool_]
    axis: NDArray[np.int64]
    offset: Floats
    mass: Floats
    com: Floats
    inertia: Floats
    stiffness: Floats
    damping: Floats
    rest: Floats
    rest_time: Floats
    hardening: Floats
    free: NDArray[np.int64]
    turn: Floats
    gravity: Floats
    drag: float
    tip: Floats
    shaken: int


class Scratch(NamedTuple):
    """Kinematics of one state; row 0 is the base."""

    R: Floats
    r: Floats
    w: Floats
    dw: Floats
    v: Floats
    a: Floats
    F: Floats
    N: Floats


def scratch(n: int) -> Scratch:
    """Room for n degrees of freedom."""
    return Scratch(np.zeros((n + 1, 3, 3)), *(np.zeros((n + 1, 3)) for _ in range(7)))


@njit(cache=True)
def add_cross(out, a, b, factor):
    """out += factor a x b."""
    out[0] += factor * (a[1] * b[2] - a[2] * b[1])
    out[1] += factor * (a[2] * b[0] - a[0] * b[2])
    out[2] += factor * (a[0] * b[1] - a[1] * b[0])


@njit(cache=True)
def add_turned(out, R, b):
    """out += R b."""
    for i in range(3):
        out[i] += R[i, 0] * b[0] + R[i, 1] * b[1] + R[i, 2] * b[2]


@njit(cache=True)
def add_moment(out, R, inertia, w):
    """out += R inertia R^T w."""
    x = R[0, 0] * w[0] + R[1, 0] * w[1] + R[2, 0] * w[2]
    y = R[0, 1] * w[0] + R[1, 1] * w[1] + R[2, 1] * w[2]
    z = R[0, 2] * w[0] + R[1, 2] * w[1] + R[2, 2] * w[2]
    for i in range(3):
        local = inertia[i, 0] * x + inertia[i, 1] * y + inertia[i, 2] * z
        for row in range(3):
            out[row] += R[row, i] * local


@njit(cache=True)
def add_scaled(out, a, factor):
    """out += factor a. Loops like this one compile ten times as fast as expressions of arrays."""
    for i in range(3):
        out[i] += factor * a[i]


@njit(cache=True)
def set_scaled(out, a, factor):
    """out = factor a."""
    for i in range(3):
        out[i] = factor * a[i]


@njit(cache=True)
def turn_axes(R, before, i, angle):
    """R = before turned about its axis i."""
    j, m = (i + 1) % 3, (i + 2) % 3
    cosine, sine = np.cos(angle), np.sin(angle)
    for row in range(3):
        left, right = before[row, j], before[row, m]
        R[row, i] = before[row, i]
        R[row, j] = cosine * left + sine * right
        R[row, m] = cosine * right - sine * left


@njit(cache=True)
def set_base(chain, gravity, s):
    """Row 0 of the kinematics: at rest, and lifted by what stands for the weight."""
    for i in range(3):
        set_scaled(s.R[0, i], chain.turn[i], 1.0)
    set_scaled(s.w[0], gravity, 0.0)
    set_scaled(s.dw[0], gravity, 0.0)
    set_scaled(s.v[0], gravity, 0.0)
    set_scaled(s.a[0], gravity, -1.0)


@njit(cache=True)
def move_outward(chain, q, v, a, gravity, s):
    """(1) to (3) for all bodies; velocities of their origins, too."""
    set_base(chain, gravity, s)
    turn, u = np.zeros(3), np.zeros(3)
    for k in range(len(q)):
        i = chain.axis[k]
        R, r, w, dw, velocity, acc = s.R[k], s.r[k + 1], s.w[k + 1], s.dw[k + 1], s.v[k + 1], s.a[k + 1]
        for row in range(3):
            u[row] = R[row, i]
        set_scaled(w, s.w[k], 1.0)
        set_scaled(dw, s.dw[k], 1.0)
        set_scaled(velocity, s.v[k], 1.0)
        set_scaled(acc, s.a[k], 1.0)
        set_scaled(r, u, 0.0)
        add_turned(r, R, chain.offset[k])
        if chain.slides[k]:
            turn_axes(s.R[k + 1], R, i, 0.0)
            add_scaled(r, u, q[k])
            add_scaled(velocity, u, v[k])
            add_scaled(acc, u, a[k])  # eq. (3)
            add_cross(acc, s.w[k], u, 2 * v[k])
        else:
            turn_axes(s.R[k + 1], R, i, q[k])
            add_scaled(w, u, v[k])  # eq. (1)
            add_scaled(dw, u, a[k])
            add_cross(dw, s.w[k], u, v[k])
        set_scaled(turn, u, 0.0)
        add_cross(turn, s.w[k], r, 1.0)
        add_scaled(velocity, turn, 1.0)
        add_cross(acc, s.dw[k], r, 1.0)  # eq. (2)
        add_cross(acc, s.w[k], turn, 1.0)


@njit(cache=True)
def set_body_force(chain, k, s, c, spin):
    """Own parts of (4) and (5); `c` and `spin` are room for vectors."""
    F, N, w, dw, R = s.F[k + 1], s.N[k + 1], s.w[k + 1], s.dw[k + 1], s.R[k + 1]
    mass = chain.mass[k]
    set_scaled(N, w, 0.0)
    set_scaled(F, s.a[k + 1], mass)
    if mass > 0:
        set_scaled(c, w, 0.0)
        set_scaled(spin, w, 0.0)
        add_turned(c, R, chain.com[k])
        add_cross(spin, w, c, 1.0)
        add_cross(F, dw, c, mass)
        add_cross(F, w, spin, mass)  # eq. (4)
        add_cross(N, c, F, 1.0)
        set_scaled(spin, w, 0.0)
        add_moment(spin, R, chain.inertia[k], w)
        add_cross(N, w, spin, 1.0)
        add_moment(N, R, chain.inertia[k], dw)  # eq. (5)


@njit(cache=True)
def forces_inward(chain, s, tau):
    """(4) to (6) after `move_outward`."""
    n, c, spin = len(tau), np.zeros(3), np.zeros(3)
    for k in range(n):
        set_body_force(chain, k, s, c, spin)
    if chain.drag > 0:
        add_drag(chain, s, n, c, spin)
    for k in range(n - 1, -1, -1):
        if k + 1 < n:
            add_scaled(s.F[k + 1], s.F[k + 2], 1.0)
            add_scaled(s.N[k + 1], s.N[k + 2], 1.0)
            add_cross(s.N[k + 1], s.r[k + 2], s.F[k + 2], 1.0)
        tau[k] = 0.0
        for row in range(3):
            bears = s.F[k + 1, row] if chain.slides[k] else s.N[k + 1, row]
            tau[k] += s.R[k, row, chain.axis[k]] * bears  # eq. (6)


@njit(cache=True)
def add_drag(chain, s, n, arm, velocity):
    """Force -drag |v| v at the tip of the last body; `arm` and `velocity` are room for vectors."""
    set_scaled(arm, s.v[n], 0.0)
    set_scaled(velocity, s.v[n], 1.0)
    add_turned(arm, s.R[n], chain.tip)
    add_cross(velocity, s.w[n], arm, 1.0)
    strength = chain.drag * np.sqrt(velocity[0] ** 2 + velocity[1] ** 2 + velocity[2] ** 2)
    add_scaled(s.F[n], velocity, strength)
    add_cross(s.N[n], arm, velocity, strength)


@njit(cache=True)
def mass_matrix(chain, q, s):
    """Of the free degrees of freedom: tau of unit accelerations without weight."""
    free, still, unit, tau = chain.free, np.zeros(len(q)), np.zeros(len(q)), np.zeros(len(q))
    M = np.zeros((len(free), len(free)))
    for column in range(len(free)):
        unit[free[column]] = 1.0
        move_outward(chain, q, still, unit, still[:3], s)
        forces_inward(chain, s, tau)
        unit[free[column]] = 0.0
        for row in range(len(free)):
            M[row, column] = tau[free[row]]
    return M


@njit(cache=True)
def places(chain, q, dof, at, s):
    """A point fixed to the body of one degree of freedom, for rows of q; base's axes, from its origin."""
    out, still = np.zeros((len(q), 3)), np.zeros(q.shape[1])
    for row in range(len(q)):
        move_outward(chain, q[row], still, still, chain.gravity, s)
        for k in range(dof + 1):
            add_scaled(out[row], s.r[k + 1], 1.0)
        add_turned(out[row], s.R[dof + 1], at)
    return out


@njit(cache=True)
def energies(chain, q, v, s):
    """Kinetic, elastic (springs between bodies) and gravity energy of one state [J]."""
    move_outward(chain, q, v, 0.0 * q, chain.gravity, s)
    kinetic, weight, elastic = 0.0, 0.0, 0.0
    o, c, velocity, spin = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)
    for k in range(len(q)):
        add_scaled(o, s.r[k + 1], 1.0)
        elastic += 0.5 * chain.stiffness[k] * (q[k] - chain.rest[k]) ** 2
        set_scaled(c, o, 0.0)
        set_scaled(spin, o, 0.0)
        add_turned(c, s.R[k + 1], chain.com[k])
        set_scaled(velocity, s.v[k + 1], 1.0)
        add_cross(velocity, s.w[k + 1], c, 1.0)
        add_moment(spin, s.R[k + 1], chain.inertia[k], s.w[k + 1])
        for i in range(3):
            kinetic += 0.5 * (chain.mass[k] * velocity[i] ** 2 + s.w[k + 1, i] * spin[i])
            weight -= chain.mass[k] * chain.gravity[i] * (o[i] + c[i])
    return kinetic, elastic, weight
