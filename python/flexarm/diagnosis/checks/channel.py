"""One channel of one record beside the nominal model: readings, prediction, and what is no fault.

What sensors and arms do without being at fault enters `checks.regression` as columns c with
sizes S, far wider than any record states, so that a missing effect is not taken for a faulty sensor:

    offset       1                    a sensor's or frame's                                           (1)
    turn         the other axes       frame, sensor or arm lean by up to 0.05 rad                     (2)
    delay        -dp/dt               at least 0.03 s, and three sigma of the clock                   (3)
    friction     sgn v, v             of torques: as large as the torque itself                       (4)

and a part of the motion is missed by any nominal model: `floor`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.sizes import reach
from flexarm.arrays import Floats
from flexarm.comparison.subject import Placement, Subject
from flexarm.comparison.unknowns import drive_clock
from flexarm.diagnosis.checks.regression import Fit, scatter_at, slope_of
from flexarm.measurement.predict import read
from flexarm.measurement.sampling import sample
from flexarm.quantities import channel_names

if TYPE_CHECKING:
    from flexarm.record import Signal

TURN = 0.05
"""S of (2) [rad]."""
LATE = 0.03
"""S of (3) [s] where the clock is known better."""
SHORT = 5e-3
"""Half the difference of time for dp/dt of (3) [s]."""
MISSED = {"motor_torque": 0.1, "motor_voltage": 0.1, "strain": 0.1, "acceleration": 0.1, "angular_rate": 0.1}
"""Share of the motion that a nominal model misses, by quantity; else `MISSED_ELSE`."""
MISSED_ELSE = 0.03
AMISS = {"position": 1e-3, "deflection": 1e-3, "joint_angle": 1e-3, "inclination": 1e-3, "orientation": 1e-3}
"""What it misses whatever the motion: a share of the reach of the arm, or an angle [rad]."""
OFFSETS = {"joint_angle": 0.1, "inclination": 0.05, "orientation": 0.05, "angular_rate": 0.05}
"""S of (1) [SI]; positions: 2 % of the reach; accelerations: 0.5 m/s2; infinite where none is given."""


@dataclass(frozen=True, eq=False)
class Channel:
    """Readings of a channel, rows without a value left out.

    Attributes
    ----------
    record : str
        Name of the record.
    signal : Signal
        With all its channels.
    index : int
        Which of them.
    rows : ndarray of int, shape (n,)
        Rows of the signal.
    time : ndarray, shape (n,)
        Instants in the simulation's time [s], or numbers of poses.
    measured, predicted : ndarray, shape (n,)
        Readings and what the nominal model says.
    columns, sizes : ndarray, shapes (n, k) and (k,)
        c and S.
    noise, floor : float
        1 sigma of the readings, as stated, if they scatter by as much; what the nominal model misses [SI].
    size : float
        The reach of the arm for lengths [m], else 1.
    driven : ndarray of bool, shape (n,)
        Whether a drive moves; where none does, an arm may be at rest, and a model without damping rings on.
    """

    record: str
    signal: Signal
    index: int
    rows: NDArray[np.intp]
    time: Floats
    measured: Floats
    predicted: Floats
    columns: Floats
    sizes: Floats
    noise: float
    floor: float
    size: float
    driven: NDArray[np.bool_]

    @property
    def name(self) -> str:
        """As effects name channels: an axis, or "" of a scalar."""
        return channel_names(self.signal.quantity, self.signal.axes)[self.index]

    @property
    def label(self) -> str:
        """For a person: the signal, and which channel of several."""
        return f"{self.signal.name} {self.name}".rstrip()

    def fit(self) -> Fit:
        """How the readings follow the prediction."""
        return slope_of(self.measured, self.predicted, self.columns, self.sizes, self.noise, self.floor)

    def scatter(self, slope: float) -> float:
        """What is left of the readings by a slope that is given."""
        args = (self.measured, self.predicted, self.columns, self.sizes, self.noise, self.floor)
        return scatter_at(slope, *args)

    def left(self) -> Floats:
        """Residual of the best slope and columns without priors; a tenth of the rows does not count."""
        A = np.column_stack([self.predicted, self.columns])
        A = A / np.maximum(np.linalg.norm(A, axis=0), 1e-300)
        keep = np.ones(len(A), dtype=bool)
        for _ in range(3):
            found = self.measured - A @ np.linalg.lstsq(A[keep], self.measured[keep], rcond=1e-9)[0]
            keep = np.abs(found) <= np.quantile(np.abs(found), 0.9)
        return np.asarray(found)

    def part(self, keep: NDArray[np.bool_]) -> Channel:
        """Some of its rows."""
        arrays = {
            key: getattr(self, key)[keep]
            for key in ("rows", "time", "measured", "predicted", "columns", "driven")
        }
        return replace(self, **arrays)


LEAST_ROWS = 6
STANDS = 0.05
"""Part of a drive's greatest rate below which it stands."""


def channels(name: str, subject: Subject, placement: Placement) -> list[Channel]:
    """All channels of a record that the simulation predicts and that hold enough values."""
    return [
        channel
        for signal in subject.evidence.values()
        for channel in _of_signal(name, subject, placement, signal)
        if len(channel.rows) >= LEAST_ROWS
    ]


def values_at(subject: Subject, signal: Signal, placement: Placement, shift: float = 0.0) -> Floats:
    """What the simulation says of a signal whose clock is late by `shift` [s] more."""
    instants = np.minimum(subject.instants(signal, placement) - shift, subject.simulation.time[-1])
    return subject.effects(signal).reading(
        read(subject.simulation, signal, instants, subject.frame(signal, placement)), rounded=False
    )


