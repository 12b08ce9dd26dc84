"""Where an alignment starts when a clock or a frame is unknown.

A clock: the delay at which measured and simulated speeds correlate best,

    delay = argmax corr(|y(t_{i+1}) - y(t_i)|, |x(t_{i+1} - delay) - x(t_i - delay)|)                 (1)

over all delays for which a quarter of the samples falls into the run. Speeds do not depend on where a frame
is. A frame: the rigid motion that brings the measured points closest to the simulated ones [Kabsch1976],

    min sum |p_i - (R y_i + x)|^2,   R = V diag(1, 1, det(V U^T)) U^T,  U S V^T = svd(sum y p^T)     (2)

with centred y and p. Effects of the model on sensors, clocks and frames are taken back from what was measured
or put on what was simulated, so that guesses count from them.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.subject import Placement, Subject
from flexarm.measurement.clocks import ClockError
from flexarm.measurement.frames import IDENTITY, Registration
from flexarm.measurement.predict import read
from flexarm.measurement.sampling import columns
from flexarm.measurement.tracker import base_position

if TYPE_CHECKING:
    from flexarm.record import Signal

OVERLAP = 0.25
"""Least share of the samples that must fall into the run."""
FINEST = 0.05
"""Greatest spacing of the delays that are tried [s]; the alignment refines the best."""


def first_guess(subject: Subject, start: Placement) -> Placement:
    """`start` with unknown clocks (1) and frames (2) replaced by guesses from the data."""
    record = subject.record
    clocks, frames = dict(start.clocks), dict(start.frames)
    for name, clock in record.clocks.items():
        signals = [s for s in subject.evidence.values() if s.clock == name and _usable(subject, s)]
        if clock.unknown and signals:
            clocks[name] = ClockError(delay=_delay(subject, max(signals, key=_liveliness)))
    placement = replace(start, clocks=clocks)
    for name, frame in record.frames.items():
        seen = [s for s in subject.evidence.values() if s.frame == name and s.quantity == "position"]
        if frame.unknown and seen:
            frames[name] = _pose(subject, placement, seen)
    return Placement(clocks, frames)


def _usable(subject: Subject, signal: Signal) -> bool:
    """Whether enough rows tell a true value in every channel."""
    known = np.isfinite(subject.effects(signal).true(signal.values)).all(axis=1)
    return int(known.sum()) > 3


def _liveliness(signal: Signal) -> float:
    """How far a signal's motion stands out of its noise."""
    spread = float(np.nanmax(np.nanstd(signal.values, axis=0)))
    return spread / (signal.noise_std or 1e-3 * spread or 1.0)


def _delay(subject: Subject, signal: Signal) -> float:
    """Delay of (1)."""
    values = subject.effects(signal).true(signal.values)
    keep = np.isfinite(values).all(axis=1)
    stamps, values = subject.instants(signal, Placement())[keep], values[keep]
    time = np.asarray(subject.simulation.time)
    simulated = read(subject.simulation, signal, time)
    speed = np.linalg.norm(np.diff(values, axis=0), axis=1)
    step = min(float(np.median(np.diff(stamps))), FINEST)
    delays = np.arange(stamps[0] - time[-1], stamps[-1] - time[0] + step, step)
    scores = [_correlation(speed, stamps - delay, time, simulated) for delay in delays]
    return float(delays[int(np.argmax(scores))])


def _correlation(speed: Floats, instants: Floats, time: Floats, simulated: Floats) -> float:
    """Correlation of (1) at one delay; -1 where too few samples fall into the run."""
    inside = (instants >= time[0]) & (instants <= time[-1])
    both = inside[1:] & inside[:-1]
    if both.sum() < max(3, OVERLAP * len(both)):
        return -1.0
    there = np.stack([np.interp(instants, time, channel) for channel in simulated.T], axis=1)
    other = np.linalg.norm(np.diff(there, axis=0), axis=1)[both]
    one, other = speed[both] - speed[both].mean(), other - other.mean()
    size = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(one @ other) / size if size > 0 else -1.0


def _pose(subject: Subject, placement: Placement, signals: list[Signal]) -> Registration:
    """Pose of a frame in the base by (2); axes that were not measured count as zero."""
    measured, simulated = [], []
    for signal in signals:
        instants = subject.instants(signal, placement)
        known = base_position(subject.simulation, signal, instants)
        seen = subject.effects(signal)
        known = seen.registration(IDENTITY).positions(known, instants - subject.simulation.time[0])
        full = np.zeros((len(signal), 3))
        full[:, columns(signal.axes)] = seen.true(signal.values)
        keep = np.isfinite(full).all(axis=1) & np.isfinite(known).all(axis=1)
        measured.append(full[keep])
        simulated.append(known[keep])
    y, p = np.concatenate(measured), np.concatenate(simulated)
    return kabsch(y, p)


def kabsch(measured: Floats, base: Floats) -> Registration:
    """The frame in which points of the base, shape (n, 3), are seen where they were measured: eq. (2)."""
    from scipy.spatial.transform import Rotation

    if len(base) == 0:
        return Registration()
    centre_y, centre_p = measured.mean(axis=0), base.mean(axis=0)
    u, _, vt = np.linalg.svd((measured - centre_y).T @ (base - centre_p))
    turn = vt.T @ np.diag([1.0, 1.0, float(np.sign(np.linalg.det(vt.T @ u.T)))]) @ u.T
    roll, pitch, yaw = Rotation.from_matrix(turn).as_euler("xyz")
    return Registration(origin=centre_p - turn @ centre_y, rpy=(float(roll), float(pitch), float(yaw)))
