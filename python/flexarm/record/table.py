"""Tables that a record holds: clocks, frames, what a run carried."""

from __future__ import annotations

from math import hypot, pi
from typing import Self

from pydantic import model_validator

from flexarm.arm.inertia import Inertia, impossible
from flexarm.tables import Inconsistent, Number, Table, Vector2, Vector3, value_in


class Clock(Table):
    """A clock: its stamps are late by `offset` +- `sigma` [s] against the reference, the first clock.

    An unknown one starts from a correlation of speeds.
    """

    offset: Number = value_in("s", "how late the stamps are", 0.0)
    sigma: Number = value_in("s", "1 sigma of the offset", 0.0, ge=0)
    unknown: bool = False


class Frame(Table):
    """A frame of measurement and how well its pose in the base is known."""

    xyz: Vector3 = value_in("m", "translation", (0.0, 0.0, 0.0))
    rpy: Vector3 = value_in("rad", "roll, pitch, yaw", (0.0, 0.0, 0.0))
    """Pose of the frame in the base [m, rad], URDF convention: p_base = R(rpy) p_measured + xyz, shape
    (3,)."""
    translation: Number = value_in("m", "1 sigma of the translation", 0.0, ge=0)
    rotation: Number = value_in("rad", "1 sigma of the rotation", 0.0, ge=0)
    """1 sigma of the registration, per axis [m, rad]."""
    unknown: bool = False
    """Nothing is known: a rigid fit starts it."""


class CarriedPayload(Table):
    """A payload as weighed in a run, which takes precedence over the model."""

    mass: Number | None = value_in("kg", "mass", None, ge=0)
    inertia: Inertia | None = value_in("kg m2", "inertia about its own centre", None)
    position: Vector3 | None = value_in("m", "position in the link's frame", None)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.inertia and (why := impossible(self.inertia)):
            raise Inconsistent((("inertia",), why))
        return self


class DrawnLink(Table):
    """The length of a link in a run, such as of the boom of a crane."""

    length: Number = value_in("m", "length of the beam", gt=0)


class BaseStand(Table):
    """How the base stood in a run, as measured with a level or a tracker."""

    tilt: Vector2 = value_in("rad", "tilt about the base's x and y")
    """Rotation vector about the base's x and y [rad]; gravity and frames of measurement do not turn, shape
    (2,)."""
    sigma: Number = value_in("rad", "1 sigma of the tilt about each axis", 0.0, ge=0)
    """1 sigma of each of them [rad]."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (angle := hypot(*self.tilt)) > pi:
            what = f"must turn by at most pi rad in all, got {angle:.4g} rad; angles are in rad, not degrees"
            raise Inconsistent((("tilt",), what))
        return self
