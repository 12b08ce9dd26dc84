"""Effects of sensors, clocks and frames: they change what is measured, not how the arm moves.

`flexarm.measurement.effects_of` collects those that act on a signal and puts their parts together:

    reading  = f_n(... f_2(f_1(true)))                 effects at signals, in the order stated there (1)
    stamp    = t + sum rate (t - t_0) + sum delay      effects at signals and clocks                 (2)
    measured = R(sum rotation) true + sum translation + sum velocity (t - t_0)     at frames         (3)

(3) is in the base's axes; in those of the frame it is multiplied by the product of all scales. t is true
time and t_0 the start of the run. Values are SI.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Annotated, ClassVar, Protocol

from pydantic import AfterValidator

from flexarm.arm.effect import Effect
from flexarm.quantities import channel_names

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from flexarm.arm.arm import Arm
    from flexarm.arm.prior import Prior

    Floats = NDArray[np.float64]

Channels = tuple[str, ...]
Vector = tuple[float, float, float]
ZERO: Vector = (0.0, 0.0, 0.0)


class Measured(Protocol):
    """The facts that sensors of a model and signals of a record share."""

    @property
    def name(self) -> str:
        """Name of the signal."""

    @property
    def quantity(self) -> str:
        """A key of `flexarm.quantities.QUANTITIES`."""

    @property
    def axes(self) -> Sequence[str] | None:
        """Directions of the channels."""


class SignalEffect(Effect):
    """An effect on the values of a signal."""

    quantities: ClassVar[tuple[str, ...]] = ()
    """What it can act on; empty: any quantity."""
    of_drives: ClassVar[bool] = False
    """True if a search looks for it in readings that drive the model, not in those compared with it."""
    rounds: ClassVar[bool] = False
    """True if readings are in steps, which have no derivative."""
    not_sought_in: ClassVar[tuple[str, ...]] = ()
    """Quantities in which another effect stands for it, such as a frame's registration."""

    @classmethod
    def sought_in(cls, quantity: str) -> bool:
        """Return True if a search looks for it in signals of a quantity."""
        return (not cls.quantities or quantity in cls.quantities) and quantity not in cls.not_sought_in

    @classmethod
    def priors_from(cls, greatest: float, noise: float, unit: str) -> dict[str, Prior]:
        """Return priors that follow from the greatest reading of a signal, and the noise in it."""
        return {}

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """If the model has a sensor of that name: why it cannot act there."""
        sensor = next((sensor for sensor in arm.sensors if sensor.name == self.at), None)
        why = self.misfit(sensor) if sensor is not None else None
        return [("at", why)] if why else []

    def misfit(self, what: Measured) -> str | None:
        """Why it cannot act on a signal; None if it can."""
        if self.quantities and what.quantity not in self.quantities:
            return f"acts on {' or '.join(self.quantities)}, but {what.name!r} measures {what.quantity}"
        return None

    def reading(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """f of (1), shape (n, channels): what becomes of a reading of the true values."""
        return reading

    def undone(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """(1) solved for the reading before; NaN where it is lost. `true` is as good as it is known yet."""
        return reading

    def noise(self, std: Floats, channels: Channels) -> Floats:
        """1 sigma of the noise after it, by channel, shape (channels,)."""
        return std


def _once(names: tuple[str, ...]) -> tuple[str, ...]:
    if len(set(names)) < len(names):
        raise ValueError(f"must name no channel twice, got {list(names)}")
    return names


class ChannelEffect(SignalEffect):
    """An effect on some channels of a signal."""

    channels: Annotated[tuple[str, ...], AfterValidator(_once)] = ()
    """Names of the channels: axes of a vector ("x", "y", "z"), x, y, z, w of a quaternion; left out: all. A
    scalar signal has one channel without a name."""

    def misfit(self, what: Measured) -> str | None:
        """As `SignalEffect.misfit`; also if the signal has not these channels."""
        known = channel_names(what.quantity, what.axes)
        unknown = [name for name in self.channels if name not in known]
        if unknown:
            there = ", ".join(known) if known != ("",) else "only one, without a name: leave channels out"
            return f"names channel {unknown[0]!r}; {what.name!r} has {there}"
        return super().misfit(what)

    def __str__(self) -> str:
        return super().__str__() + (f", channels {', '.join(self.channels)}" if self.channels else "")

    def acts_on(self, channels: Channels) -> list[bool]:
        """Which channels of a signal it acts on."""
        return [not self.channels or name in self.channels for name in channels]


class ClockEffect(Effect):
    """An effect on the stamps of a signal, or of all signals of a clock."""

    of_commands: ClassVar[bool] = False
    """True if a command may have it too."""

    @classmethod
    def command_priors(cls) -> dict[str, Prior]:
        """Return what is plausible at a command."""
        return {}

    def late(self) -> tuple[float, float]:
        """Delay [s] and rate [s/s] that it adds to (2)."""
        raise NotImplementedError


class FrameEffect(Effect):
    """An effect on a frame of measurement."""

    sees: ClassVar[tuple[str, ...]] = ("position", "orientation")
    """Quantities of the frame's signals in which it shows."""
    least_places: ClassVar[int] = 1
    """Least number of places in the frame that must be seen, by these, for a search to look for it."""

    def moved(self) -> tuple[Vector, Vector, Vector]:
        """Return the translation [m], rotation vector [rad] and velocity [m/s] that it adds to (3)."""
        raise NotImplementedError

    def enlarged(self) -> float:
        """Return the factor by which positions in the frame's own axes are measured too long."""
        return 1.0
