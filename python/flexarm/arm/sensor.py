"""Properties of a signal, measured or virtual, and the sensors of a model.

`Measurement` holds the keys that a sensor of a model and a signal of a record share. Values are in `unit`
where the file says one, else in SI.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from flexarm.errors import InvalidParameter
from flexarm.quantities import CURRENT, QUANTITIES, TORQUE, Quantity, QuantityName, channel_names
from flexarm.tables import Inconsistent, Name, Number, Table, Vector2, value_in
from flexarm.units import si_factor


def _check_axes(axes: tuple[str, ...]) -> tuple[str, ...]:
    if not axes or len(set(axes)) < len(axes):
        raise ValueError(f"must name at least one of x, y, z and none twice, got {list(axes)}")
    return axes


Axes = Annotated[tuple[Literal["x", "y", "z"], ...], AfterValidator(_check_axes)]


class Measurement(Table):
    """Quantity, place and noise of a signal."""

    name: Name = Field(description="name of the signal")
    quantity: QuantityName = Field(description='what is measured, such as "position"')
    """A key of `flexarm.quantities.QUANTITIES`."""
    joint: Name | None = None
    point: Name | None = None
    link: Name | None = None
    payload: Name | None = None
    """Where; which of them is needed depends on the quantity."""
    side: Literal["motor", "output"] | None = None
    """Before the reducer (divided by the ratio) or after it; default motor."""
    axes: Axes = ()
    """Directions of the channels, default all three; for an inclination the one body axis whose angle to the
    horizontal is measured."""
    frame: Name = "base"
    clock: Name | None = None
    """Default: "base", the base's own frame, and the reference clock."""
    unit: str | None = None
    """Unit of the values, noise_std and step; default SI."""
    torque_constant: Number | None = value_in("N m/A", "torque of the motor over its current", None, gt=0)
    """Of a motor's current [N m/A], which it makes a torque: `motor_current` is `motor_torque` from then on.
    With side "output" it is that of the output, the gear ratio included."""
    noise_std: Number | None = value_in("unit", "1 sigma of the noise per channel", None, ge=0)
    """1 sigma per channel, in `unit`."""
    jitter_std: Number = value_in("s", "1 sigma of the stamps", 0.0, ge=0)
    """1 sigma of the stamps [s]."""
    position: Number | None = value_in("m", "place along the link", None)
    """For strain, and deflection of a link: the place along its axis [m]."""
    fibre: Vector2 | None = value_in("m", "fibre [y, z] in the section", None)
    """For strain: the fibre [y, z] in the section's axes [m]."""

    @model_validator(mode="before")
    @classmethod
    def _current_as_torque(cls, given: Any) -> Any:
        if not isinstance(given, dict) or given.get("quantity") != CURRENT:
            return given
        if given.get("torque_constant") is None:
            what = "is missing; motor_current needs the torque of the motor over its current [N m/A]"
            raise Inconsistent((("torque_constant",), what))
        return {"unit": "A", **given, "quantity": TORQUE}

    @model_validator(mode="after")
    def _check_measurement(self) -> Self:
        if problems := self._problems():
            raise Inconsistent(*problems)
        if self.spec.channels is None and not self.axes:
            object.__setattr__(self, "axes", ("x", "y", "z"))
        if self.spec.has_side and self.side is None:
            object.__setattr__(self, "side", "motor")
        return self

    @property
    def spec(self) -> Quantity:
        """The row of the table of quantities."""
        return QUANTITIES[self.quantity]

    @property
    def place(self) -> str:
        """Name of the joint, point, link or payload."""
        return self.joint or self.point or self.link or self.payload or ""

    @property
    def located(self) -> dict[str, Any]:
        """Where and along which axes it measures, as a `Signal` of a record takes it."""
        keys = ("joint", "point", "link", "payload", "side", "axes", "frame", "position", "fibre")
        return {key: getattr(self, key) for key in keys}

    @property
    def si(self) -> tuple[str, float]:
        """SI unit of the values and the factor to it."""
        if self.torque_constant is not None:
            return self.spec.units[0], si_factor(self.unit or "A", ("A",))[1] * self.torque_constant
        return si_factor(self.unit if self.unit is not None else self.spec.units[0], self.spec.units)

    @property
    def directions(self) -> tuple[str, ...]:
        """Names of the channels: axes, "x y z w" of a quaternion, or none for a scalar."""
        names = channel_names(self.quantity, self.axes)
        return () if names == ("",) else names

    def _problems(self) -> list[tuple[tuple[str, ...], str]]:
        """Return pairs of key and sentence for all that does not fit."""
        problems = [*self._place_problems(), *self._detail_problems()]
        try:
            _ = self.si
        except InvalidParameter as error:
            problems.append((("unit",), str(error)))
        return problems

    def _place_problems(self) -> list[tuple[tuple[str, ...], str]]:
        given = [kind for kind in ("joint", "point", "link", "payload") if getattr(self, kind) is not None]
        wrong = [kind for kind in given if kind not in self.spec.places]
        needed = " or ".join(self.spec.places)
        found: list[tuple[tuple[str, ...], str]] = [
            ((kind,), f"{self.quantity} is not measured at a {kind}, but at a {needed}") for kind in wrong
        ]
        if not given:
            what = f"is missing; {self.quantity} needs the name of a {needed}"
            found.append(((self.spec.places[0],), what))
        elif len(given) > 1 and not wrong:
            found.append(((given[1],), f"give either {' or '.join(given)}, not both"))
        return found

    def _detail_problems(self) -> list[tuple[tuple[str, ...], str]]:
        found: list[tuple[tuple[str, ...], str]] = []
        if self.side and not self.spec.has_side:
            what = f"{self.quantity} has no side; only joint_angle, joint_rate and motor_torque have"
            found.append((("side",), what))
        if self.torque_constant is not None and self.quantity != TORQUE:
            what = f"makes a current a torque; {self.quantity} has none, only {CURRENT} has"
            found.append((("torque_constant",), what))
        if self.spec.one_axis and len(self.axes) != 1:
            found.append((("axes",), f'{self.quantity} needs the one body axis it measures, such as ["x"]'))
        if self.axes and self.spec.channels is not None and not self.spec.one_axis:
            found.append((("axes",), f"{self.quantity} has no axes"))
        if self.quantity == "strain" and (self.position is None or self.fibre is None):
            what = "is missing; strain needs position along the link [m] and fibre [y, z] [m]"
            found.append((("position" if self.position is None else "fibre",), what))
        if self.position is not None and self.link is None:
            found.append((("position",), "belongs to a signal at a link"))
        if self.fibre is not None and self.quantity != "strain":
            found.append((("fibre",), f"{self.quantity} has no fibre; only strain has"))
        if self.frame != "base" and self.quantity not in ("position", "orientation"):
            found.append((("frame",), f"{self.quantity} has no frame; only position and orientation have"))
        return found


class Sensor(Measurement):
    """A virtual sensor of a model."""

    rate_hz: Number = value_in("Hz", "samples a second", gt=0)
    start: Number = value_in("s", "time of the first sample", 0.0, ge=0)
    """Time of the first sample after the start of the run [s]."""
    latency_s: Number = value_in("s", "delay of the stamp", 0.0, ge=0)
    """Age of a value at its stamp [s]: the stamp is late by so much."""
    drop_out: Number = value_in("-", "share of lost samples", 0.0, ge=0, lt=1)
    """Share of samples that are lost, 0 to 1."""
    step: Number = value_in("unit", "quantisation", 0.0, ge=0)
    """Quantisation, in `unit`; 0: none."""
    time: Name = "time_s"
    """Name of the column of stamps in the file that is written."""
