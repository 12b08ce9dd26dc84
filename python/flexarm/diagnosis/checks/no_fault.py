"""What sensors and arms do without being at fault, as columns beside a channel's prediction.

They enter `checks.regression` as columns c with sizes S, far wider than any record states, so that a missing
effect is not taken for a faulty sensor:

    offset       1                    a sensor's or frame's                                           (1)
    turn         the other axes       frame, sensor or arm lean by up to 0.05 rad                     (2)
    delay        -dp/dt               at least 0.03 s, and three sigma of the clock                   (3)
    friction     sgn v, v             of torques: as large as the torque itself                       (4)
"""

from __future__ import annotations

from dataclasses import replace
from math import hypot
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.sizes import reach
from flexarm.arrays import Floats
from flexarm.comparison.subject import Placement, Subject
from flexarm.comparison.unknowns import drive_clock
from flexarm.measurement.predict import read
from flexarm.measurement.sampling import sample

if TYPE_CHECKING:
    from flexarm.record import Signal

TURN = 0.05
"""S of (2) [rad]."""
LATE = 0.03
"""S of (3) [s] where the clock is known better."""
SHORT = 5e-3
"""Half the difference of time for dp/dt of (3) [s]."""
OFFSETS = {"joint_angle": 0.1, "inclination": 0.05, "orientation": 0.05, "angular_rate": 0.05}
"""S of (1) [SI]; positions: 2 % of the reach; accelerations: 0.5 m/s2; infinite where none is given."""


def values_at(subject: Subject, signal: Signal, placement: Placement, shift: float = 0.0) -> Floats:
    """What the simulation says of a signal whose clock is late by `shift` [s] more."""
    instants = np.minimum(subject.instants(signal, placement) - shift, subject.simulation.time[-1])
    return subject.effects(signal).reading(
        read(subject.simulation, signal, instants, subject.frame(signal, placement)), rounded=False
    )


def columns_of(
    subject: Subject, signal: Signal, placement: Placement, predicted: Floats, k: int
) -> tuple[Floats, Floats]:
    """c and S of (1) to (4) for channel k of a signal."""
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
