"""Tables of an import map: where each signal of a record stands in the logs, and what its numbers mean."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import pi
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, Strict, StringConstraints, model_validator

from flexarm.arm.sensor import Measurement
from flexarm.errors import InvalidParameter
from flexarm.record.consistency import INPUTS, references, responses
from flexarm.record.file_table import RunTable
from flexarm.tables import Inconsistent, Name, Number, Table, Vector3, check_table, read_toml, value_in
from flexarm.tables.table import Whole
from flexarm.units import factor_to, si_factor

FORMAT = "flexarm-map/1"
SOURCE = "name of the file, from where the map lies"
KEYS_OF_KIND = {
    "motion": ("time", "time_unit", "time_format"),
    "static": ("pose",),
    "frequency_response": ("frequency", "frequency_unit", "response", "phase_unit", "coherence", "averages"),
}
"""Keys that tell rows of a record of one kind apart, and say what they hold."""
FORMS_OF_ROTATIONS = {"quaternion": 4, "matrix": 9, "vector": 3}
"""Columns of an orientation, by its form; angles have three."""


class Every(Table):
    """Stamps of samples at a constant rate, where a file has none."""

    rate_hz: Number = value_in("Hz", "samples a second", gt=0)
    start: Number = value_in("s", "stamp of the first sample", 0.0)


class Counts(Table):
    """The unit of an encoder that counts."""

    counts_per_turn: Number = value_in("-", "counts for one turn of what the encoder sits on", gt=0)


class Current(Table):
    """The unit of a motor's current that stands for its torque; the current is in ampere."""

    torque_constant: Number = value_in("N m/A", "torque for one ampere", gt=0)


def _column(value: Any) -> Any:
    number = isinstance(value, int) and not isinstance(value, bool)
    if (number and value < 1) or not (number or (isinstance(value, str) and value.strip())):
        raise ValueError(f"must be the name of a column, or its number counted from 1, got {value!r}")
    return value


def _time(value: Any) -> Any:
    if isinstance(value, Mapping):
        return Every(**value)
    if isinstance(value, list | tuple) and value:
        return tuple(_column(column) for column in value)
    return value if isinstance(value, Every) else _column(value)


def _rotation(value: Any) -> Any:
    if value not in FORMS_OF_ROTATIONS and not re.fullmatch(r"(?!.*(.)\1)([xyz]{3}|[XYZ]{3})", str(value)):
        what = 'must be "quaternion", "matrix", "vector", or an order of angles such as "xyz" or "ZYX"'
        raise ValueError(f"{what}, got {value!r}")
    return value


def _as_tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list | tuple) else (value,)


def _unit(value: Any) -> Any:
    if isinstance(value, Mapping):
        return Current(**value) if "torque_constant" in value else Counts(**value)
    if not isinstance(value, str | Counts | Current):
        what = '"deg", { counts_per_turn = 65536 } or { torque_constant = 0.12 }'
        raise ValueError(f"must be a unit, such as {what}, got {value!r}")
    return value


Column = Annotated[str | int, BeforeValidator(_column)]
Columns = Annotated[tuple[Column, ...], BeforeValidator(_as_tuple)]
Stamps = Annotated[str | int | tuple[Column, ...] | Every, BeforeValidator(_time)]
Unit = Annotated[str | Counts | Current, BeforeValidator(_unit)]
Numbers = Annotated[tuple[Number, ...], BeforeValidator(_as_tuple)]
Mark = Annotated[str, StringConstraints(min_length=1, max_length=1)]


class Dialect(Table):
    """How a text file is written, where that cannot be seen from its first lines."""

    separator: Mark | None = None
    decimal: Literal[".", ","] | None = None
    """Characters between cells and before decimals; a blank stands for any number of blanks and tabs."""
    encoding: str | None = None
    """Name of the encoding, such as "cp1252"."""
    header_rows: Annotated[int, Strict(), Field(ge=0)] | None = None
    """Lines before the first row; the last of them, or the one above a line of units, names the columns."""
    comment: str | None = Field(None, min_length=1)
    """What lines begin with that are skipped; default `//` or `%` if the file begins so, else `#`."""
    columns: tuple[str, ...] = ()
    """Names of the columns, in place of those that the file gives."""


