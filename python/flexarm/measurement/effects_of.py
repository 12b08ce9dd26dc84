"""Effects of an arm on a signal: its values, stamps and frame.

They act on a signal of a record, or a sensor of the model, at its name, its clock or its frame. An effect at
its point (`reflector_offset`) belongs to the machine: it moves the simulated point.

    values   true -> scale, eccentricity, harmonics, offsets -> + noise, rounded to the sensor's step  (1)
             -> saturation, quantisation -> sign, unit, dead channel -> outliers
    stamps   stamp = t + rate (t - t_0) + delay                                                      (2)
    frame    measured = scale R_f^T (R(rotation) true + translation + velocity (t - t_0) - x_f)      (3)

The order of (1) is that of `flexarm.arm.vocabulary`, whatever that of the model's file. Delays, rates,
translations, rotation vectors and velocities of all effects add up, and those that a record states and an
alignment finds add to them; scales multiply. t is the time of the run, t_0 its start, which is the true
instant of the first sample that drives it. Poses have no time: there clocks and velocities do not act.

The inverse of (1), from readings to true values, drives a simulation along an imperfect encoder.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import prod
from typing import Any, Protocol

import numpy as np

from flexarm.arm.sensor_effect import ClockEffect, FrameEffect, Measured, SignalEffect, Vector
from flexarm.arm.vocabulary import order_of
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter
from flexarm.measurement.clocks import ClockError
from flexarm.measurement.frames import Registration
from flexarm.quantities import channel_names


class Placed(Measured, Protocol):
    """Attributes that sensors and signals have in common, with their clock and frame."""

    @property
    def clock(self) -> str | None:
        """Name of the clock; None: of the reference."""

    @property
    def frame(self) -> str:
        """Name of the frame."""


@dataclass(frozen=True)
class SensorEffects:
    """Effects that act on one signal."""

    channels: tuple[str, ...] = ("",)
    """Names of the signal's channels."""
    before: tuple[SignalEffect, ...] = ()
    after: tuple[SignalEffect, ...] = ()
    """What acts before the noise enters and after it, in the order of (1)."""
    delay: float = 0.0
    rate: float = 0.0
    """Sums over the effects of (2) [s], [s/s]."""
    translation: Vector = (0.0, 0.0, 0.0)
    rotation: Vector = (0.0, 0.0, 0.0)
    velocity: Vector = (0.0, 0.0, 0.0)
    """Sums over the effects of (3) [m], [rad], [m/s]."""
    scale: float = 1.0
    """Product over the effects of (3)."""

    def sensed(self, true: Floats) -> Floats:
        """Return the transducer's output for true values, before the noise, shape (n, channels)."""
        values = true
        for effect in self.before:
            values = effect.reading(values, true, self.channels)
        return values

    def written(self, sensed: Floats, rounded: bool = True) -> Floats:
        """Return the written values of sensed ones; without rounding they have derivatives."""
        values = sensed
        for effect in self.after:
            if rounded or not effect.rounds:
                values = effect.reading(values, sensed, self.channels)
        return values

    def reading(self, true: Floats, rounded: bool = True) -> Floats:
        """Return the readings (1) of true values without noise, shape (n, channels)."""
        return self.written(self.sensed(true), rounded)

    def true(self, reading: Floats) -> Floats:
        """Return the true values of readings, eq. (1) solved by repeated substitution; NaN if lost.

        Raise InvalidParameter if it does not converge: an eccentricity then turns the reading back.
        """
        # Most repetitions of the inverse of (1); an eccentricity of half the scale takes 50.
        substitutions = 200
        if not self.before and not self.after:
            return reading
        found = self._undone(reading, reading)
        for _ in range(substitutions):
            last, found = found, self._undone(reading, found)
            size = np.max(np.abs(found), initial=1.0, where=np.isfinite(found))
            if np.max(np.abs(found - last), initial=0.0, where=np.isfinite(found)) <= 4e-16 * size:
                return found
        raise InvalidParameter(
            "readings do not tell the true angle; the amplitude must be less than the encoder's scale",
            where=f"effects.{next((e.name for e in self.before if e.is_wave), 'encoder_scale')}",
        )

    def _undone(self, reading: Floats, true: Floats) -> Floats:
        """Take back every effect of (1), the last one first."""
        for effect in reversed((*self.before, *self.after)):
            reading = effect.undone(reading, true, self.channels)
        return reading

    def noise(self, stated: float) -> Floats:
        """Return 1 sigma of the readings by channel [SI], from the stated one of a faultless sensor."""
        std = np.full(len(self.channels), stated)
        for effect in self.after:
            std = effect.noise(std, self.channels)
        return std

    def clock(self, clock: ClockError, start: float) -> ClockError:
        """Return a clock with the effects on its stamps, eq. (2), in a run that starts at `start` [s]."""
        if not self.delay and not self.rate:
            return clock
        own = clock.counted_from(start)
        return replace(own, delay=own.delay + self.delay, rate=own.rate + self.rate)  # eq. (2)

    def registration(self, frame: Registration) -> Registration:
        """Return a frame with the effects on it, eq. (3)."""
        if not any((*self.translation, *self.rotation, *self.velocity, self.scale - 1.0)):
            return frame
        return replace(
            frame,
            translation=np.add(frame.translation, self.translation),
            rotation=np.add(frame.rotation, self.rotation),
            velocity=np.add(frame.velocity, self.velocity),
            scale=frame.scale * self.scale,
        )  # eq. (3)

    def outliers(self) -> Any:
        """Return the effect `outliers`, or None."""
        return next((effect for effect in self.after if effect.name == "outliers"), None)


def effects_of(arm: Any, what: Placed, clock: str | None = None) -> SensorEffects:
    """Return the effects of an arm that act on a signal or sensor, which names its clock, or `clock` does.

    Raise InvalidParameter if one of them cannot act there, such as an encoder's on a position.
    """
    channels = channel_names(what.quantity, what.axes)
    effects = () if arm is None else arm.effects
    still = getattr(what, "pose", None) is not None
    named = {what.name, clock or what.clock}
    values = [e for e in effects if isinstance(e, SignalEffect) and e.at == what.name]
    clocks = [e for e in effects if isinstance(e, ClockEffect) and e.at in named and not still]
    frames = [e for e in effects if isinstance(e, FrameEffect) and e.at == (what.frame or "base")]
    if not (values or clocks or frames):
        return SensorEffects(channels)
    for effect in values:
        if why := effect.misfit(what):
            raise InvalidParameter(why, where=f"effects.{effect.name}.{effect.at}")
    values.sort(key=lambda effect: order_of(effect.name))
    late = [effect.late() for effect in clocks]
    moved = [effect.moved() for effect in frames]
    enters = order_of("saturation")
    return SensorEffects(
        channels,
        tuple(effect for effect in values if order_of(effect.name) < enters),
        tuple(effect for effect in values if order_of(effect.name) >= enters),
        sum(delay for delay, _ in late),
        sum(rate for _, rate in late),
        _sum(translation for translation, _, _ in moved),
        _sum(rotation for _, rotation, _ in moved),
        _sum(velocity for _, _, velocity in moved if not still),
        prod(effect.enlarged() for effect in frames),
    )


def _sum(vectors: Iterable[Vector]) -> Vector:
    x, y, z = map(sum, zip((0.0, 0.0, 0.0), *vectors, strict=True))
    return x, y, z
