"""Motion of the rigid arm along the drives of a record, without dynamics: what hypotheses are screened by.

Kinematics take milliseconds where a simulation takes seconds, and cannot diverge. Positions, attitudes and
rates of a rigid arm tell a wrong unit or sign of a drive from the right one; torques, strains and deflections
need the forces, and are left out.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.kinematics import link_pose
from flexarm.arrays import Floats
from flexarm.comparison.simulated_record import SimulatedRecord, pair_record
from flexarm.drive.from_record import true_time
from flexarm.measurement.effects_of import effects_of
from flexarm.record import Record, Signal
from flexarm.simulation.energies import NAMES, Energies
from flexarm.simulation.simulation import Simulation

KINEMATIC = (
    *("position", "orientation", "inclination", "joint_angle", "joint_rate", "angular_rate", "acceleration"),
)
"""Quantities that a rigid arm shows without its forces."""
SPACING, MOST = 0.02, 2000
"""Time between instants [s], and the most of them [1]: joints move little in a fiftieth of a second."""
ROWS = 400
"""Most readings of a signal that are looked at [1]."""


def rigid_record(arm: Arm, record: Record) -> SimulatedRecord | None:
    """Return a record of motion beside the rigid arm; None if no signal but the drives is kinematic.

    Raise InvalidParameter if the record does not say how it drives the arm.
    """
    drives = {name: record.signals[name] for name in record.drive}
    shown = {name: _thinned(signal) for name, signal in kinematic_signals(record).items()}
    if record.kind == "static" or arm.gears or not shown:
        return None
    run = rigid_motion(record.applied_to(arm), *_driven(arm, record))
    found = pair_record(run, record.replace(signals={**drives, **shown}))
    return found if found.evidence else None


def kinematic_signals(record: Record) -> dict[str, Signal]:
    """Return the signals that a rigid arm shows, without the drives."""
    return {
        name: signal
        for name, signal in record.signals.items()
        if name not in record.drive and signal.quantity in KINEMATIC
    }


def _thinned(signal: Signal) -> Signal:
    """Return a signal with at most `ROWS` readings."""
    every = slice(None, None, -(-len(signal) // ROWS) or 1)
    return signal.replace(time=signal.time[every], values=signal.values[every])


def _driven(arm: Arm, record: Record) -> tuple[Floats, dict[str, Floats]]:
    """Return instants and the angles of the joints there, as the drives say, not smoothed."""
    samples = {}
    for signal in (record.signals[name] for name in record.drive):
        true = effects_of(arm, signal).true(signal.values)[:, 0]
        known = np.isfinite(true)
        if signal.joint is not None and known.any():
            samples[signal.joint] = true_time(signal, arm, float(signal.time[0]))[known], true[known]
    first = min((float(t[0]) for t, _ in samples.values()), default=0.0)
    last = max((float(t[-1]) for t, _ in samples.values()), default=record.duration)
    time = np.linspace(first, last, int(np.clip((last - first) / SPACING, 10, MOST)))
    rest = {name: np.full(len(time), value) for name, value in record.joints.items()}
    return time, rest | {joint: np.interp(time, *each) for joint, each in samples.items()}


def rigid_motion(arm: Arm, time: Floats, angles: Mapping[str, Floats]) -> Simulation:
    """Return the motion of the rigid arm, its joints at some angles [rad, m] or 0; torques are unknown."""
    still = np.zeros(len(time))
    values = {joint.name: angles.get(joint.name, still) for joint in arm.joints}
    angle = np.column_stack([values[joint.name] for joint in arm.joints])
    poses = [link_pose(arm, point.link, values) for point in arm.points]
    rotation = [np.broadcast_to(pose.R, (len(time), 3, 3)) for pose in poses]
    position = np.stack(
        [
            np.broadcast_to(pose.of_point(np.asarray(point.position)), (len(time), 3))
            for pose, point in zip(poses, arm.points, strict=True)
        ]
        or [np.empty((len(time), 0))],
        axis=1,
    ).reshape(len(time), len(poses), 3)
    rate, unknown = np.asarray(np.gradient(angle, time, axis=0)), np.full(angle.shape, np.nan)
    return Simulation(
        arm,
        time,
        position,
        np.asarray(np.gradient(position, time, axis=0)),
        angle,
        rate,
        angle,
        rate,
        unknown,
        unknown,
        Energies(*[still * np.nan] * len(NAMES)),
        orientation=_quaternions(rotation, len(time)),
        angular_rate=_angular_rates(rotation, time),
    )


def _quaternions(rotation: list[Floats], count: int) -> Floats:
    """Return attitudes of the points, shape (n, point, 4), in the order x, y, z, w."""
    from scipy.spatial.transform import Rotation

    found = [Rotation.from_matrix(each).as_quat() for each in rotation]
    return np.stack(found, axis=1) if found else np.empty((count, 0, 4))


def _angular_rates(rotation: list[Floats], time: Floats) -> Floats:
    """Return rates in the body's axes, from one instant to the next, shape (n, point, 3)."""
    from scipy.spatial.transform import Rotation

    found = [np.zeros((len(time), 3)) for _ in rotation]
    for rate, each in zip(found, rotation, strict=True):
        turns = Rotation.from_matrix(np.swapaxes(each[:-1], 1, 2) @ each[1:]).as_rotvec()
        rate[:-1] = turns / np.diff(time)[:, None]
        rate[-1] = rate[-2]
    return np.stack(found, axis=1) if found else np.empty((len(time), 0, 3))