def _of_signal(name: str, subject: Subject, placement: Placement, signal: Signal) -> list[Channel]:
    predicted = values_at(subject, signal, placement)
    measured = _nearer_sign(signal, predicted)
    instants = subject.instants(signal, placement)
    found = []
    for k in range(measured.shape[1]):
        keep = np.isfinite(measured[:, k]) & np.isfinite(predicted[:, k])
        columns, sizes = _columns(subject, signal, placement, predicted, k)
        moving = float(np.std(predicted[keep, k])) if keep.any() else 0.0
        stated = float(subject.effects(signal).noise(signal.noise_std or 0.0)[k])
        noise = min(stated, _step_to_step(measured[keep, k]))
        found.append(
            Channel(
                name,
                signal,
                k,
                np.flatnonzero(keep),
                instants[keep],
                measured[keep, k],
                predicted[keep, k],
                columns[keep],
                sizes,
                noise or 1e-6 * moving,
                _floor(subject, signal, moving),
                reach(subject.arm) if signal.unit == "m" else 1.0,
                _driven(subject, instants[keep]),
            )
        )
    return found


def _driven(subject: Subject, instants: Floats) -> NDArray[np.bool_]:
    """Where some drive moves by more than a part `STANDS` of its greatest rate; everywhere in poses."""
    if subject.record.kind == "static":
        return np.ones(len(instants), dtype=bool)
    run = subject.simulation
    rate = np.abs(np.asarray(run.drive_rate))
    moving = np.any(rate > STANDS * np.max(rate, axis=0), axis=1)
    found: NDArray[np.bool_] = np.interp(instants, run.time, moving.astype(float)) > 0
    return found


def _step_to_step(y: Floats) -> float:
    """Scatter from one reading to the next: no sensor has more noise, whatever is stated."""
    return float(np.std(np.diff(y)) / np.sqrt(2)) if len(y) > 2 else 0.0


def _nearer_sign(signal: Signal, predicted: Floats) -> Floats:
    """Readings; of the two quaternions of one orientation the one nearer to the prediction."""
    if signal.quantity != "orientation":
        return signal.values
    sign = np.sign(np.sum(signal.values * predicted, axis=1))
    return signal.values * np.where(sign == 0, 1.0, sign)[:, None]


def _floor(subject: Subject, signal: Signal, moving: float) -> float:
    """What a nominal model misses of a channel [SI]."""
    absolute = AMISS.get(signal.quantity, 0.0)
    if signal.unit == "m":
        absolute = AMISS["position"] * reach(subject.arm)
    return float(np.hypot(absolute, MISSED.get(signal.quantity, MISSED_ELSE) * moving))


def _columns(
    subject: Subject, signal: Signal, placement: Placement, predicted: Floats, k: int
) -> tuple[Floats, Floats]:
    """c and S of (1) to (4)."""
    n = len(predicted)
    columns, sizes = [np.ones(n)], [_offset(subject, signal)]  # eq. (1)
    for other in _other_axes(subject, signal, placement, k):
        columns.append(other)
        sizes.append(TURN)  # eq. (2)
    if subject.record.kind == "motion":
        ahead, behind = (values_at(subject, signal, placement, shift)[:, k] for shift in (-SHORT, SHORT))
        columns.append((behind - ahead) / (2 * SHORT))  # eq. (3)
        sizes.append(max(LATE, 3 * _clock_sigma(subject, signal)))
        if signal.quantity in ("motor_torque", "motor_voltage"):
            columns += _friction(subject, signal, placement)  # eq. (4)
            sizes += [3 * float(np.nanstd(predicted[:, k]))] * 2
    return np.column_stack(columns), np.array(sizes)


def _offset(subject: Subject, signal: Signal) -> float:
    """S of (1)."""
    if signal.quantity == "position":
        frame = subject.record.frame_of(signal)
        own = 0.02 * reach(subject.arm)
        return float("inf") if frame.unknown else max(own, 5 * float(np.max(frame.translation)))
    if signal.quantity == "acceleration":
        return 0.5
    return float("inf") if signal.unit == "m" else OFFSETS.get(signal.quantity, float("inf"))


def _other_axes(subject: Subject, signal: Signal, placement: Placement, k: int) -> list[Floats]:
    """What the other axes would show, of vectors; of orientations the other channels."""
    if signal.quantity == "orientation":
        values = values_at(subject, signal, placement)
        return [np.nan_to_num(values[:, j]) for j in range(4) if j != k]
    if signal.quantity not in ("position", "acceleration", "angular_rate"):
        return []
    whole = signal.replace(axes=("x", "y", "z"), channels=(), values=np.zeros((len(signal), 3)))
    bare = subject.arm.replace(effects=(), uncertainty={})  # axes that were not measured have none
    clean = replace(subject, arm=bare)
    values = values_at(clean, whole, placement)
    return [np.nan_to_num(values[:, j]) for j, axis in enumerate("xyz") if axis != signal.axes[k]]


def _clock_sigma(subject: Subject, signal: Signal) -> float:
    """1 sigma of the delay between a signal's clock and the drive's [s]; unknown: a first guess's."""
    both = [subject.record.clocks[name] for name in {signal.clock, drive_clock(subject.record)}]
    return 0.05 if any(clock.unknown for clock in both) else hypot(*(clock.sigma for clock in both))


def _friction(subject: Subject, signal: Signal, placement: Placement) -> list[Floats]:
    """sgn v and v of the joint, scaled to 1."""
    run = subject.simulation
    rate = np.asarray(run.drive_rate)[:, run.joints.index(signal.joint)]
    v = sample(run.time, rate, np.minimum(subject.instants(signal, placement), run.time[-1]))
    fastest = float(np.max(np.abs(v), initial=0.0)) or 1.0
    return [np.tanh(v / (1e-2 * fastest)), v / fastest]
