"""Equilibria of an arm, one a pose, as a sequence that reads like a simulation.

At rest an accelerometer shows f = -R^T g, which is linear in R and so of its derivatives too; quaternions
follow the rotation vector w of dR R^T, base axes:

    dq = (w, 0) q/2                                                                                  (1)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats, frozen
from flexarm.measurement.state_snapshots import StateSnapshots
from flexarm.sensitivity import Sensitivities
from flexarm.statics.batch import StaticSolution

SEEN = ("position", "rotation", "link_angle", "joint_torque", "section_forces")
"""Arrays of an equilibrium that a sequence is made from."""


@dataclass(frozen=True, eq=False)
class PoseSequence(StateSnapshots):
    """Hold equilibria of an arm, one a pose, at rest; torques are the drives', output side [N m]."""

    sensitivities: Sensitivities | None = None
    """Derivatives of the arrays by parameters of the model; of those that are zero at rest there are none."""

    @property
    def joint_torque(self) -> Floats:
        """Torques at the joints [N m], as of a `Simulation`."""
        return self.motor_torque


def sequence(arm: Arm, found: Sequence[StaticSolution]) -> PoseSequence:
    """Return the equilibria as one sequence."""
    from scipy.spatial.transform import Rotation

    arrays = {name: np.array([held.arrays[name] for held in found]) for name in SEEN}
    still = np.zeros_like(arrays["position"])
    turns = Rotation.from_matrix([np.eye(3), *(R for held in found for R in held.arrays["rotation"])])[1:]
    return PoseSequence(
        arm=arm,
        time=np.arange(float(len(found))),
        position=arrays["position"],
        velocity=still,
        orientation=turns.as_quat().reshape(*still.shape[:2], 4),
        angular_rate=still,
        acceleration=-np.einsum("nabc,b->nac", arrays["rotation"], np.asarray(arm.gravity)),
        joint_angle=arrays["link_angle"],
        joint_rate=np.zeros_like(arrays["link_angle"]),
        drive_angle=np.array([held.values for held in found]),
        drive_rate=np.zeros_like(arrays["link_angle"]),
        motor_torque=arrays["joint_torque"],
        section_forces=arrays["section_forces"],
    )


def slopes_of(arm: Arm, run: PoseSequence, slopes: Mapping[str, Floats]) -> dict[str, Floats]:
    """Return derivatives of a sequence's arrays, parameters last, from those of `SEEN` and drive angles.

    Some of `SEEN` may lack; what follows from them lacks too.
    """
    names = {
        "position": "position",
        "joint_angle": "link_angle",
        "drive_angle": "drive_angle",
        "motor_torque": "joint_torque",
        "section_forces": "section_forces",
    }
    arrays = {name: slopes[made_of] for name, made_of in names.items() if made_of in slopes}
    if (turning := slopes.get("rotation")) is not None:
        arrays["orientation"] = _turning(run.orientation, turning)
        arrays["acceleration"] = -np.einsum("nabck,b->nack", turning, np.asarray(arm.gravity))
    return {name: frozen(array) for name, array in arrays.items()}


def _turning(quaternion: Floats, rotation: Floats) -> Floats:
    """Return derivatives (1) of quaternions, shape (n, point, 4, k), from those of their matrices."""
    from scipy.spatial.transform import Rotation

    x, y, z, real = np.moveaxis(quaternion, -1, 0)[..., None]
    R = Rotation.from_quat(quaternion.reshape(-1, 4)).as_matrix().reshape(*quaternion.shape[:2], 3, 3)
    skew = np.einsum("npabk,npcb->npack", rotation, R)
    a, b, c = skew[:, :, 2, 1], skew[:, :, 0, 2], skew[:, :, 1, 0]
    turned = [
        a * real + b * z - c * y,
        b * real + c * x - a * z,
        c * real + a * y - b * x,
        -a * x - b * y - c * z,
    ]
    return 0.5 * np.stack(turned, axis=2)  # eq. (1)
