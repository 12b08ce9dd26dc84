"""The table of `record.toml` as it stands in the file, with the tables of its signals.

Only what reads such a file needs it: pydantic takes 8 ms to make its checker.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from flexarm.arm.sensor import Measurement
from flexarm.quantities import FRAMED, TORQUE
from flexarm.record.table import BaseStand, CarriedPayload, Clock, DrawnLink, Frame
from flexarm.tables import FrozenDict, Inconsistent, Name, Number, Table, Texts, value_in
from flexarm.tables.table import Numbers, Whole
from flexarm.units import factor_to, si_factor, unit_in_name


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


Settings = Annotated[dict[Name, Number], AfterValidator(FrozenDict)]
"""Values of a controller by key, such as its gains."""
Clocks = Annotated[dict[Name, Annotated[Clock, BeforeValidator(_as_clock)]], AfterValidator(FrozenDict)]
Frames = Annotated[dict[Name, Annotated[Frame, BeforeValidator(_as_frame)]], AfterValidator(FrozenDict)]


class SignalTable(Measurement):
    """A signal of a record: what `Measurement` says, and where its samples stand."""

    file: str = Field("", description="name of a CSV file in the record's directory")
    """CSV file in the record's directory."""
    time: str | None = None
    """Name of the column of stamps; not in a record of poses."""
    time_unit: str = "s"
    """Unit of the stamps, default that in which the name of their column ends, else s."""
    pose: str | None = None
    """Name of the column of poses, in a record of poses."""
    channels: Texts = Field((), description="names of the columns of values")
    """Names of the columns of values; of a frequency response real and imaginary part, one after the
    other."""
    frequency: str | None = None
    """Name of the column of frequencies [Hz], in a record of frequency responses."""
    input: Name | None = None
    """There: name of the signal to which this one is the response; one without it is an input."""
    coherence: str | None = None
    """There: name of the column of the coherence, in place of `noise_std`."""
    averages: Whole = Field(1, ge=1, description="number of averages of the coherence")
    """There: number of averages of the coherence."""
    zero_std: Number | None = value_in("unit", "1 sigma of the zero of the sensor", None, ge=0)
    """1 sigma of the zero of the sensor, in the unit of the values; not of places and attitudes."""
    areas: Numbers = ()
    """Of a `force` at a joint that slides, a cylinder: areas of its piston [m2] on which the pressures of
    `channels` act, the one that extends the joint first. The force is the `motor_torque` from then on."""

    @model_validator(mode="before")
    @classmethod
    def _pressures_as_force(cls, given: Any) -> Any:
        if not isinstance(given, dict) or given.get("quantity") != "force" or "joint" not in given:
            return given
        if not given.get("areas"):
            what = "is missing; force at a joint needs the areas [m2] on which the pressures act"
            raise Inconsistent((("areas",), what))
        return {"unit": "Pa", "side": "output", **given, "quantity": TORQUE}

    @property
    def si(self) -> tuple[str, float]:
        """SI unit of the values and the factor to it; a frequency response's is that of its record."""
        if self.areas:
            return "N", si_factor(self.unit or "Pa", ("Pa",))[1]
        return (self.spec.units[0], 1.0) if self.input is not None else super().si

    @model_validator(mode="after")
    def _take_time_unit(self) -> Self:
        named = unit_in_name(self.time or "")
        if "time_unit" not in self.model_fields_set and factor_to("s", named) is not None:
            object.__setattr__(self, "time_unit", named)
        return self

    @model_validator(mode="after")
    def _check_areas(self) -> Self:
        if self.areas and self.quantity != TORQUE:
            what = f"make pressures a force at a joint; {self.quantity} has none"
            raise Inconsistent((("areas",), what))
        if len(self.areas) > 2 or min(self.areas, default=1.0) <= 0:
            what = f"must be one or two areas above 0 m2, got {list(self.areas)}"
            raise Inconsistent((("areas",), what))
        return self

    @model_validator(mode="after")
    def _check_channels(self) -> Self:
        wanted = len(self.areas) or self.spec.channels or len(self.directions)
        wanted = 2 * wanted if self.input is not None else wanted
        if self.channels and len(self.channels) != wanted:
            what = f"axes = {list(self.directions)}" if self.directions else self.quantity
            raise Inconsistent(
                (
                    ("channels",),
                    f"must be {wanted} for {what}, got {len(self.channels)}: {list(self.channels)}",
                )
            )
        if self.zero_std is not None and self.quantity in FRAMED:
            what = f"does not go with {self.quantity}, whose zero is that of its frame; state [frames]"
            raise Inconsistent((("zero_std",), what))
        if len(set(self.channels)) < len(self.channels):
            raise Inconsistent((("channels",), f"a column is named twice: {list(self.channels)}"))
        return self


class RunTable(Table):
    """What a record says of its run beside the signals."""

    description: str = ""
    kind: Literal["motion", "static", "frequency_response"] = "motion"
    initial: Literal["equilibrium", "moving"] = "equilibrium"
    drive: Texts = ()
    joints: Annotated[dict[Name, Number], AfterValidator(FrozenDict)] = FrozenDict()
    payloads: Annotated[dict[Name, CarriedPayload], AfterValidator(FrozenDict)] = FrozenDict()
    controllers: Annotated[dict[Name, Settings], AfterValidator(FrozenDict)] = FrozenDict()
    links: Annotated[dict[Name, DrawnLink], AfterValidator(FrozenDict)] = FrozenDict()
    clocks: Clocks = FrozenDict()
    frames: Frames = FrozenDict()
    base: BaseStand | None = None

    def stated(self) -> dict[str, Any]:
        """Return what a record takes of its run as it is stated."""
        return {name: getattr(self, name) for name in RunTable.model_fields}


class RecordTable(RunTable):
    """The whole of `record.toml`."""

    format: Literal["flexarm-record/1"] = "flexarm-record/1"
    signals: tuple[SignalTable, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> Self:
        from flexarm.record.consistency import inconsistencies

        if found := inconsistencies(self):
            raise Inconsistent(*found)
        return self