class SignalMap(Measurement):
    """A signal of a map: what `Measurement` says, and how it is read from a log.

    `noise_std` is of the record's signal, in SI.
    """

    source: str = Field("", description="name of the file, from where the map lies")
    """File, or directory of a ROS 2 bag; none of the input of a frequency response."""
    topic: str | None = None
    """Topic of a bag, path of a variable or group, name of a sheet."""
    columns: Columns = ()
    """Columns or fields of the values; numbers count from 1, `[k]` picks a row of a matrix."""
    time: Stamps | None = None
    """Column or field of the stamps, "log" for the file's own time, or `{ rate_hz = }`; of stamps that are
    texts the columns that make one together, such as date and time of day."""
    time_unit: str | None = None
    time_format: str | None = None
    """s, ms, us or ns; of stamps that are texts their form as `datetime.strptime` takes it."""
    pose: Column | None = None
    """In a record of poses the column that names the pose; left out: each row is a pose."""
    frequency: Column | None = None
    frequency_unit: Literal["Hz", "kHz", "rad/s"] = "Hz"
    """In a record of frequency responses the column of frequencies."""
    input: Name | None = None
    """There: name of the signal to which this one is the response; one without it is an input."""
    response: Literal["real-imaginary", "complex", "magnitude-phase", "decibel-phase"] = "real-imaginary"
    """There: what the columns hold, two for each channel, of complex numbers one."""
    phase_unit: Literal["rad", "deg"] = "rad"
    coherence: Column | None = None
    averages: Whole = Field(1, ge=1, description="number of averages of the coherence")
    where: dict[str, str | Number] = Field(default_factory=dict)
    """Only rows in which columns hold these values; in a text `*` stands for any others, `?` for one."""
    unit: Unit | None = None  # type: ignore[assignment]
    """Unit of the values, `{ counts_per_turn = }` or `{ torque_constant = }`; default SI."""
    before_gear: bool = False
    """The value is the motor's own: divided, a torque multiplied, by the joint's gear ratio."""
    scale: Numbers = (1.0,)
    offset: Numbers = (0.0,)
    """Value becomes scale x value + offset, in `unit`; several have one number a column."""
    sum: bool = False
    """The columns, each with its scale and offset, are added: of a joint that several motors or joints
    move."""
    quaternion: Literal["xyzw", "wxyz"] = "xyzw"
    """Order of the columns of an orientation."""
    rotation: Annotated[str, BeforeValidator(_rotation)] = "quaternion"
    """What these are: "matrix" goes row by row, "vector" is the axis times the angle; of angles the order,
    "xyz" about axes at rest (roll, pitch, yaw), "ZYX" about those that turn."""
    mount: Vector3 | None = value_in("rad", "roll, pitch, yaw of the sensor", None)
    """In the axes of its signal [rad]; columns are the x, y, z of a sensor of three axes then."""
    csv: Dialect = Dialect()

    def _problems(self) -> list[tuple[tuple[str, ...], str]]:
        return [*super()._problems(), *self._column_problems(), *self._conversion_problems()]

    @property
    def si(self) -> tuple[str, float]:
        """SI unit of the record's values and the factor to it."""
        unit = self.unit
        if self.input is not None:  # that of output per input, see `response_unit`
            return self.spec.units[0], 1.0
        if self.torque_constant is not None:
            return super().si
        if isinstance(unit, Counts):
            turns = {"rad": 2 * pi, "rad/s": 2 * pi}
            si = self.spec.units[0]
            if si not in turns:
                raise InvalidParameter(f"counts are of an angle; {self.quantity} is in {si}")
            return si, turns[si] / unit.counts_per_turn
        if isinstance(unit, Current):
            if self.quantity != "motor_torque":
                what = 'a torque constant makes a current a torque; needed is quantity = "motor_torque"'
                raise InvalidParameter(f"{what}, got {self.quantity!r}")
            return "N m", unit.torque_constant
        if self.rotation not in ("quaternion", "matrix"):
            return self.spec.units[0], si_factor("rad" if unit is None else unit, ("rad",))[1]
        if unit is not None and factor_to("Pa", unit) is not None:
            what = (
                f"unit {unit!r} is of a pressure; `sum` with areas as `scale` gives the force of a cylinder"
            )
            raise InvalidParameter(f"{what}, in N (docs/importing.md)")
        return si_factor(self.spec.units[0] if unit is None else unit, self.spec.units)

    @property
    def bare(self) -> bool:
        """True if nothing is read, as of the input of a frequency response."""
        return not self.source and not self.columns and self.input is None

    def _column_problems(self) -> list[tuple[tuple[str, ...], str]]:
        if self.bare and self.quantity in INPUTS:
            return []
        wanted = self.spec.channels or len(self.directions)
        wanted = FORMS_OF_ROTATIONS.get(self.rotation, 3) if self.quantity == "orientation" else wanted
        wanted = 3 if self.mount is not None else wanted
        wanted = 2 * wanted if self.input is not None and self.response != "complex" else wanted
        found: list[tuple[tuple[str, ...], str]] = []
        if not self.source:
            found.append((("source",), f"is missing; needed is {SOURCE}"))
        if not self.columns:
            what = "is missing; needed is names of the columns, or numbers counted from 1"
            return [*found, (("columns",), what)]
        if len(self.columns) != wanted and not (self.sum and wanted == 1):
            what = f"axes = {list(self.directions)}" if self.directions else self.quantity
            what = "a sensor with a mount" if self.mount is not None else what
            found.append(
                (("columns",), f"must be {wanted} for {what}, got {len(self.columns)}: {list(self.columns)}")
            )
        if len(set(self.columns)) < len(self.columns):
            found.append((("columns",), f"a column is named twice: {list(self.columns)}"))
        found += [
            (
                (key,),
                f"must be one number, or one for each of {len(self.columns)} columns, got {list(numbers)}",
            )
            for key, numbers in (("scale", self.scale), ("offset", self.offset))
            if len(numbers) not in (1, len(self.columns))
        ]
        return found

    def _conversion_problems(self) -> list[tuple[tuple[str, ...], str]]:
        found: list[tuple[tuple[str, ...], str]] = []
        if self.input is not None:
            found += [
                ((key,), "does not belong to a frequency response")
                for key in ("before_gear", "offset", "sum", "mount")
                if key in self.model_fields_set
            ]
            if isinstance(self.unit, Counts | Current):
                found.append((("unit",), f'is output per input, such as "m/s2/N", got {self.unit}'))
        if self.mount is not None and self.spec.channels is not None:
            found.append((("mount",), f"{self.quantity} has no three axes that a mount could turn"))
        if self.quaternion != "xyzw" and self.quantity != "orientation":
            found.append((("quaternion",), f"{self.quantity} is no quaternion; only orientation is"))
        if self.quaternion != "xyzw" and self.rotation != "quaternion":
            found.append((("quaternion",), f'is no order of a rotation that is "{self.rotation}"'))
        if self.rotation != "quaternion" and self.quantity != "orientation":
            found.append((("rotation",), f"{self.quantity} is no rotation; only orientation is"))
        if self.before_gear and not self.spec.has_side:
            what = "is before no gear; only joint_angle, joint_rate and motor_torque are"
            found.append((("before_gear",), f"{self.quantity} {what}"))
        if self.before_gear and self.quantity == "motor_torque":
            if "side" in self.model_fields_set and self.side == "motor":
                what = 'a torque of side "motor" is the motor\'s own already; leave before_gear out, or say '
                found.append((("before_gear",), f'{what}side = "output"'))
            object.__setattr__(self, "side", "output")
        if self.time_unit is not None and factor_to("s", self.time_unit) is None:
            what = f"unit {self.time_unit!r} does not fit; allowed are s, ms, us, ns, min"
            found.append((("time_unit",), what))
        if isinstance(self.time, tuple) and self.time_format is None:
            what = "columns that make a stamp together are joined by blanks; time_format says how they read"
            found.append((("time",), what))
        if isinstance(self.time, Every):
            found += [
                ((key,), f"does not belong to stamps of a rate_hz, which are in s; got {value!r}")
                for key, value in (("time_unit", self.time_unit), ("time_format", self.time_format))
                if value is not None
            ]
        return found


