"""The motion of one joint, piecewise polynomial in time."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexarm import _core
from flexarm.arguments import ARRAY, ROW, holds, takes
from flexarm.arrays import Floats, frozen
from flexarm.errors import InvalidParameter

_KINDS = {
    "motor": _core.DriveKind.motor_angle,
    "output": _core.DriveKind.link_angle,
    "torque": _core.DriveKind.torque,
    "command": _core.DriveKind.torque,
}


@holds(breaks=ARRAY, coefficients=ARRAY)
@dataclass(frozen=True)
class JointDrive:
    """Motion of one joint as scipy.interpolate.PPoly has it, held before and after.

    Attributes
    ----------
    breaks : ndarray, shape (m + 1,)
        Times [s], rising.
    coefficients : ndarray, shape (order + 1, m)
        Of each piece, highest power first [rad, m for a prismatic joint; N m for a torque].
    side : {"motor", "output", "torque"}
        What is prescribed: the motor's angle over the ratio, the link's own angle, or the motor's torque
        times the ratio; motors driven by torque stand at their rest angle until the start.
    """

    breaks: Floats
    coefficients: Floats
    side: str = "motor"

    def __post_init__(self) -> None:
        if self.side not in _KINDS:
            raise InvalidParameter(f"must be one of {', '.join(_KINDS)}, got {self.side!r}", where="side")
        for name in ("breaks", "coefficients"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @property
    def kind(self) -> _core.DriveKind:
        """Kind of drive of the core."""
        return _KINDS[self.side]

    @cached_property
    def digest(self) -> bytes:
        """Hash of the numbers, for `Drive.sha256`: identification runs one drive many times."""
        return hashlib.sha256(self.breaks.tobytes() + self.coefficients.tobytes()).digest()

    @classmethod
    @takes(time=ROW, values=ROW)
    def held(cls, time: Floats, values: Floats) -> JointDrive:
        """Return a command: every sample holds until the next one."""
        if not len(time) or len(time) != len(values):
            what = f"needs one value for each time, got {len(values)} for {len(time)}"
            raise InvalidParameter(what, where="values")
        return cls(np.append(time, time[-1] + 1.0), np.asarray(values, dtype=float)[None, :], "command")

    @cached_property
    def _polynomial(self) -> _core.PiecewisePolynomial:
        return _core.PiecewisePolynomial(self.breaks, self.coefficients)

    def polynomial(self) -> _core.PiecewisePolynomial:
        """Return the polynomial of the core; runs of many arms along a drive share it."""
        return self._polynomial

    def __getstate__(self) -> dict[str, Any]:
        return {each.name: getattr(self, each.name) for each in fields(self)}

    def __call__(self, time: ArrayLike) -> Floats:
        """Return the values at times [s]."""
        t = np.clip(np.asarray(time, dtype=float), self.breaks[0], self.breaks[-1])
        i = np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, len(self.breaks) - 2)
        value: Floats = np.zeros_like(t)
        for row in self.coefficients:
            value = value * (t - self.breaks[i]) + row[i]
        return value
