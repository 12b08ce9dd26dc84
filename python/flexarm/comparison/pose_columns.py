"""Linear model of the gaps of poses, for a sensor in order.

A nominal model that lacks something misses smoothly in the pose. To first order the gap of a point at p is

    sum over base axes a of (d_a a + r_a a x p)     shift and rotation of its frame or of the base      (1)
    + z (p - p_rigid)                               links softer, or loads heavier, than stated         (2)
    + sum over joints J_j (o_j + s_j q_j + k_j T_j) zeros, scales and springs of joints                 (3)

with the rigid Jacobian J_j, the angle q_j and the torque T_j of each joint. Channels of other quantities have
J_j = 1, each with coefficients of its own, and the predictions of all channels instead of (2). Each column is
multiplied by the size of its coefficient that few machines worth a diagnosis exceed.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexarm.arm.kinematics import link_pose, point_jacobian
from flexarm.arm.sizes import reach
from flexarm.arrays import Floats
from flexarm.comparison.gap import drive_angles
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.sampling import sample
from flexarm.measurement.tracker import base_position
from flexarm.record import Signal

TURN = 0.05
"""Rotation of a frame, and of a joint by each part of (3) where that is greatest [rad]: three degrees."""
SHIFT = 0.02
"""Shift of a frame over the reach of the arm."""
ANGLES = ("joint_angle", "inclination", "orientation")
"""Quantities of which a model misses by `TURN`; of others that are no places it may miss all it says."""


def pose_columns(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> Floats:
    """Return columns for every row of a signal, shape (n, channels, k)."""
    of = _of_point if signal.quantity == "position" else _of_channels
    found = list(of(simulated, signal, placement))
    return np.stack([column for column in found if np.any(column)] or found[:1], axis=2)


def _of_point(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> Iterator[Floats]:
    """Yield (1) to (3) of a point, along the measured axes."""
    free = 10.0  # reaches or radians that a frame may be off by of which nothing is stated: as good as any
    known = 5.0  # stated sigmas of a registration that it may be off by
    arm, instants, axes = (
        simulated.arm,
        simulated.instants(signal, placement),
        simulated.axes(signal, placement),
    )
    frame, size, place = simulated.record.frame_of(signal), reach(arm), arm.point(signal.point)
    angles = drive_angles(simulated, instants)
    there = base_position(simulated.simulation, signal, instants)
    yield (there - link_pose(arm, place.link, angles).of_point(np.asarray(place.position))) @ axes  # eq. (2)
    shift = free * size if frame.unknown else max(SHIFT * size, known * frame.translation)
    turn = free if frame.unknown else max(TURN, known * frame.rotation)
    for axis in np.eye(3):
        yield shift * np.broadcast_to(axis @ axes, (len(signal), axes.shape[1]))  # eq. (1)
        yield turn * np.cross(axis, there) @ axes
    for joint in arm.moving_joints:
        most = TURN * (size if joint.type == "prismatic" else 1.0)
        turned = most * point_jacobian(arm, joint.name, str(signal.point), angles) @ axes
        yield turned  # eq. (3)
        for state in _states(simulated, joint.name, instants):
            yield state[:, None] * turned


def _of_channels(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> Iterator[Floats]:
    """Yield the columns of other quantities."""
    predicted = simulated.predicted(signal, placement, hold=True)
    channels = simulated.residual(signal, placement, hold=True).shape[1]
    size = TURN if signal.quantity in ANGLES else float(np.max(np.abs(predicted), initial=0.0))
    states = [np.ones(len(signal)), *map(_over_greatest, predicted.T)]
    for joint in simulated.arm.moving_joints:
        states += _states(simulated, joint.name, simulated.instants(signal, placement))
    for state in states:
        for channel in np.eye(channels):
            yield size * np.outer(state, channel)


def _states(simulated: SimulatedRecord, joint: str, instants: Floats) -> list[Floats]:
    """Return angle and torque of a joint over their greatest values."""
    run = simulated.simulation
    torque = sample(run.time, np.asarray(run.motor_torque)[:, run.joints.index(joint)], instants)
    return [_over_greatest(drive_angles(simulated, instants)[joint]), _over_greatest(torque)]


def _over_greatest(values: Floats) -> Floats:
    greatest = float(np.max(np.abs(values), initial=0.0))
    return np.asarray(values / greatest if greatest > 0 else values)