class MapTable(RunTable):
    """The whole of an import map."""

    format: Literal["flexarm-map/1"] = "flexarm-map/1"
    model: str | None = None
    signals: tuple[SignalMap, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> Self:
        found = [*references(self), *responses(self), *self._stamp_problems()]
        if not self.signals:
            found = [(("signals",), "is missing; a map needs at least one signal that is not commented out")]
        if found:
            raise Inconsistent(*found)
        return self

    def _stamp_problems(self) -> list[tuple[tuple[str | int, ...], str]]:
        static, ringing = self.kind == "static", self.kind == "frequency_response"
        found: list[tuple[tuple[str | int, ...], str]] = []
        for i, signal in enumerate(self.signals):
            read = not (ringing and signal.input is None)
            if signal.bare and read:
                found.append((("signals", i, "source"), f"is missing; needed is {SOURCE}"))
            elif self.kind == "motion" and signal.time is None:
                what = 'is missing; needed is a column of stamps, "log" for the file\'s own, or { rate_hz = }'
                found.append((("signals", i, "time"), what))
            elif ringing and read and signal.frequency is None:
                found.append((("signals", i, "frequency"), "is missing; needed is the column of frequencies"))
            elif not read and not signal.bare:
                what = "belongs to a response, which names its input; of an input nothing is read"
                found.append((("signals", i, "source"), what))
            found += [
                (("signals", i, key), f"does not belong to a record of kind {self.kind!r}")
                for kind, keys in KEYS_OF_KIND.items()
                for key in keys
                if kind != self.kind and key in signal.model_fields_set
            ]
            if signal.spec.only_static and not static:
                what = f'{signal.quantity} belongs to records of kind "static"'
                found.append((("signals", i, "quantity"), f"{what}; what a run carried stands in [payloads]"))
            if signal.before_gear and self.model is None:
                found.append((("model",), f"is missing; signal {signal.name!r} needs its gear ratio"))
        return found


def read_map(file: Path) -> tuple[MapTable, dict[str, Any], str]:
    """Return a map, the tables of its file as they stand, and its text.

    Raise InvalidFile with the place and value of every problem.
    """
    data, text = read_toml(file, FORMAT)
    return check_table(MapTable, data, file, text), data, text
