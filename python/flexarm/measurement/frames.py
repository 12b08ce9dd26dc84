"""Frames of measurement: from the base's axes to those of a tracker.

A point p of the base's frame is measured, the time s after the start of the run, as

    y = scale R_f^T (R(rotation) p + translation + velocity s - x_f)                                 (1)

(R_f, x_f) is the stated pose of the tracker's frame in the base, p = R_f y + x_f, and (rotation, translation)
the error of that statement, a small rotation vector and shift about the base's origin: the registration. With
the stated pose left out, (1) is the effects `frame_registration`, `frame_drift` and `frame_scale`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from flexarm.arrays import Floats


def rotation_matrix(vector: Floats) -> Floats:
    """Return R(v) of a rotation vector [rad], by Rodrigues' formula, shape (3, 3)."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    half = 0.5 * np.sinc(angle / (2 * np.pi)) ** 2  # (1 - cos a)/a^2, finite at zero
    found: Floats = np.eye(3) + np.sinc(angle / np.pi) * cross + half * cross @ cross
    return found


@lru_cache(maxsize=64)  # every reading needs that of its frame
def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> Floats:
    """Return R = Rz(yaw) Ry(pitch) Rx(roll), as URDF has it, shape (3, 3), read-only."""
    found = (
        rotation_matrix(np.array([0, 0, yaw]))
        @ rotation_matrix(np.array([0, pitch, 0]))
        @ rotation_matrix(np.array([roll, 0, 0]))
    )
    found.setflags(write=False)
    return found


@dataclass(frozen=True)
class Registration:
    """Stated pose of a frame of measurement, and its error."""

    translation: Floats | tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: Floats | tuple[float, float, float] = (0.0, 0.0, 0.0)
    """The error of eq. (1): shift [m] and rotation vector [rad] about the base's origin, shape (3,)."""
    origin: Floats | tuple[float, float, float] = (0.0, 0.0, 0.0)
    """x_f, stated position of the frame in the base [m], shape (3,)."""
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Roll, pitch, yaw of R_f, the stated orientation of the frame in the base [rad]."""
    velocity: Floats | tuple[float, float, float] = (0.0, 0.0, 0.0)
    """With which the shift grows from the start of a run [m/s], shape (3,)."""
    scale: float = 1.0
    """Measured over true distance from the frame's origin."""

    @property
    def frame_axes(self) -> Floats:
        """R_f: axes of the frame in the base, shape (3, 3)."""
        return rotation_from_rpy(*self.rpy)

    @property
    def error_rotation(self) -> Floats:
        """R(rotation), shape (3, 3)."""
        return rotation_matrix(np.asarray(self.rotation, dtype=float))

    @property
    def in_base(self) -> tuple[Floats, Floats]:
        """Return R and x of p = R y + x, eq. (1) solved for a point p of the base, shapes (3, 3) and (3,)."""
        back = self.error_rotation.T
        return back @ self.frame_axes, back @ (np.asarray(self.origin) - np.asarray(self.translation))

    @property
    def pose(self) -> tuple[list[float], list[float]]:
        """Return xyz [m] and rpy [rad] of the frame with its error, as a record states them."""
        from scipy.spatial.transform import Rotation

        turn, xyz = self.in_base
        return xyz.tolist(), Rotation.from_matrix(turn).as_euler("xyz", suppress_warnings=True).tolist()

    @property
    def is_base(self) -> bool:
        """Return True if what is measured is what is in the base."""
        given = (self.translation, self.rotation, self.origin, self.rpy, self.velocity)
        return self.scale == 1 and not any(number for vector in given for number in vector)

    def positions(
        self, base: Floats, elapsed: Floats | float = 0.0, axes: Sequence[int] = (0, 1, 2)
    ) -> Floats:
        """Return positions as measured along some axes, eq. (1), from those in the base, shape (n, 3).

        `elapsed` [s] is s.
        """
        if self.is_base:
            return base if list(axes) == [0, 1, 2] else base[:, axes]
        along = self.scale * self.frame_axes[:, axes]
        measured: Floats = base @ (self.error_rotation.T @ along)
        measured += (np.asarray(self.translation) - np.asarray(self.origin)) @ along
        if any(self.velocity):
            measured += np.multiply.outer(elapsed, np.asarray(self.velocity) @ along)
        return measured

    def orientations(self, base: Floats) -> Floats:
        """Return quaternions (x, y, z, w) as measured, R_f^T R(rotation) R, shape (n, 4)."""
        from scipy.spatial.transform import Rotation

        turn = Rotation.from_matrix(self.frame_axes.T @ self.error_rotation)
        finite = np.isfinite(base).all(axis=1)
        found = np.full_like(base, np.nan)
        if finite.any():
            found[finite] = (turn * Rotation.from_quat(base[finite])).as_quat()
        return found


IDENTITY = Registration()
