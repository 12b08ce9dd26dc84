r"""Equivalent rotations: the residual of positions as small rotations of the joints.

At every instant, with the points' residual y (n_y,), the rigid Jacobian J (n_y, joint) and a rotation d of
each joint, on top of the angle that its drive has,

    y = J d + e,    d_j ~ N(0, s_j^2),    e ~ N(0, sigma^2)                                          (1)
    C = (J^T J/sigma^2 + diag(1/s^2))^-1,    d = C J^T y/sigma^2                                      (2)

The sizes s_j and sigma maximise the likelihood of (1) (empirical Bayes). Expectation maximisation
[Dempster1977] repeats

    s_j^2 = mean over instants of d_j^2 + C_jj,    sigma^2 = mean of (y - J d)^2 + tr(J C J^T)/n_y      (3)

from rotations that would each show the whole residual. A rotation that the data do not need shrinks to
nothing. Joints that move all points alike in all poses share a residual alike; the share that each explains
alone shows that they cannot be told apart. The covariate that a rotation follows hints at what is missing at
its joint (`HINTS`). Prismatic joints shift instead of turning.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.kinematics import point_jacobian
from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.comparison.gap import drive_angles
from flexarm.residual_analysis.motion_states import (
    CovariateDependence,
    JointStates,
    covariate_dependence,
    covariate_groups,
    joined_states,
    joint_states,
)
from flexarm.residual_analysis.policy import POLICY
from flexarm.wording import with_unit

HINTS = {
    "a constant": "an offset",
    "sign of torque": "backlash",
    "the record": "an offset that changed",
    "sense of motion": "friction or hysteresis",
    "angle": "a scale, an eccentricity or gravity",
    "rate": "viscous friction, damping or a delay",
    "torque": "compliance",
    "acceleration": "inertia",
    "angle, by sense of motion": "friction or hysteresis",
    "torque, by sense of motion": "hysteresis",
    "time": "drift",
}


@dataclass(frozen=True, eq=False)
class JointRotation:
    """Equivalent rotation of one joint."""

    joint: str
    unit: str
    """Its name; rad, or m for a prismatic joint."""
    angle: Floats
    std: Floats
    """d of (2) and 1 sigma. Shape (n,)."""
    alone: float
    """Share of the squared residual that this joint's rotation explains if no other joint turns."""
    share: float
    """Share of the squared residual that it explains with the others, sum of (J_j d_j)^T y."""
    dependence: CovariateDependence
    """On its own torque, rate, angle, acceleration, and time."""

    @property
    def rms(self) -> float:
        """Root mean square of the angle."""
        return float(np.sqrt(np.mean(self.angle**2)))

    @property
    def relevant(self) -> bool:
        """Return True if the joint holds a listed share of the gap."""
        return self.share >= POLICY.listed_share

    @property
    def hint(self) -> str:
        """Effect that shows such a dependence."""
        return HINTS.get(self.dependence.best, "")


@dataclass(frozen=True, eq=False)
class JointRotations:
    """Equivalent rotations of all joints."""

    joints: tuple[JointRotation, ...]
    """Largest share first."""
    explained: float
    """Share of the squared residual that all rotations explain together."""
    time: Floats
    """Instants [s]. Shape (n,)."""
    states: tuple[JointStates, ...]
    """Of every joint, in the same order."""

    def summary(self) -> str:
        """Return a table that a person reads."""
        lines = [
            f"as rotations of the joints, which explain {100 * self.explained:.0f} %",
            f"{'joint':<14}{'rms':>12}{'alone':>8}{'share':>8}   follows",
        ]
        for each in self.joints:
            said = f"   {each.dependence.best} ({100 * each.dependence.share:.0f} %), as {each.hint} would"
            lines.append(
                f"{each.joint:<14}{with_unit(each.rms, each.unit):>12}{100 * each.alone:7.0f}%"
                f"{100 * each.share:7.0f}%{said if each.relevant else ''}"
            )
        return "\n".join(lines)


@dataclass(frozen=True, eq=False)
class _Channels:
    """Channels of all positions: number of the instant, Jacobian (m, joint) and residual (m,); 1 sigma."""

    instant: NDArray[np.intp]
    jacobian: Floats
    residual: Floats
    noise: float
    time: Floats
    record: NDArray[np.intp]
    states: tuple[JointStates, ...]


