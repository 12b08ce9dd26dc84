"""Static records: every pose an equilibrium, together a sequence that reads like a simulation.

The number of the pose takes the place of time, so sensors read poses as they read instants. Inputs of a pose
are its joint angles (drive signals, of motor or link as their side says; other joints stand where the record
says), forces at points and payload masses. Rows of one pose are repeated measurements: inputs are their
means, outputs are compared row by row. Effects of the model on sensors of inputs are taken back first.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexarm.errors import InvalidParameter
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.sampling import columns
from flexarm.record.doubts import INPUTS

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record, Signal

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PoseSequence:
    """Equilibria of an arm, one a pose, with the arrays that sensors read of a simulation.

    Attributes
    ----------
    arm : Arm
        The model.
    time : ndarray, shape (n,)
        Numbers of the poses: 0, 1, 2, ...
    points, joints : tuple of str
        Names, in the order of the arrays.
    position, velocity : ndarray, shape (n, point, 3)
        Places [m]; nothing moves.
    orientation, angular_rate, acceleration : ndarray, shapes (n, point, 4) and (n, point, 3)
        Quaternions x, y, z, w; no rate; specific force in body axes [m/s2].
    joint_angle, joint_rate, drive_angle, drive_rate, motor_torque : ndarray, shape (n, joint)
        Angles [rad] and the drive's torques, output side [N m].
    section_forces : ndarray, shape (n, link, 2, 6)
        At both ends of each link [N, N m].
    """

    arm: Any
    time: Floats
    points: tuple[str, ...]
    joints: tuple[str, ...]
    position: Floats
    velocity: Floats
    orientation: Floats
    angular_rate: Floats
    acceleration: Floats
    joint_angle: Floats
    joint_rate: Floats
    drive_angle: Floats
    drive_rate: Floats
    motor_torque: Floats
    section_forces: Floats


def is_input(record: Record, signal: Signal) -> bool:
    """Whether a signal of a static record says what the arm was told, not how it answered."""
    return signal.name in record.drive or signal.quantity in INPUTS


def solve_poses(arm: Arm, record: Record) -> PoseSequence:
    """The equilibrium of every pose of a static record.

    Parameters
    ----------
    arm : Arm
        The model, with what the record says it carried.
    record : Record
        Its poses.

    Raises
    ------
    InvalidParameter
        If a drive does not say where a joint stands in a pose.
    NotConverged
        If a pose has no stable equilibrium.
    """
    from scipy.spatial.transform import Rotation

    from flexarm.record.against_arm import weighed
    from flexarm.statics import static

    at_link = {s.joint for name in record.drive if (s := record.signals[name]).side == "output" and s.joint}
    found = []
    true = {
        name: effects_of(arm, signal).true(signal.values)
        for name, signal in record.signals.items()
        if is_input(record, signal)
    }
    for pose in record.poses:
        angles, forces, masses = _inputs(record, pose, true)
        loaded = weighed(arm, masses)
        found.append(static(loaded, joints={**record.joints, **angles}, forces=forces, at_link=at_link))
    position = np.array([s.position for s in found])
    turns = Rotation.from_matrix([np.eye(3), *(R for s in found for R in s.rotation)])[1:]  # may be none
    link_angle = np.array([s.link_angle for s in found])
    return PoseSequence(
        arm,
        np.arange(float(len(found))),
        found[0].points,
        found[0].joints,
        position,
        np.zeros_like(position),
        turns.as_quat().reshape(*position.shape[:2], 4),
        np.zeros_like(position),
        -np.asarray(turns.inv().apply(np.asarray(arm.gravity))).reshape(position.shape),
        link_angle,
        np.zeros_like(link_angle),
        np.array([s.drive_angle for s in found]),
        np.zeros_like(link_angle),
        np.array([s.joint_torque for s in found]),
        np.array([s.section_forces for s in found]),
    )


def pose_numbers(record: Record) -> dict[str, Floats]:
    """The number of the pose of every row, by signal."""
    number = {pose: float(i) for i, pose in enumerate(record.poses)}
    return {
        name: np.array([number[str(pose)] for pose in signal.pose])
        if signal.pose is not None
        else signal.time
        for name, signal in record.signals.items()
    }


def _inputs(
    record: Record, pose: str, true: Mapping[str, Floats]
) -> tuple[dict[str, float], dict[str, Floats], dict[str, float]]:
    """Joint angles, forces and payload masses of one pose, from the true values of their signals."""
    angles: dict[str, float] = {}
    forces: dict[str, Floats] = {}
    masses: dict[str, float] = {}
    for signal in record.signals.values():
        if signal.pose is None or not is_input(record, signal):
            continue
        values = true[signal.name]
        rows = values[(signal.pose == pose) & np.isfinite(values).all(axis=1)]
        if not len(rows):
            if signal.name in record.drive:
                raise InvalidParameter(
                    f"holds no value for the pose {pose!r}; a drive needs one for every pose of the record",
                    where=f"signals.{signal.name}",
                )
            continue
        mean = rows.mean(axis=0)
        if signal.quantity == "force" and signal.point is not None:
            forces.setdefault(signal.point, np.zeros(3))[columns(signal.axes)] += mean
        elif signal.quantity == "payload_mass" and signal.payload is not None:
            masses[signal.payload] = float(mean[0])
        elif signal.joint is not None:
            angles[signal.joint] = float(mean[0])
    return angles, forces, masses
