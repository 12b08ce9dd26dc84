"""Alignment parameters: offsets of clocks and registrations of frames, as one vector.

    delay      of every clock but the drive's: Gaussian about its stated offset                      (1)
    (translation, rotation) of every frame: Gaussian about zero, per axis                            (2)

Sigmas are those of the record. Zero means exact and gives no parameter; "unknown" means no prior.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.clocks import ClockError
from flexarm.measurement.frames import Registration
from flexarm.record import Record, Signal

FRAME_PARAMETERS = ("translation", "rotation")
SEEN_IN_FRAMES = ("position", "orientation")
"""Quantities that are seen in a frame."""


@dataclass(frozen=True)
class AlignmentParameter:
    """Describe one parameter of an alignment."""

    place: str
    kind: str
    axis: str
    """Name of the clock or frame; "delay", "translation" or "rotation"; "", "x", "y" or "z"."""
    centre: float
    sigma: float
    """Prior [s, m, rad]; an infinite sigma is no prior."""
    step: float
    """Change for difference quotients."""

    @property
    def unit(self) -> str:
        """Return its unit."""
        return {"delay": "s", "translation": "m", "rotation": "rad"}[self.kind]

    def __str__(self) -> str:
        joined = {"delay": "", "translation": f" along {self.axis}", "rotation": f" about {self.axis}"}
        return f"{self.kind} of {self.place}{joined[self.kind]}"


def drive_clock(record: Record) -> str:
    """Return the clock of the drive, whose time is the simulation's; the reference without a drive."""
    return next((record.signals[name].clock for name in record.drive), record.reference_clock)


def is_unknown_clock(record: Record, clock: str) -> bool:
    """Return True if the offset between a clock and that of the drive is not stated."""
    own = drive_clock(record)
    return clock != own and (record.clocks[clock].unknown or record.clocks[own].unknown)


def stated_placement(record: Record) -> Placement:
    """Return clocks and frames as the record states them."""
    own = record.clocks[drive_clock(record)].offset
    clocks = {name: ClockError(delay=clock.offset - own) for name, clock in record.clocks.items()}
    frames = {name: Registration(origin=frame.xyz, rpy=frame.rpy) for name, frame in record.frames.items()}
    return Placement(clocks, frames)


def alignment_parameters(simulated: SimulatedRecord, start: Placement) -> list[AlignmentParameter]:
    """Return the alignment parameters of all compared signals."""
    record = simulated.record
    signals = [signal for signal in simulated.evidence.values() if has_noise(signal.noise_std)]
    found: list[AlignmentParameter] = []
    if record.kind == "motion":
        own = drive_clock(record)
        for name in dict.fromkeys(signal.clock for signal in signals):
            sigma = np.hypot(record.clocks[name].sigma, record.clocks[own].sigma)
            sigma = np.inf if is_unknown_clock(record, name) else float(sigma)
            if name != own and sigma > 0:
                found.append(AlignmentParameter(name, "delay", "", start.clocks[name].delay, sigma, 1e-4))
    framed = [signal for signal in signals if signal.quantity in SEEN_IN_FRAMES]
    for name in dict.fromkeys(signal.frame for signal in framed):
        frame = record.frames.get(name)
        if frame is not None:
            for kind, step in zip(FRAME_PARAMETERS, (1e-4, 1e-5), strict=True):
                sigma = np.inf if frame.unknown else getattr(frame, kind)
                found += [
                    AlignmentParameter(name, kind, axis, 0.0, sigma, step) for axis in "xyz" if sigma > 0
                ]
    return found


def uncertain_clock_and_frame(record: Record, signal: Signal) -> tuple[str, ...]:
    """Return as text the clock and frame of a signal that are not stated exactly."""
    found = []
    own = drive_clock(record)
    if record.kind == "motion" and signal.clock != own:
        sure = record.clocks[signal.clock].sigma == record.clocks[own].sigma == 0
        if is_unknown_clock(record, signal.clock) or not sure:
            found.append(f"clock {signal.clock}")
    frame = record.frames.get(signal.frame) if signal.quantity in SEEN_IN_FRAMES else None
    if frame is not None and (frame.unknown or frame.translation > 0 or frame.rotation > 0):
        found.append(f"frame {signal.frame}")
    return tuple(found)


def has_noise(noise_std: float | None) -> bool:
    """Return True if a noise is stated and not zero, so that the signal has a weight."""
    return noise_std is not None and noise_std > 0


def move_placement(start: Placement, parameters: list[AlignmentParameter], values: Floats) -> Placement:
    """Return clocks and frames at given values of the parameters."""
    clocks, frames = dict(start.clocks), dict(start.frames)
    moved: dict[tuple[str, str], Floats] = {}
    for each, value in zip(parameters, values, strict=True):
        if each.kind == "delay":
            clocks[each.place] = replace(clocks[each.place], delay=float(value))
        else:
            moved.setdefault((each.place, each.kind), np.zeros(3))["xyz".index(each.axis)] = value
    for name in {place for place, _ in moved}:
        translation, rotation = (moved.get((name, kind), np.zeros(3)) for kind in FRAME_PARAMETERS)
        frames[name] = replace(frames[name], translation=translation, rotation=rotation)
    return Placement(clocks, frames)
