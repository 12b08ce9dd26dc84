"""The tables of `record.toml`: clocks, frames, what a run carried, signals."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from flexarm.arm.inertia import Inertia, impossible
from flexarm.arm.sensor import Measurement
from flexarm.tables import FrozenDict, Inconsistent, Name, Number, Table, Vector3, value_in


class Clock(Table):
    """A clock: its stamps are late by `offset` +- `sigma` [s] against the reference, the first clock.

    An unknown one starts from a correlation of speeds.
    """

    offset: Number = value_in("s", "how late the stamps are", 0.0)
    sigma: Number = value_in("s", "1 sigma of the offset", 0.0, ge=0)
    unknown: bool = False


class Frame(Table):
    """A frame of measurement and how well its pose in the base is known.

    Parameters
    ----------
    xyz, rpy : (3,)
        Pose of the frame in the base [m, rad], URDF convention: p_base = R(rpy) p_measured + xyz.
    translation, rotation : float
        1 sigma of the registration, per axis [m, rad].
    unknown : bool
        Nothing is known: a rigid fit starts it.
    """

    xyz: Vector3 = value_in("m", "translation", (0.0, 0.0, 0.0))
    rpy: Vector3 = value_in("rad", "roll, pitch, yaw", (0.0, 0.0, 0.0))
    translation: Number = value_in("m", "1 sigma of the translation", 0.0, ge=0)
    rotation: Number = value_in("rad", "1 sigma of the rotation", 0.0, ge=0)
    unknown: bool = False


class CarriedPayload(Table):
    """What a run carried, weighed: it takes precedence over the model."""

    mass: Number | None = value_in("kg", "mass", None, ge=0)
    inertia: Inertia | None = value_in("kg m2", "inertia about its own centre", None)
    position: Vector3 | None = value_in("m", "position in the link's frame", None)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.inertia and (why := impossible(self.inertia)):
            raise Inconsistent((("inertia",), why))
        return self


class DrawnLink(Table):
    """How far a link was drawn out in a run, such as the boom of a crane."""

    length: Number = value_in("m", "length of the beam", gt=0)


def _as_clock(value: Any) -> Any:
    if value == "unknown":
        return Clock(unknown=True)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return {"sigma": value}
    if not isinstance(value, dict | Clock):
        raise ValueError(f'must be 1 sigma [s], {{ offset = , sigma = }} or "unknown", got {value!r}')
    return value


def _as_frame(value: Any) -> Any:
    if value == "unknown":
        return Frame(unknown=True)
    if not isinstance(value, dict | Frame):
        raise ValueError(
            f'must be a table such as {{ translation = 1e-3, rotation = 5e-4 }} or "unknown", got {value!r}'
        )
    return value


def _as_tuple(value: Any) -> Any:
    if isinstance(value, str):
        return (value,)
    return tuple(value) if isinstance(value, list) else value


Settings = Annotated[dict[Name, Number], AfterValidator(FrozenDict)]
"""Values of a controller by key, such as its gains."""
Names = Annotated[tuple[str, ...], BeforeValidator(_as_tuple)]
Clocks = Annotated[dict[Name, Annotated[Clock, BeforeValidator(_as_clock)]], AfterValidator(FrozenDict)]
Frames = Annotated[dict[Name, Annotated[Frame, BeforeValidator(_as_frame)]], AfterValidator(FrozenDict)]


class SignalTable(Measurement):
    """A signal of a record: what `Measurement` says, and where its samples stand.

    Parameters
    ----------
    file : str
        CSV file in the record's directory.
    time : str, optional
        Name of the column of stamps; not in a record of poses.
    time_unit : str
        Unit of the stamps, default s.
    pose : str, optional
        Name of the column of poses, in a record of poses.
    channels : list of str
        Names of the columns of values.
    """

    file: str = Field(description="name of a CSV file in the record's directory", min_length=1)
    time: str | None = None
    time_unit: str = "s"
    pose: str | None = None
    channels: Names = Field(description="names of the columns of values")

    @model_validator(mode="after")
    def _check_channels(self) -> Self:
        wanted = self.spec.channels or len(self.directions)
        if len(self.channels) != wanted:
            what = f"axes = {list(self.directions)}" if self.directions else self.quantity
            raise Inconsistent(
                (
                    ("channels",),
                    f"must be {wanted} for {what}, got {len(self.channels)}: {list(self.channels)}",
                )
            )
        if len(set(self.channels)) < len(self.channels):
            raise Inconsistent((("channels",), f"a column is named twice: {list(self.channels)}"))
        return self


class RecordTable(Table):
    """The whole of `record.toml`."""

    format: Literal["flexarm-record/1"] = "flexarm-record/1"
    description: str = ""
    kind: Literal["motion", "static"] = "motion"
    initial: Literal["equilibrium", "moving"] = "equilibrium"
    drive: Names = ()
    joints: Annotated[dict[Name, Number], AfterValidator(FrozenDict)] = FrozenDict()
    payloads: Annotated[dict[Name, CarriedPayload], AfterValidator(FrozenDict)] = FrozenDict()
    controllers: Annotated[dict[Name, Settings], AfterValidator(FrozenDict)] = FrozenDict()
    links: Annotated[dict[Name, DrawnLink], AfterValidator(FrozenDict)] = FrozenDict()
    clocks: Clocks = FrozenDict()
    frames: Frames = FrozenDict()
    signals: tuple[SignalTable, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> Self:
        from flexarm.record.consistency import inconsistencies

        if found := inconsistencies(self):
            raise Inconsistent(*found)
        return self
