r"""The gap of positions as equivalent small rotations of the joints.

At every instant, with the points' gap y (n_y,), the rigid Jacobian J (n_y, joint) and a rotation d of each
joint, on top of the angle that its drive has,

    y = J d + e,    d_j ~ N(0, s_j^2),    e ~ N(0, sigma^2)                                          (1)
    C = (J^T J/sigma^2 + diag(1/s^2))^-1,    d = C J^T y/sigma^2                                      (2)

The sizes s_j and sigma of (1) are those that make the data most likely (empirical Bayes), found by

    s_j^2 = mean over instants of d_j^2 + C_jj,    sigma^2 = mean of (y - J d)^2 + tr(J C J^T)/n_y      (3)

repeatedly [Dempster1977], from rotations that would each show the whole gap. A joint whose rotation the data
do not need shrinks to nothing; joints that move all points alike in all poses share a gap alike, and what one
of them could explain alone says that they cannot be told apart. What each rotation follows hints at what is
missing at that joint (`HINTS`). Joints that slide shift instead of turning.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.comparison.gap import drive_angles
from flexarm.measurement.kinematics import point_jacobian
from flexarm.residual_analysis.covariates import CovariateDependence, covariate_dependence
from flexarm.residual_analysis.motion_states import JointStates, covariate_groups, joined_states, joint_states
from flexarm.wording import with_unit

ITERATIONS = 60
NAMED = 0.02
"""Share of the squared gap from which on a table says what a rotation follows."""
SAME = 1e-6
"""Instants closer than this are one [s]."""
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
    """Equivalent rotation of one joint.

    Attributes
    ----------
    joint, unit : str
        Its name; rad, or m for one that slides.
    angle, std : ndarray, shape (n,)
        d of (2) and 1 sigma.
    alone : float
        Share of the squared gap that this joint's rotation explains if no other joint turns.
    share : float
        What it holds of the squared gap beside the others, sum of (J_j d_j)^T y.
    follows : CovariateDependence
        What it follows: of its own torque, rate, angle, acceleration, and time.
    """

    joint: str
    unit: str
    angle: Floats
    std: Floats
    alone: float
    share: float
    follows: CovariateDependence

    @property
    def rms(self) -> float:
        """Of the angle."""
        return float(np.sqrt(np.mean(self.angle**2)))

    @property
    def hint(self) -> str:
        """What would do that."""
        return HINTS.get(self.follows.best, "")


@dataclass(frozen=True, eq=False)
class JointRotations:
    """Equivalent rotations of all joints.

    Attributes
    ----------
    joints : tuple of JointRotation
        Largest share first.
    explained : float
        Share of the squared gap that all rotations explain together.
    time : ndarray, shape (n,)
        Instants [s].
    states : tuple of JointStates
        Of every joint, in the same order.
    """

    joints: tuple[JointRotation, ...]
    explained: float
    time: Floats
    states: tuple[JointStates, ...]

    def summary(self) -> str:
        """A table that a person reads."""
        head = f"{'joint':<14}{'rms':>12}{'alone':>8}{'share':>8}   follows"
        lines = [f"as rotations of the joints, which explain {100 * self.explained:.0f} %", head]
        for each in self.joints:
            follows = f"   {each.follows.best} ({100 * each.follows.share:.0f} %), as {each.hint} would"
            lines.append(
                f"{each.joint:<14}{with_unit(each.rms, each.unit):>12}{100 * each.alone:7.0f}%"
                f"{100 * each.share:7.0f}%{follows if each.share >= NAMED else ''}"
            )
        return "\n".join(lines)


@dataclass(frozen=True, eq=False)
class _Rows:
    """Channels of all positions: instant, Jacobian (m, joint) and gap (m,)."""

    instant: NDArray[np.intp]
    jacobian: Floats
    gap: Floats
    noise: float
    time: Floats
    record: NDArray[np.intp]
    states: tuple[JointStates, ...]


def joint_rotations(pairs: Mapping[str, AlignedRecord]) -> JointRotations | None:
    """The gap of the positions of all records by (1); None where no position is measured, or none differs."""
    arm = next(iter(pairs.values())).simulated.arm
    joints = [joint.name for joint in arm.moving_joints]
    pieces = [rows for pair in pairs.values() if (rows := _rows(pair, joints)) is not None]
    rows = _stacked(pieces) if pieces else None
    if rows is None or not np.any(rows.gap):
        return None
    angle, variance = _rotations(rows)
    seen = rows.jacobian * angle[rows.instant]
    total = float(rows.gap @ rows.gap)
    left = rows.gap - seen.sum(axis=1)
    found = [
        JointRotation(
            joint,
            "m" if arm.joint(joint).type == "prismatic" else "rad",
            angle[:, j],
            np.sqrt(variance[:, j]),
            _alone(rows, j) / total,
            float(seen[:, j] @ rows.gap) / total,
            covariate_dependence(covariate_groups([rows.states[j]], rows.time, rows.record), angle[:, [j]]),
        )
        for j, joint in enumerate(joints)
    ]
    order = sorted(range(len(joints)), key=lambda j: -found[j].share)
    return JointRotations(
        tuple(found[j] for j in order),
        1 - float(left @ left) / total,
        rows.time,
        tuple(rows.states[j] for j in order),
    )


def _rows(pair: AlignedRecord, joints: Sequence[str]) -> _Rows | None:
    """Channels of one record."""
    subject, placement = pair.simulated, pair.aligned.placement
    instants, jacobians, gaps, noise = [], [], [], []
    for signal in subject.evidence.values():
        if signal.quantity != "position" or signal.point is None:
            continue
        when, residual = subject.instants(signal, placement), subject.residual(signal, placement)
        keep = np.isfinite(residual).all(axis=1) & ~subject.outliers(signal, residual)
        when, residual = when[keep], residual[keep]
        axes = subject.axes(signal, placement)
        angles = drive_angles(subject, when)
        turn = [point_jacobian(subject.arm, joint, signal.point, angles) @ axes for joint in joints]
        jacobians.append(np.stack(turn, axis=2).reshape(-1, len(joints)))
        gaps.append(residual.ravel())
        instants.append(np.repeat(when, residual.shape[1]))
        noise.append(np.broadcast_to(subject.noise(signal), residual.shape).ravel())
    if not gaps or not sum(len(gap) for gap in gaps):
        return None
    time, number = np.unique(np.round(np.concatenate(instants) / SAME), return_inverse=True)
    time = time * SAME
    return _Rows(
        number.ravel(),
        np.concatenate(jacobians),
        np.concatenate(gaps),
        float(np.sqrt(np.mean(np.concatenate(noise) ** 2))),
        time,
        np.zeros(len(time), dtype=np.intp),
        tuple(joint_states(pair, joint, time) for joint in joints),
    )


def _stacked(pieces: Sequence[_Rows]) -> _Rows:
    """All records, one after the other."""
    first = np.cumsum([0, *(len(each.time) for each in pieces)])
    return _Rows(
        np.concatenate([each.instant + start for each, start in zip(pieces, first, strict=False)]),
        np.concatenate([each.jacobian for each in pieces]),
        np.concatenate([each.gap for each in pieces]),
        float(np.sqrt(np.mean([each.noise**2 for each in pieces]))),
        np.concatenate([each.time for each in pieces]),
        np.repeat(np.arange(len(pieces)), [len(each.time) for each in pieces]),
        tuple(joined_states([each.states[j] for each in pieces]) for j in range(len(pieces[0].states))),
    )


def _rotations(rows: _Rows) -> tuple[Floats, Floats]:
    """d and C_jj at every instant, shapes (n, joint), by (2) and (3)."""
    n, joints = len(rows.time), rows.jacobian.shape[1]
    normal, right = np.zeros((n, joints, joints)), np.zeros((n, joints))
    np.add.at(normal, rows.instant, rows.jacobian[:, :, None] * rows.jacobian[:, None, :])
    np.add.at(right, rows.instant, rows.jacobian * rows.gap[:, None])
    lever = np.sqrt(np.mean(rows.jacobian**2, axis=0))
    size = np.where(lever > 0, np.sqrt(np.mean(rows.gap**2)) / np.where(lever > 0, lever, 1.0), 0.0)
    least = max(rows.noise, 1e-6 * float(np.sqrt(np.mean(rows.gap**2)))) ** 2
    square, variance = size**2, max(least, 0.01 * float(np.mean(rows.gap**2)))
    for _ in range(ITERATIONS):
        # C = s (1 + s N s/sigma^2)^-1 s, N = J^T J: a joint whose s vanishes needs no infinite weight
        s = np.sqrt(square)
        inner = np.linalg.inv(np.eye(joints) + s[:, None] * normal * s / variance)
        covariance = s[:, None] * inner * s
        angle = np.einsum("nij,nj->ni", covariance, right) / variance  # eq. (2)
        left = rows.gap - np.sum(rows.jacobian * angle[rows.instant], axis=1)
        spread = np.einsum("nij,nji->", normal, covariance)
        square = np.mean(angle**2 + np.einsum("nii->ni", covariance), axis=0)  # eq. (3)
        variance = max(least, float(left @ left + spread) / len(rows.gap))
    return angle, np.einsum("nii->ni", covariance)


def _alone(rows: _Rows, j: int) -> float:
    """Squares that the best rotation of one joint at every instant takes away."""
    column, n = rows.jacobian[:, j], len(rows.time)
    normal = np.bincount(rows.instant, column**2, n)
    right = np.bincount(rows.instant, column * rows.gap, n)
    return float(np.sum(right[normal > 0] ** 2 / normal[normal > 0]))
