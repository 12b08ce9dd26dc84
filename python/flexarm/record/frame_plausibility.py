"""Plausibility rules of frames: positions that cannot be, registrations that tell nothing.

Position and registration are in m and rad. Millimetres taken for metres put what was measured a thousand
times too far from the base, and make a good registration none:

    place          R p + xyz of what was measured lies farther from the base than three times the reach   (1)
    registration   1 sigma of a fifth of the reach, or of 0.2 rad: such a frame is as good as unknown     (2)
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.rotation import from_rpy
from flexarm.arrays import Floats
from flexarm.errors import Problem
from flexarm.record.workspace import farthest_point, workspace_radius

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.record.record import Record
    from flexarm.record.signal import Signal
    from flexarm.record.table import Frame

LOOSE, TURNED = 0.2, 0.2
"""Of (2): part of the reach, and angle [rad]."""
UNKNOWN = 'a frame of which nothing is known is "unknown"'


def frame_rotation_problems(record: Record) -> Iterable[Problem]:
    """Yield implausible rotations of (2), which need no arm."""
    for name, frame in record.frames.items():
        if frame.rotation > TURNED:
            what = f"is {frame.rotation:g} rad (1 sigma), {np.degrees(frame.rotation):.3g} degrees"
            yield Problem(
                f"frames.{name}.rotation", f"{what}; it is in rad, not in mrad or degrees; {UNKNOWN}"
            )


def frame_problems(record: Record, arm: Arm) -> Iterable[Problem]:
    """Yield frames that violate (1), or (2) in translation."""
    for name, frame in record.frames.items():
        seen = [s for s in record.of_quantity("position").values() if s.frame == name and s.valid.any()]
        if frame.unknown or not seen:
            continue
        yield from (Problem(f"frames.{name}.translation", what) for what in _loose(record, arm, frame))
        if any(frame.xyz):
            yield from (Problem(f"frames.{name}.xyz", what) for what in _beyond(record, arm, frame, seen))


def _loose(record: Record, arm: Arm, frame: Frame) -> Iterable[str]:
    if arm.closures:  # where joints that follow stand is not known here
        return
    size = farthest_point(record, arm)
    if frame.translation > LOOSE * size > 0:
        what = f"is {frame.translation:g} m (1 sigma), the arm reaches {size:.3g} m; it is in m, not in mm"
        yield f"{what}; {UNKNOWN}"


def _beyond(record: Record, arm: Arm, frame: Frame, seen: Sequence[Signal]) -> Iterable[str]:
    # Of (1): parts of the reach, which is an upper bound, and sigmas of the registration on top.
    beyond, sure = 3.0, 5.0
    if arm.closures:
        return
    limit = workspace_radius(record, arm)
    far, signal = max((_far(signal, frame), signal.name) for signal in seen)
    if far > beyond * limit + sure * frame.translation:
        puts = f"is {list(frame.xyz)} m and puts {signal} {far:.4g} m from the base"
        yield f"{puts}, the arm reaches {limit:.3g} m at most; it is in m, not in mm"


def _far(signal: Signal, frame: Frame) -> float:
    """Return the distance of the median position of a signal from the base [m], along its axes."""
    middle = np.nanmedian(signal.values, axis=0)
    axes = ["xyz".index(axis) for axis in signal.axes]
    if any(frame.rpy) and len(axes) < 3:
        return 0.0  # what was not measured turns into what was
    place: Floats = np.zeros(3)
    place[axes] = middle
    place = np.array(from_rpy(frame.rpy)) @ place + np.asarray(frame.xyz)
    return float(np.linalg.norm(place[axes]))
