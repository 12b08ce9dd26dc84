"""The motion that equation (1), equation (2) or the rigid arm predicts."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from flexarm.analytic.nonlinear_modal import Array, ModalArm
from flexarm.errors import InvalidParameter


@dataclass(frozen=True)
class ArmMotion:
    """A simulated motion; one row a time, arrays are read-only."""

    time: Array
    """Time [s], shape (n,)."""
    coordinates: Array
    rates: Array
    """q [kg^½ m] and its derivative [kg^½ m/s], shape (n, n_modes)."""
    drive_angle: Array
    """Motor angle φ [rad]; the hub angle where a torque drives the joint, shape (n,)."""
    joint_angle: Array
    """Hub angle [rad], shape (n,)."""
    joint_torque: Array
    """Torque of the drive on the hub, bearing friction excluded [N m], shape (n,)."""
    tip: Array
    """Tip position x, z [m], z up, shape (n, 2)."""
    tangential: Array
    radial: Array
    """Tip offset from the rigid arm at `drive_angle` [m]: towards rising angle, and outward along the arm,
    shape (n,)."""

    def __post_init__(self) -> None:
        for item in fields(self):
            getattr(self, item.name).setflags(write=False)

    def __repr__(self) -> str:
        return (
            f"ArmMotion({len(self.time)} times, {self.time[0]:g} to {self.time[-1]:g} s, "
            f"{self.coordinates.shape[1]} coordinates, "
            f"largest tangential offset {1e3 * np.abs(self.tangential).max():.3f} mm)"
        )


def directions(angle: Array | float) -> tuple[Array, Array]:
    """Return radial and tangential unit vectors (x, z) at an angle from the vertical; shape (..., 2)."""
    s, c = np.sin(angle), np.cos(angle)
    return np.stack([s, c], axis=-1), np.stack([c, -s], axis=-1)


def tip_position(arm: ModalArm, q: Array) -> Array:
    """Return the tip x, z [m] for coordinates of shape (..., n + 1), eq. (B1) of `modal_basis`."""
    basis = arm.basis
    radial, tangential = directions(arm.frame_angle(q))
    deflection = q[..., 1:] @ basis.tip_shape[1:]
    shortening = np.einsum("...i,ij,...j", q, basis.foreshortening, q) / 2
    along = (basis.link.length - shortening)[..., None]
    position: Array = along * radial + deflection[..., None] * tangential
    return position


def make_motion(
    arm: ModalArm, time: Array, q: Array, v: Array, drive_angle: Array | None, joint_torque: Array
) -> ArmMotion:
    """Derive angles, tip and offsets from the coordinates."""
    joint_angle = q @ arm.basis.hub_slope
    reference = joint_angle if drive_angle is None else drive_angle
    tip = tip_position(arm, q)
    radial, tangential = directions(reference + arm.zero_angle)
    offset = tip - arm.basis.link.length * radial
    return ArmMotion(
        time=np.array(time, dtype=float),
        coordinates=q,
        rates=v,
        drive_angle=np.array(reference, dtype=float),
        joint_angle=joint_angle,
        joint_torque=joint_torque,
        tip=tip,
        tangential=np.sum(offset * tangential, axis=-1),
        radial=np.sum(offset * radial, axis=-1),
    )


def rigid_tip(length: float, angle: Array | float, hanging: bool = False) -> Array:
    """Return the tip x, z [m] of a rigid arm, L (sin θ, cos θ), shape (..., 2), z up.

    The angle [rad] counts from the upright vertical (or the hanging one), positive from z towards x.
    """
    if not length > 0:
        raise InvalidParameter(f"arm's length must be positive, got {length} m")
    radial = directions(np.asarray(angle, dtype=float) + (np.pi if hanging else 0.0))[0]
    return length * radial
