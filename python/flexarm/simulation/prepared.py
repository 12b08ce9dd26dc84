"""Preparation of a run: arm, drive of its joints and options, checked, for the core."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, inf

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.drive import Drive
from flexarm.drive.lag import as_followed
from flexarm.errors import InvalidParameter
from flexarm.record import Record
from flexarm.record.step_limit import check_step_count


@dataclass(frozen=True)
class PreparedRun:
    """Input of the core."""

    arm: Arm
    told: Drive
    drive: Drive
    """The drive, and how motors follow it."""
    options: _core.TransientOptions

    @property
    def kinds(self) -> dict[str, _core.DriveKind]:
        """Prescribed quantity of each driven joint."""
        return {name: joint.kind for name, joint in self.drive.joints.items()}

    @property
    def prescribed(self) -> dict[str, _core.DriveKind]:
        """Joints whose angle is prescribed from the start; motors driven by torque are held until then."""
        return {name: joint.kind for name, joint in self.drive.joints.items() if joint.side != "torque"}

    @property
    def led(self) -> int:
        """Steps before the drive's start, which are not part of the result."""
        return round((self.drive.start - self.options.start) / self.options.step)

    @property
    def motions(self) -> list[_core.PiecewisePolynomial]:
        """Motion of every joint, in the order of the arm's."""
        return motions(self.arm, self.drive, self.last)

    @property
    def last(self) -> float:
        """Instant of the last step of a run that ends with its drive [s]; the end of the drive of others."""
        start, end, step = self.options.start, self.options.end, self.options.step
        return start + ceil((end - start) / step - 1e-9) * step if end <= self.drive.end else self.drive.end


def prepared(
    arm: Arm, drive: Drive, step: float, alpha: float, end: float | None, forces: bool, rotations: bool
) -> PreparedRun:
    """Return the run, checked."""
    _core.check_step(float(step))
    if not isinstance(drive, Drive):
        raise InvalidParameter(
            f"must be a Drive, such as Drive.from_samples gives, or a Record, got {type(drive).__name__}",
            where="drive",
        )
    moving = [joint.name for joint in arm.moving_joints]
    for name in drive.joints:
        if name not in moving:
            raise InvalidParameter(
                f"the drive moves {name!r}, which is no moving joint; there are {', '.join(moving)}"
            )
    told, drive = drive, as_followed(drive, arm)
    options = _core.TransientOptions()
    options.step, options.alpha = float(step), float(alpha)
    led = ceil(drive.lead / step) if drive.lead > 0 else 0
    options.start = drive.start - led * step if led else drive.start
    options.end = drive.end if end is None else float(end)
    check_step_count(options.start, options.end, options.step)
    options.record_forces, options.record_rotations = forces, rotations
    return PreparedRun(arm, told, drive, options)


def prepared_along(
    arm: Arm,
    drive: Drive | Record,
    step: float,
    alpha: float,
    end: float | None,
    forces: bool,
    rotations: bool,
) -> PreparedRun:
    """Return the run along a drive, or along that of a record with the payloads carried there."""
    if isinstance(drive, Record):
        carried = drive.applied_to(arm)
        return prepared(carried, Drive.from_record(drive, carried), step, alpha, end, forces, rotations)
    return prepared(arm, drive, step, alpha, end, forces, rotations)


def coordinates(name: str) -> _core.Dimension:
    """Return the coordinates of a run in the core."""
    known = {
        "auto": _core.Dimension.automatic,
        "plane": _core.Dimension.plane,
        "space": _core.Dimension.space,
    }
    if name not in known:
        raise InvalidParameter(f"must be one of {', '.join(known)}, got {name!r}", where="dimension")
    return known[name]


def motions(arm: Arm, drive: Drive, last: float = -inf) -> list[_core.PiecewisePolynomial]:
    """Return the motion of every joint; the core does not read those of joints that nothing drives.

    Joints whose motion ends with the drive go on to the `last` instant, where a stop would jump in the rate.
    """
    found = [_core.PiecewisePolynomial.constant(0.0)] * len(arm.joints)
    for k, joint in enumerate(arm.joints):
        if joint.name in drive.joints:
            own = drive.joints[joint.name]
            if drive.end <= own.breaks[-1] < last and own.side != "command":
                own = replace(own, breaks=np.append(own.breaks[:-1], last))
            found[k] = own.polynomial()
    return found
