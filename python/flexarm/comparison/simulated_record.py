"""A record with its simulation: the signals that the simulation predicts, and their residuals.

Predictions are those of the model's imperfect sensors (`flexarm.measurement.effects_of`), with two
exceptions: steps of an encoder are not rounded but count as noise, step/sqrt(12), and outliers are removed
from the record.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.measurement.clocks import EXACT, ClockError
from flexarm.measurement.effects_of import SensorEffects, effects_of
from flexarm.measurement.encoder import told
from flexarm.measurement.frames import IDENTITY, Registration
from flexarm.measurement.outliers import expected_outliers
from flexarm.measurement.predict import in_base, in_frame
from flexarm.measurement.sampling import CannotMeasure, columns
from flexarm.record import Record, Signal
from flexarm.record.plausibility import disjoint_signals


@dataclass(frozen=True)
class Placement:
    """Clocks of a record against that of its drive, whose time is the simulation's, and its frames.

    They are as stated or as aligned. Effects of the model on clocks and frames come on top.
    """

    clocks: Mapping[str, ClockError] = field(default_factory=dict)
    frames: Mapping[str, Registration] = field(default_factory=dict)

    def clock(self, signal: Signal) -> ClockError:
        """Return the clock of a signal."""
        return self.clocks.get(signal.clock, ClockError())

    def frame(self, signal: Signal) -> Registration:
        """Return the frame of a signal."""
        return self.frames.get(signal.frame, IDENTITY)


@dataclass(frozen=True)
class SimulatedRecord:
    """Hold a record with its simulation."""

    simulation: Any
    """The motion, or a sequence of poses whose time is the number of the pose."""
    record: Record
    stamps: Mapping[str, Floats]
    """Stamp of every row, by signal: its time, or the number of its pose, shape (n,)."""
    signals: Mapping[str, Signal]
    """Those that the simulation predicts."""
    skipped: Mapping[str, str]
    """Why the others are not compared."""
    arm: Any
    """The model whose effects on sensors, clocks and frames count."""
    _motions: dict[tuple[str, str], tuple[Floats, Floats]] = field(
        init=False, default_factory=dict, compare=False, repr=False
    )
    """Last instants of each signal and its readings in the base there: mostly frames and clocks stay."""
    _effects: dict[tuple[str, str, str], SensorEffects] = field(
        init=False, default_factory=dict, compare=False, repr=False
    )

    @property
    def evidence(self) -> dict[str, Signal]:
        """Return the predicted signals that do not drive the model."""
        return {name: signal for name, signal in self.signals.items() if name not in self.record.drive}

    def effects(self, signal: Signal) -> SensorEffects:
        """Return effects of the model on a signal."""
        key = (signal.name, signal.clock, signal.frame)
        if key not in self._effects:
            self._effects[key] = effects_of(self.arm, signal)
        return self._effects[key]

    def clock(self, signal: Signal, placement: Placement) -> ClockError:
        """Return the clock of a signal with effects of the model; poses have none."""
        if self.record.kind == "static":
            return EXACT
        return self.effects(signal).clock(placement.clock(signal), float(self.simulation.time[0]))

    def frame(self, signal: Signal, placement: Placement) -> Registration:
        """Return the frame of a signal with effects of the model."""
        return self.effects(signal).registration(placement.frame(signal))

    def axes(self, signal: Signal, placement: Placement) -> Floats:
        """Return measured axes of a signal seen in a frame, as columns in the base, shape (3, axes)."""
        frame = self.frame(signal, placement)
        return np.asarray((frame.error_rotation.T @ frame.frame_axes)[:, columns(signal.axes)])

    def instants(self, signal: Signal, placement: Placement) -> Floats:
        """Return the time of the simulation at every row of a signal."""
        return self.clock(signal, placement).instants(self.stamps[signal.name])

    def predicted(self, signal: Signal, placement: Placement, hold: bool = False) -> Floats:
        """Predict a signal, shape (n, channels); `hold` extends the end of the simulation."""
        instants = self.instants(signal, placement)
        if hold:
            instants = np.minimum(instants, self.simulation.time[-1])
        what = told(self.simulation, signal, self.record.drive)
        return self.reading(what, instants, placement)

    def reading(self, signal: Signal, instants: Floats, placement: Placement) -> Floats:
        """Return what the model's sensor shows at given instants, without rounding, shape (n, channels)."""
        motion = self._motion(signal, instants)
        true = in_frame(self.simulation, signal, instants, motion, self.frame(signal, placement))
        return self.effects(signal).reading(true, rounded=False)

    def _motion(self, what: Signal, instants: Floats) -> Floats:
        """Return readings in the base, those of the last call where the instants are the same."""
        key = (what.name, what.quantity)
        last = self._motions.get(key)
        if last is not None and np.array_equal(last[0], instants):
            return last[1]
        found = in_base(self.simulation, what, instants)
        self._motions[key] = instants, found
        return found

    def residual(self, signal: Signal, placement: Placement, hold: bool = False) -> Floats:
        """Return measured minus predicted, shape (n, channels); for orientations a rotation vector."""
        values = self.predicted(signal, placement, hold)
        if signal.quantity == "orientation":
            return rotation_between(signal.values, values)
        return signal.values - values

    def noise(self, signal: Signal) -> Floats:
        """Return 1 sigma of the residual by component, 0 if not stated."""
        if signal.quantity == "orientation":
            return np.full(3, 2.0 * (signal.noise_std or 0.0))
        return self.effects(signal).noise(signal.noise_std or 0.0)

    def outliers(self, signal: Signal, residual: Floats) -> NDArray[np.bool_]:
        """Return rows of a residual that an effect `outliers` of the model explains, shape (n,)."""
        effect = self.effects(signal).outliers()
        if effect is None:
            return np.zeros(len(residual), dtype=bool)
        return expected_outliers(residual, self.noise(signal), effect)


def rotation_between(measured: Floats, predicted: Floats) -> Floats:
    """Return the rotation vector [rad] from predicted to measured orientation, frame axes, shape (n, 3)."""
    from scipy.spatial.transform import Rotation

    known = np.isfinite(predicted).all(axis=1) & np.any(measured != 0, axis=1)  # zeros: tracking was lost
    known &= np.isfinite(measured).all(axis=1)
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
    """Pair a record with a simulation: its predicted signals, and reasons for the others.

    `stamps` by signal are by default their times, and `inputs` says why signals are not compared. `arm` is
    the model whose effects on sensors, clocks and frames count; default: that of the simulation.
    """
    stamps = {name: signal.time for name, signal in record.signals.items()} if stamps is None else stamps
    kept: dict[str, Signal] = {}
    skipped = {**disjoint_signals(record), **(inputs or {})}
    for name, signal in record.signals.items():
        if name in skipped:
            continue
        if not signal.valid.any():
            skipped[name] = "no row holds a value in every channel"
            if 0 < len(signal.empty) < signal.values.shape[1]:
                skipped[name] += f", {', '.join(signal.empty)} holds none; leave it out of axes and channels"
            continue
        try:
            in_base(simulation, signal, stamps[name][:1])
        except CannotMeasure as error:
            skipped[name] = str(error)
        else:
            kept[name] = signal
    return SimulatedRecord(simulation, record, stamps, kept, skipped, simulation.arm if arm is None else arm)
