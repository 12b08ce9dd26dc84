"""Uncertain tilts of the base, as nuisance parameters of records that state how the base stood.

Each moves the residual in proportion,

    r = r_0 + (r(tilt + sigma) - r(tilt - sigma))/(2 sigma) x                                         (1)

about the stated tilt of its record and axis.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.record import Record

if TYPE_CHECKING:
    from flexarm.diagnosis.problem import Problem


@dataclass(frozen=True)
class UncertainTilt:
    """One component of a stated tilt.

    Attributes
    ----------
    record : str
        Whose.
    axis : {"x", "y"}
        About which.
    stated, sigma : float
        As the record has it [rad].
    """

    record: str
    axis: str
    stated: float
    sigma: float

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
    """Return columns of (1), shape (n, len(tilts)); zero for records that are not observed."""
    found = np.zeros((len(problem), len(tilts)))
    for k, tilt in enumerate(tilts):
        if tilt.record not in problem.records:
            continue
        ends = np.zeros((2, len(problem)))
        for end, turn in zip(ends, (tilt.sigma, -tilt.sigma), strict=True):
            problem.write_residual(end, tilt.record, problem.simulations.tilted(tilt, arm, turn))
        found[:, k] = (ends[0] - ends[1]) / (2 * tilt.sigma)  # eq. (1)
    return found
