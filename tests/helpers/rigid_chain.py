"""Equations of motion of a chain of rigid links, written apart from flexarm: Newton and Euler, link by link.

    w_k = w_p + e_k q'_k,   a_k = a_p + w_p' x d + w_p x (w_p x d)     outwards                       (1)
    f_k = f_(k+1) + m (a_c - g),   n_k = n_(k+1) + ... + I w' + w x I w         inwards               (2)
    tau_k = e_k . n_k = M(q) q'' + c(q, q')                                                          (3)

All vectors in base axes. Revolute and prismatic joints; the columns of M come from unit accelerations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def cross(a: Floats, b: Floats) -> Floats:
    """a x b, components along the first axis; for single vectors ten times faster than NumPy's."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def turn(axis: Floats, angle: float) -> Floats:
    """Rotation about a unit axis, Rodrigues' formula."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * (K @ K)


@dataclass(frozen=True)
class Body:
    """A link with the joint that carries it.

    Attributes
    ----------
    axis : (3,)
        Joint axis, in the parent link's axes at q = 0 (all links' axes are parallel then).
    origin : (3,)
        Joint in the parent's frame [m].
    mass, com, inertia
        Of the link, in its frame; inertia (Ixx, Iyy, Izz) or with (Ixy, Ixz, Iyz), about the centre of mass.
    prismatic : bool
        Slides instead of turning.
    """

    axis: tuple[float, float, float]
    origin: tuple[float, float, float]
    mass: float
    com: tuple[float, float, float]
    inertia: tuple[float, ...] = (0.0, 0.0, 0.0)
    prismatic: bool = False

    @property
    def tensor(self) -> Floats:
        """Inertia as a matrix."""
        xx, yy, zz, xy, xz, yz = (*self.inertia, 0.0, 0.0, 0.0)[:6]
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


class RigidChain:
    """A chain of bodies on the ground, under gravity."""

    def __init__(self, bodies: list[Body], gravity: ArrayLike = (0, 0, -9.81)) -> None:
        self.bodies, self.gravity = bodies, np.asarray(gravity, float)

    def place(self, q: ArrayLike, link: int, position: ArrayLike) -> Floats:
        """A point of a link, base axes [m]."""
        R, x = np.eye(3), np.zeros(3)
        for body, angle in zip(self.bodies[: link + 1], q, strict=False):
            x = x + R @ np.array(body.origin)
            axis = np.array(body.axis, float) / np.linalg.norm(body.axis)
            if body.prismatic:
                x = x + R @ axis * angle
            else:
                R = R @ turn(axis, angle)
        return x + R @ np.asarray(position, float)

    def inverse_dynamics(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> tuple[Floats, Floats]:
        """Joint torques of (3), and the wrench (force, moment about the origin) on the base.

        `a` may hold several columns of accelerations; then so do the results.
        """
        columns = np.asarray(a, float).reshape(len(self.bodies), -1)
        R, x, w = np.eye(3), np.zeros((3, 1)), np.zeros((3, 1))
        alpha = acc = np.zeros((3, columns.shape[1]))
        joints, loads = [], []
        for body, angle, rate, change in zip(self.bodies, q, v, columns, strict=True):
            e = R @ np.array(body.axis, float) / np.sqrt(np.dot(body.axis, body.axis))
            d = (R @ np.array(body.origin, float) + (e * angle if body.prismatic else 0))[:, None]
            acc = acc + cross(alpha, d) + cross(w, cross(w, d))  # eq. (1)
            x, along = x + d, e[:, None]
            if body.prismatic:
                acc = acc + 2 * cross(w, along) * rate + along * change
            else:
                R = turn(e, angle) @ R
                alpha = alpha + along * change + cross(w, along) * rate
                w = w + along * rate
            c = (R @ np.array(body.com, float))[:, None]
            inertia = R @ body.tensor @ R.T
            force = body.mass * (acc + cross(alpha, c) + cross(w, cross(w, c)) - self.gravity[:, None])
            moment = inertia @ alpha + cross(w, inertia @ w) + cross(x + c, force)
            joints.append((e, x))
            loads.append((force, moment))  # moments about the base's origin
        torque = np.zeros_like(columns)
        force = moment = np.zeros_like(acc)
        for k in reversed(range(len(joints))):
            force, moment = force + loads[k][0], moment + loads[k][1]  # eq. (2)
            e, at = joints[k]
            torque[k] = e @ (force if self.bodies[k].prismatic else moment - cross(at, force))  # eq. (3)
        wrench = -np.concatenate([force, moment])
        return (torque, wrench) if np.ndim(a) > 1 else (torque[:, 0], wrench[:, 0])

    def acceleration(self, q: ArrayLike, v: ArrayLike, torque: ArrayLike) -> Floats:
        """q'' under joint torques."""
        n = len(self.bodies)
        found = self.inverse_dynamics(q, v, np.hstack([np.zeros((n, 1)), np.eye(n)]))[0]
        bias, mass = found[:, 0], found[:, 1:] - found[:, :1]
        return np.linalg.solve(mass, np.asarray(torque) - bias)

    def tables(self) -> dict[str, list[dict]]:
        """The same chain as joints and rigid links of a model; link names link0, link1, ..."""
        kinds = ["prismatic" if body.prismatic else "revolute" for body in self.bodies]
        return {
            "gravity": list(self.gravity),
            "joints": [
                {
                    "name": f"joint{k}",
                    "type": kinds[k],
                    "parent": f"link{k - 1}" if k else "base",
                    "child": f"link{k}",
                    "origin": {"xyz": list(body.origin)},
                    "axis": list(body.axis),
                }
                for k, body in enumerate(self.bodies)
            ],
            "links": [
                {
                    "name": f"link{k}",
                    "type": "rigid",
                    "mass": body.mass,
                    "com": list(body.com),
                    "inertia": list(body.inertia),
                }
                for k, body in enumerate(self.bodies)
            ],
        }


def random_chain(rng: np.random.Generator) -> RigidChain:
    """Two to six bodies of 0.5 to 20 kg with oblique axes, one joint in five sliding."""
    bodies = []
    for _ in range(int(rng.integers(2, 7))):
        axis, size = rng.normal(size=3), rng.uniform(0.1, 1.0)
        mass = float(np.exp(rng.uniform(np.log(0.5), np.log(20))))
        R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        tensor = R @ np.diag(mass * size**2 / 12 * np.array([1.1, 1.0, 0.5])) @ R.T
        bodies.append(
            Body(
                axis=tuple(axis / np.linalg.norm(axis)),
                origin=tuple(rng.uniform(-1, 1, 3) * size),
                mass=mass,
                com=tuple(rng.uniform(-0.5, 0.5, 3) * size),
                inertia=tuple(tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]),
                prismatic=bool(rng.random() < 0.2),
            )
        )
    return RigidChain(bodies)