def joint_rotations(pairs: Mapping[str, AlignedRecord]) -> JointRotations | None:
    """Return the equivalent rotations (1) over all records; None without positions or without residual."""
    arm = next(iter(pairs.values())).simulated.arm
    joints = [joint.name for joint in arm.moving_joints]
    rows = _channels(pairs, joints)
    if rows is None or not np.any(rows.residual):
        return None
    angle, variance = _rotations(rows)
    shown = rows.jacobian * angle[rows.instant]
    total = float(rows.residual @ rows.residual)
    left = rows.residual - shown.sum(axis=1)
    found = []
    for j, joint in enumerate(joints):
        # the best rotation of this joint alone at every instant
        normal = np.bincount(rows.instant, rows.jacobian[:, j] ** 2, len(rows.time))
        right = np.bincount(rows.instant, rows.jacobian[:, j] * rows.residual, len(rows.time))
        found.append(
            JointRotation(
                joint,
                "m" if arm.joint(joint).type == "prismatic" else "rad",
                angle[:, j],
                np.sqrt(variance[:, j]),
                float(np.sum(right[normal > 0] ** 2 / normal[normal > 0])) / total,
                float(shown[:, j] @ rows.residual) / total,
                covariate_dependence(
                    covariate_groups([rows.states[j]], rows.time, rows.record), angle[:, [j]]
                ),
            )
        )
    order = sorted(range(len(joints)), key=lambda j: -found[j].share)
    return JointRotations(
        tuple(found[j] for j in order),
        1 - float(left @ left) / total,
        rows.time,
        tuple(rows.states[j] for j in order),
    )


def _channels(pairs: Mapping[str, AlignedRecord], joints: list[str]) -> _Channels | None:
    """Return the channels of all records, one after the other; instants closer than 1e-6 s are one."""
    same = 1e-6
    instants, jacobians, residuals, noise, states = [], [], [], [], []
    times: list[Floats] = []
    for pair in pairs.values():
        simulated, placement = pair.simulated, pair.aligned.placement
        when_of, noise_of = [], []
        for signal in simulated.evidence.values():
            if signal.quantity != "position" or signal.point is None:
                continue
            when, residual = simulated.instants(signal, placement), simulated.residual(signal, placement)
            keep = np.isfinite(residual).all(axis=1) & ~simulated.outliers(signal, residual)
            when, residual = when[keep], residual[keep]
            axes, angles = simulated.axes(signal, placement), drive_angles(simulated, when)
            turn = [point_jacobian(simulated.arm, joint, signal.point, angles) @ axes for joint in joints]
            jacobians.append(np.stack(turn, axis=2).reshape(-1, len(joints)))
            residuals.append(residual.ravel())
            when_of.append(np.repeat(when, residual.shape[1]))
            noise_of.append(np.broadcast_to(simulated.noise(signal), residual.shape).ravel())
        if not sum(len(when) for when in when_of):
            continue
        time, number = np.unique(np.round(np.concatenate(when_of) / same), return_inverse=True)
        instants.append(number.ravel() + sum(len(each) for each in times))
        times.append(time * same)
        noise.append(float(np.mean(np.concatenate(noise_of) ** 2)))
        states.append([joint_states(pair, joint, times[-1]) for joint in joints])
    if not times:
        return None
    return _Channels(
        np.concatenate(instants),
        np.concatenate(jacobians),
        np.concatenate(residuals),
        float(np.sqrt(np.mean(noise))),
        np.concatenate(times),
        np.repeat(np.arange(len(times)), [len(time) for time in times]),
        tuple(map(joined_states, zip(*states, strict=True))),
    )


def _rotations(rows: _Channels) -> tuple[Floats, Floats]:
    """Return d and C_jj at every instant, shapes (n, joint), by (2) and (3)."""
    n, joints = len(rows.time), rows.jacobian.shape[1]
    normal, right = np.zeros((n, joints, joints)), np.zeros((n, joints))
    np.add.at(normal, rows.instant, rows.jacobian[:, :, None] * rows.jacobian[:, None, :])
    np.add.at(right, rows.instant, rows.jacobian * rows.residual[:, None])
    lever = np.sqrt(np.mean(rows.jacobian**2, axis=0))
    mean_square = float(np.mean(rows.residual**2))
    size = np.where(lever > 0, np.sqrt(mean_square) / np.where(lever > 0, lever, 1.0), 0.0)
    least = max(rows.noise, 1e-6 * float(np.sqrt(mean_square))) ** 2
    square, variance = size**2, max(least, 0.01 * mean_square)
    for _ in range(60):
        # C = s (1 + s N s/sigma^2)^-1 s, N = J^T J: a joint whose s vanishes needs no infinite weight
        s = np.sqrt(square)
        inner = np.linalg.inv(np.eye(joints) + s[:, None] * normal * s / variance)
        covariance = s[:, None] * inner * s
        angle = np.einsum("nij,nj->ni", covariance, right) / variance  # eq. (2)
        left = rows.residual - np.sum(rows.jacobian * angle[rows.instant], axis=1)
        spread = np.einsum("nij,nji->", normal, covariance)
        square = np.mean(angle**2 + np.einsum("nii->ni", covariance), axis=0)  # eq. (3)
        variance = max(least, float(left @ left + spread) / len(rows.residual))
    return angle, np.einsum("nii->ni", covariance)
