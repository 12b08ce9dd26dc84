"""What is compared: a simulation, and the signals of a record that it predicts.

Predictions are those of the model's imperfect sensors (`flexarm.measurement.effects_of`), but for two: steps
of an encoder are not rounded and count as noise, step/sqrt(12), and outliers, which nothing predicts, are
taken out of the record.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.measurement.clocks import EXACT, ClockError
from flexarm.measurement.effects_of import SensorEffects, effects_of
from flexarm.measurement.frames import IDENTITY, Registration
from flexarm.measurement.outliers import expected_outliers
from flexarm.measurement.predict import read
from flexarm.measurement.sampling import CannotMeasure, columns
from flexarm.record.plausibility import disjoint_signals

if TYPE_CHECKING:
    from flexarm.record import Record, Signal


@dataclass(frozen=True)
class Placement:
    """Clocks and frames of a record, as stated or as aligned.

    Attributes
    ----------
    clocks : dict of str to ClockError
        Against the clock of the drive, whose time is the simulation's.
    frames : dict of str to Registration
        Where the frames of measurement are.

    Effects of the model on clocks and frames are not in it; they come on top.
    """

    clocks: Mapping[str, ClockError] = field(default_factory=dict)
    frames: Mapping[str, Registration] = field(default_factory=dict)

    def clock(self, signal: Signal) -> ClockError:
        """The clock of a signal."""
        return self.clocks.get(signal.clock, ClockError())

    def frame(self, signal: Signal) -> Registration:
        """The frame of a signal."""
        return self.frames.get(signal.frame, IDENTITY)


@dataclass(frozen=True)
class SimulatedRecord:
    """A simulation beside a record.

    Attributes
    ----------
    simulation : Simulation
        The motion, or a sequence of poses whose time is the number of the pose.
    record : Record
        What was measured.
    stamps : dict of str to ndarray, shape (n,)
        Stamp of every row, by signal: its time, or the number of its pose.
    signals : dict of str to Signal
        Those that the simulation predicts.
    skipped : dict of str to str
        Why the others are not compared.
    arm : Arm
        The model whose effects on sensors, clocks and frames count.
    """

    simulation: Any
    record: Record
    stamps: Mapping[str, Floats]
    signals: Mapping[str, Signal]
    skipped: Mapping[str, str]
    arm: Any

    @property
    def evidence(self) -> dict[str, Signal]:
        """Signals that say something about the model: all that do not drive it."""
        return {name: signal for name, signal in self.signals.items() if name not in self.record.drive}

    def effects(self, signal: Signal) -> SensorEffects:
        """Effects of the model on a signal."""
        return effects_of(self.arm, signal)

    def clock(self, signal: Signal, placement: Placement) -> ClockError:
        """The clock of a signal, effects of the model included; numbers of poses are no stamps."""
        if self.record.kind == "static":
            return EXACT
        return self.effects(signal).clock(placement.clock(signal), float(self.simulation.time[0]))

    def frame(self, signal: Signal, placement: Placement) -> Registration:
        """The frame of a signal, effects of the model included."""
        return self.effects(signal).registration(placement.frame(signal))

    def axes(self, signal: Signal, placement: Placement) -> Floats:
        """Measured axes of a signal that is seen in a frame, as columns in the base, shape (3, axes)."""
        frame = self.frame(signal, placement)
        return np.asarray((frame.error_rotation.T @ frame.frame_axes)[:, columns(signal.axes)])

    def instants(self, signal: Signal, placement: Placement) -> Floats:
        """Time of the simulation at every row of a signal."""
        return self.clock(signal, placement).instants(self.stamps[signal.name])

    def predicted(self, signal: Signal, placement: Placement, hold: bool = False) -> Floats:
        """What the simulation says of a signal, shape (n, channels); with `hold` its end lasts for ever."""
        instants = self.instants(signal, placement)
        if hold:
            instants = np.minimum(instants, self.simulation.time[-1])
        true = read(self.simulation, signal, instants, self.frame(signal, placement))
        return self.effects(signal).reading(true, rounded=False)

    def residual(self, signal: Signal, placement: Placement, hold: bool = False) -> Floats:
        """Measured minus predicted, shape (n, channels); of orientations the rotation vector between them."""
        values = self.predicted(signal, placement, hold)
        return (
            rotation_between(signal.values, values)
            if signal.quantity == "orientation"
            else signal.values - values
        )

    def noise(self, signal: Signal) -> Floats:
        """1 sigma of the residual by component, 0 where not stated; a quaternion turns by half the angle."""
        if signal.quantity == "orientation":
            return np.full(3, 2.0 * (signal.noise_std or 0.0))
        return self.effects(signal).noise(signal.noise_std or 0.0)

    def outliers(self, signal: Signal, residual: Floats) -> NDArray[np.bool_]:
        """Rows of a residual that an effect `outliers` of the model explains, shape (n,)."""
        effect = self.effects(signal).outliers()
        if effect is None:
            return np.zeros(len(residual), dtype=bool)
        return expected_outliers(residual, self.noise(signal), effect)


def rotation_between(measured: Floats, predicted: Floats) -> Floats:
    """Rotation vector [rad] from the predicted to the measured orientation, frame axes, shape (n, 3)."""
    from scipy.spatial.transform import Rotation

    known = np.isfinite(measured).all(axis=1) & np.isfinite(predicted).all(axis=1)
    found = np.full((len(measured), 3), np.nan)
    if known.any():
        turn = Rotation.from_quat(measured[known]) * Rotation.from_quat(predicted[known]).inv()
        found[known] = turn.as_rotvec()
    return found


def pair_record(
    simulation: Any,
    record: Record,
    stamps: Mapping[str, Floats] | None = None,
    inputs: Mapping[str, str] | None = None,
    arm: Any = None,
) -> SimulatedRecord:
    """The signals of a record that a simulation predicts, and why not the others.

    Parameters
    ----------
    simulation : Simulation
        The motion.
    record : Record
        What was measured.
    stamps : dict, optional
        Stamps by signal; default: their times.
    inputs : dict of str to str, optional
        Signals not to be compared, and why.
    arm : Arm, optional
        The model whose effects on sensors, clocks and frames count; default: that of the simulation.
    """
    stamps = {name: signal.time for name, signal in record.signals.items()} if stamps is None else stamps
    kept: dict[str, Signal] = {}
    skipped = {**disjoint_signals(record), **(inputs or {})}
    for name, signal in record.signals.items():
        if name in skipped:
            continue
        if not signal.valid.any():
            skipped[name] = _empty(signal)
            continue
        try:
            read(simulation, signal, stamps[name][:1])
        except CannotMeasure as error:
            skipped[name] = str(error)
        else:
            kept[name] = signal
    return SimulatedRecord(simulation, record, stamps, kept, skipped, simulation.arm if arm is None else arm)


def _empty(signal: Signal) -> str:
    """Why a signal is not compared of which no row is whole, and what to do where a channel is to blame."""
    found = "no row holds a value in every channel"
    if 0 < len(signal.empty) < signal.values.shape[1]:
        return f"{found}, {', '.join(signal.empty)} holds none; leave it out of axes and channels"
    return found
