"""Conditions of records as nuisance parameters: the initial vibration of the arm, and the tilt of its base.

**Initial vibration.** A record that begins in motion does not tell what the arm did before. Free vibrations
are left of it, and jerks of the drives before the first sample leave the same (eq. (2) of `drive.lead_in`). A
jerk half a period long excites a mode; one that ends with the lead-in and one that ends a quarter of a period
earlier excite it in both phases. The residual changes in proportion to the unknown strength x_k of each jerk,

    r = r_0 + sum_k (r(jerk_k) - r_0)/h x_k                                                           (1)

Of the jerks of all drives for the lowest modes those are kept whose responses are linearly independent.

**Tilt of the base.** Records may state how the base stood, with a sigma. The residual is linear about the
stated tilt of each record and axis,

    r = r_0 + (r(tilt + sigma) - r(tilt - sigma))/(2 sigma) x                                         (2)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.diagnosis.policy import NOISE_MODEL
from flexarm.drive import Drive
from flexarm.drive.lead_in import LEAD
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.record import Record

if TYPE_CHECKING:
    from flexarm.diagnosis.problem import Problem


@dataclass(frozen=True)
class InitialCondition:
    """A jerk of a joint's drive before a record."""

    record: str
    joint: str
    """Whose."""
    before: float
    width: float
    """Time from its end to the first sample, and its duration [s]."""
    unit: str
    """Unit of its height."""

    @property
    def key(self) -> str:
        """Among the parameters of a model, which it is none of."""
        return f"records.{self.record}.start.{self.joint} {self.width:.3g} s {self.before:.3g} s"


def find_initial_conditions(problem: Problem, arm: Arm) -> tuple[InitialCondition, ...]:
    """Return initial conditions of records that begin in motion, for the modes of a model."""
    found: list[InitialCondition] = []
    for name, record in problem.records.items():
        if record.initial != "moving" or record.kind == "static":
            continue
        drive = problem.simulations.drive(name, record.applied_to(arm))
        if drive.lead > 0:
            found += _independent(problem, arm, _possible(name, record.applied_to(arm), drive))
    return tuple(found)


def initial_condition_jacobian(
    problem: Problem, arm: Arm, initial_conditions: Sequence[InitialCondition]
) -> Floats:
    """Columns of (1), shape (n, len(starts)); zero for records that are not observed."""
    found = np.zeros((len(problem), len(initial_conditions)))
    mine = [k for k, start in enumerate(initial_conditions) if start.record in problem.records]
    finer = problem.with_step(problem.step / NOISE_MODEL.jerk_finer)
    before = finer.residual(arm) if mine else np.zeros(0)
    for k in mine:
        after = before.copy()
        finer.write_residual(
            after,
            initial_conditions[k].record,
            finer.simulations.with_pulse(initial_conditions[k], arm, NOISE_MODEL.jerk_step),
        )
        found[:, k] = (after - before) / NOISE_MODEL.jerk_step  # eq. (1)
    return found


def _possible(name: str, arm: Arm, drive: Drive) -> list[InitialCondition]:
    """Jerks of every drive for every mode about the pose in which the record begins."""
    from flexarm.modal import modes

    pose = {joint: float(motion(drive.start)) for joint, motion in drive.joints.items()}
    try:
        frequencies = modes(arm, joints={**drive.rest, **pose}, count=NOISE_MODEL.start_modes).frequency_hz
    except (InvalidParameter, NotConverged):
        return []
    return [
        InitialCondition(name, joint, before, width, "m" if arm.joint(joint).type == "prismatic" else "rad")
        for width in np.minimum(0.5 / frequencies, LEAD / 2).tolist()
        for joint in drive.joints
        for before in (0.0, width / 2)
    ]


def _independent(
    problem: Problem, arm: Arm, initial_conditions: Sequence[InitialCondition]
) -> list[InitialCondition]:
    """Return linearly independent ones, by elimination with column pivoting."""
    from scipy.linalg import qr

    if not initial_conditions:
        return []
    columns = NOISE_MODEL.jerk * initial_condition_jacobian(problem, arm, initial_conditions)
    _, R, order = qr(columns, mode="economic", pivoting=True)
    own = np.abs(np.diag(R))
    kept = order[: int(np.sum((own > NOISE_MODEL.jerk_seen) & (own > NOISE_MODEL.jerk_own * own[0])))]
    return [initial_conditions[k] for k in sorted(kept)]


@dataclass(frozen=True)
class UncertainTilt:
    """One component of a stated tilt."""

    record: str
    """Whose."""
    axis: str
    """About which."""
    stated: float
    sigma: float
    """As the record has it [rad]."""

    @property
    def key(self) -> str:
        """Among the parameters of a model, which it is none of."""
        return f"records.{self.record}.base.tilt.{self.axis}"


def uncertain_tilts(records: Mapping[str, Record]) -> tuple[UncertainTilt, ...]:
    """Return the components of all tilts that are stated with a sigma."""
    return tuple(
        UncertainTilt(name, axis, stated, record.base.sigma)
        for name, record in records.items()
        if record.base is not None and record.base.sigma > 0
        for axis, stated in zip("xy", record.base.tilt, strict=True)
    )


def tilt_jacobian(problem: Problem, arm: Arm, tilts: Sequence[UncertainTilt]) -> Floats:
    """Return columns of (2), shape (n, len(tilts)); zero for records that are not observed."""
    found = np.zeros((len(problem), len(tilts)))
    for k, tilt in enumerate(tilts):
        if tilt.record not in problem.records:
            continue
        ends = np.zeros((2, len(problem)))
        for end, turn in zip(ends, (tilt.sigma, -tilt.sigma), strict=True):
            problem.write_residual(end, tilt.record, problem.simulations.tilted(tilt, arm, turn))
        found[:, k] = (ends[0] - ends[1]) / (2 * tilt.sigma)  # eq. (2)
    return found
