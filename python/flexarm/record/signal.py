"""A signal: what one sensor gave, on its own instants, in SI units."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arguments import ARRAY, NAME_TUPLE, NUMBER, NUMBERS, holds
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter
from flexarm.quantities import FRAMED, QUANTITIES, Quantity, channel_names
from flexarm.record.quantisation_grid import quantisation_step
from flexarm.tables.ranges import first_beyond, out_of_range, range_of


@holds(values=ARRAY, time=ARRAY, axes=NAME_TUPLE, position=NUMBER, fibre=NUMBERS, channels=NAME_TUPLE)
@dataclass(frozen=True, eq=False, kw_only=True)
class Signal:
    """Samples of one quantity at one place.

    Attributes
    ----------
    name, quantity : str
        Name of the signal, and a key of `flexarm.quantities.QUANTITIES`.
    time : ndarray, shape (n,)
        Stamps [s] of the signal's clock, rising; empty in a record of poses.
    values : ndarray, shape (n, channels)
        Values in `unit`; NaN is a drop-out. One-dimensional input becomes one channel.
    unit : str
        SI unit of the values; left out: the first one of the quantity.
    unit_assumed : bool
        True if no unit was stated: a model's joint that slides then makes it metres; not compared.
    noise_std : float or None
        1 sigma per channel, in `unit`; None: not stated.
    zero_std : float or None
        1 sigma of the zero of the sensor, in `unit`; None: not stated.
    jitter_std : float
        1 sigma of the stamps [s].
    clock, frame : str
        Names in the record's clocks and frames; "base" is the base's own frame.
    joint, point, link, payload : str or None
        Where it was measured.
    side : {"motor", "output"} or None
        Before the reducer (divided by the ratio) or after it.
    axes : tuple of str
        Directions of the channels; for an inclination the body axis.
    position, fibre : optional
        Place along the link [m] and fibre [y, z] of a strain [m].
    channels : tuple of str
        Names of the columns in the file.
    file, time_column : str
        Where it is stored; empty: chosen when saved.
    pose : ndarray of str, shape (n,), or None
        In a record of poses: the pose of each row.
    frequency : ndarray, shape (n,), or None
        In a record of frequency responses: the frequency of each row [Hz], rising.
    input : str
        There: the signal to which this one is the response; `values` has real and imaginary part of each
        channel side by side, (n, 2 channels), in `unit`, output per input. Empty: an input, without values.
    coherence : ndarray, shape (n,), or None
        There: of output and input [-].
    averages : int
        There: number of averages of the coherence.
    """

    name: str
    quantity: str
    values: Floats
    time: Floats = None  # type: ignore[assignment]
    unit: str = ""
    unit_assumed: bool = field(default=False, compare=False)
    noise_std: float | None = None
    zero_std: float | None = None
    jitter_std: float = 0.0
    clock: str = ""
    frame: str = "base"
    joint: str | None = None
    point: str | None = None
    link: str | None = None
    payload: str | None = None
    side: str | None = None
    axes: tuple[str, ...] = ()
    position: float | None = None
    fibre: tuple[float, float] | None = None
    channels: tuple[str, ...] = ()
    file: str = ""
    time_column: str = "time_s"
    pose: NDArray[np.str_] | None = None
    frequency: Floats | None = None
    input: str = ""
    coherence: Floats | None = None
    averages: int = 1

    def __post_init__(self) -> None:
        if self.quantity not in QUANTITIES:
            what = f"unknown quantity {self.quantity!r}; known are {', '.join(QUANTITIES)}"
            raise InvalidParameter(what, where=f"signals.{self.name}.quantity")
        values = np.array(self.values, dtype=float)
        values = values[:, None] if values.ndim == 1 else values
        time = np.array([] if self.time is None else self.time, dtype=float)
        for name, array in (("values", values), ("time", time)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if self.pose is not None:
            pose = np.array([canonical_pose(str(each)) for each in self.pose], dtype=str)
            pose.setflags(write=False)
            object.__setattr__(self, "pose", pose)
        for name in ("frequency", "coherence"):
            if getattr(self, name) is not None:
                array = np.array(getattr(self, name), dtype=float)
                array.setflags(write=False)
                object.__setattr__(self, name, array)
        object.__setattr__(self, "unit_assumed", self.unit_assumed or not self.unit)
        object.__setattr__(self, "unit", self.unit or self.spec.units[0])
        if self.spec.channels is None and not self.axes:
            object.__setattr__(self, "axes", ("x", "y", "z"))
        self._check_words()
        self._check_shapes()

    def _check_words(self) -> None:
        units, axes = self.spec.units, self.axes
        checks = (
            ("unit", bool(self.input) or self.unit in units, f"{' or '.join(units)}, the unit of the values"),
            ("axes", set(axes) <= set("xyz") and len(set(axes)) == len(axes), "of x, y, z, each once"),
            ("side", self.side in (None, "motor", "output"), "motor or output"),
        )
        for key, is_right, allowed in checks:
            if not is_right:
                what = f"must be {allowed}, got {getattr(self, key)!r}"
                raise InvalidParameter(what, where=f"signals.{self.name}.{key}")

    @property
    def stamps(self) -> NDArray[Any]:
        """Return what tells rows apart, shape (n,): the pose, the frequency [Hz], or the time [s]."""
        if self.frequency is not None:
            return self.frequency
        return self.time if self.pose is None else self.pose

    def _check_shapes(self) -> None:
        stamps = self.stamps
        if self.values.ndim != 2 or stamps.shape != (len(self.values),):
            what = f"values of shape {self.values.shape} do not fit {stamps.shape} stamps"
            raise InvalidParameter(what, where=f"signals.{self.name}")
        wanted = (self.spec.channels or len(self.axes)) * (2 if self.input else 1)
        if self.values.shape[1] != wanted:
            what = f"has {self.values.shape[1]} channels; {self.quantity} needs {wanted}"
            raise InvalidParameter(what, where=f"signals.{self.name}")
        rises = np.diff(self.time)
        if not np.all(np.isfinite(self.time)) or np.any(rises <= 0):
            raise InvalidParameter("stamps must be finite and rise", where=f"signals.{self.name}.time")
        self._check_ranges(rises)
        if self.frequency is not None:
            self._check_response(self.frequency)

    def _check_response(self, frequency: Floats) -> None:
        rounding = 1e-6  # part by which a coherence may exceed 1
        where = f"signals.{self.name}"
        if not np.all(np.isfinite(frequency)) or np.any(frequency < 0) or np.any(np.diff(frequency) <= 0):
            what = "frequencies must be finite, at least 0 and rise"
            raise InvalidParameter(what, where=f"{where}.frequency")
        if self.coherence is not None and (
            self.coherence.shape != frequency.shape
            or np.any((self.coherence < 0) | (self.coherence > 1 + rounding))
        ):
            raise InvalidParameter("must lie within 0 to 1, one a frequency", where=f"{where}.coherence")
        if self.averages < 1:
            raise InvalidParameter(f"must be at least 1, got {self.averages}", where=f"{where}.averages")

    def _check_ranges(self, rises: Floats) -> None:
        for name, array, unit in (("values", self.values, self.unit), ("time", self.time, "s")):
            if at := first_beyond(array, unit):
                raise InvalidParameter(
                    str(out_of_range(float(array[at]), unit, size=False)),
                    where=f"signals.{self.name}.{name}[{at[0]}]",
                )
        least = range_of("s")[0]
        if np.any(rises < least):
            raise InvalidParameter(f"stamps must rise by {least:g} s", where=f"signals.{self.name}.time")
        for name in ("noise_std", "zero_std"):
            sigma = getattr(self, name)
            wrong = out_of_range(sigma, "unit", size=True)
            if sigma is not None and (wrong or not sigma >= 0):
                wrong = wrong or f"must be at least 0, got {sigma:g}"
                raise InvalidParameter(wrong, where=f"signals.{self.name}.{name}")
        if self.zero_std is not None and self.quantity in FRAMED:
            what = f"does not go with {self.quantity}, whose zero is that of its frame; state [frames]"
            raise InvalidParameter(what, where=f"signals.{self.name}.zero_std")

    @property
    def spec(self) -> Quantity:
        """The row of the table of quantities."""
        return QUANTITIES[self.quantity]

    @property
    def place(self) -> str:
        """Name of the joint, point, link or payload."""
        return self.joint or self.point or self.link or self.payload or ""

    @property
    def response(self) -> NDArray[np.complex128]:
        """Values of a frequency response, shape (n, channels)."""
        return np.asarray(self.values[:, ::2] + 1j * self.values[:, 1::2])

    @property
    def response_noise(self) -> Floats:
        r"""1 sigma of real and imaginary part, shape (n, channels); NaN where nothing is stated.

        Of a coherence \gamma^2 over n averages: ``|H| sqrt((1 - \gamma^2)/(2 n \gamma^2))``;
        else `noise_std`.
        """
        found = np.full(self.response.shape, np.nan if self.noise_std is None else self.noise_std)
        if self.coherence is None or self.noise_std is not None:
            return found
        square = np.clip(self.coherence, 1e-12, 1.0)[:, None]
        return np.abs(self.response) * np.sqrt((1 - square) / (2 * self.averages * square))

    @cached_property
    def valid(self) -> NDArray[np.bool_]:
        """Rows of which every channel holds a value, shape (n,)."""
        found: NDArray[np.bool_] = np.logical_and.reduce([np.isfinite(column) for column in self.values.T])
        found.setflags(write=False)
        return found

    @property
    def empty(self) -> tuple[str, ...]:
        """Channels without any value: axes, or x, y, z, w of a quaternion; "" of a scalar."""
        names = channel_names(self.quantity, self.axes)
        return tuple(
            name for name, column in zip(names, self.values.T, strict=True) if not np.isfinite(column).any()
        )

    @cached_property
    def grid_step(self) -> float:
        """Greatest quantisation step of the channels, as two readings show it; 0 where there is none."""
        return max(quantisation_step(column, fewest=2) for column in self.values.T)

    @cached_property
    def finest_step(self) -> float:
        """Least difference of two readings of its first channel, 0 if all are the same."""
        steps = np.diff(np.unique(self.values[self.valid, 0]))
        return float(np.min(steps)) if len(steps) else 0.0

    @cached_property
    def rate_hz(self) -> float:
        """Samples a second, from the median interval; NaN below two samples."""
        return float(1 / np.median(np.diff(self.time))) if len(self.time) > 1 else float("nan")

    def replace(self, **changes: Any) -> Signal:
        """Return a changed copy."""
        return replace(self, **changes)

    def __len__(self) -> int:
        return len(self.values)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Signal):
            return NotImplemented
        return all(_same(getattr(self, f.name), getattr(other, f.name)) for f in fields(self) if f.compare)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        lost = len(self) - int(self.valid.sum())
        return (
            f"<Signal {self.name!r}: {self.quantity} at {self.place}, {len(self)} x {self.values.shape[1]} "
            f"[{self.unit}]" + (f", {lost} drop-outs" if lost else "") + ">"
        )


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return bool(np.array_equal(a, b, equal_nan=a.dtype.kind == "f" and b.dtype.kind == "f"))
    return bool(a == b)


def canonical_pose(pose: str) -> str:
    """Return one spelling for a pose: "3" for 3, 3.0 and 03."""
    try:
        number = float(pose)
    except ValueError:
        return pose
    exact = abs(number) < 2**53  # neighbouring whole numbers differ as doubles
    return str(int(number)) if exact and number.is_integer() else pose
