"""Initial guess of unknown clocks and frames.

A clock: the delay at which measured and simulated speeds correlate best,

    delay = argmax corr(|y(t_{i+1}) - y(t_i)|, |x(t_{i+1} - delay) - x(t_i - delay)|)                 (1)

over all delays for which a quarter of the samples falls into the run: every 0.05 s with as coarse samples,
then from sample to sample about the best of these, last by the parabola through the best and its
neighbours. Speeds do not depend on frames. Readings that do not either, such as rates of turn, correlate
themselves, each channel with either sign: their steps show vibration above all, which a model without
damping has where the arm has none. A measured step counts as at most twice the greatest simulated one, and
so does a reading from the mean, so that outliers do not outweigh the motion. A frame: the rigid motion that
brings the measured points closest to the simulated ones [Kabsch1976],

    min sum |p_i - (R y_i + x)|^2,   R = V diag(1, 1, det(V U^T)) U^T,  U S V^T = svd(sum y p^T)     (2)

with centred y and p. Records share the clock or frame of one name: (1) then is the correlation of all their
steps, over the noise, and (2) is over the points of all. Effects of the model on sensors, clocks and frames
are taken back, so that guesses count from them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.alignment_parameters import is_unknown_clock
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.errors import InvalidParameter
from flexarm.measurement.clocks import ClockError
from flexarm.measurement.frames import IDENTITY, Registration
from flexarm.measurement.predict import read
from flexarm.measurement.sampling import columns
from flexarm.measurement.tracker import base_position, continuous
from flexarm.record import Signal


def initial_guess(simulated: SimulatedRecord, start: Placement) -> Placement:
    """Return `start` with unknown clocks (1) and frames (2) replaced by guesses from the data."""
    return initial_guesses([simulated], [start])[0]


def initial_guesses(simulations: Sequence[SimulatedRecord], starts: Sequence[Placement]) -> list[Placement]:
    """Return the same for several records, which share clocks and frames of one name.

    A clock or frame that one record knows starts there in all.

    Raise InvalidParameter if a clock cannot have one offset in all records that it is in.
    """
    found = list(starts)
    for name in dict.fromkeys(name for simulated in simulations for name in simulated.record.clocks):
        there = [
            k for k, s in enumerate(simulations) if name in s.record.clocks and s.record.kind == "motion"
        ]
        open_ = [k for k in there if is_unknown_clock(simulations[k].record, name)]
        known = [starts[k].clocks[name] for k in there if k not in open_]
        seen = [_highest_snr(simulations[k], name) for k in open_]
        moving = [
            (simulations[k], signal) for k, signal in zip(open_, seen, strict=True) if signal is not None
        ]
        if known or moving:
            clock = known[0] if known else ClockError(delay=_delay(name, moving))
            for k in open_:
                found[k] = replace(found[k], clocks={**found[k].clocks, name: clock})
    return _with_frames(simulations, found)


def _with_frames(simulations: Sequence[SimulatedRecord], starts: Sequence[Placement]) -> list[Placement]:
    """Replace unknown frames by (2), with clocks as they are."""
    found = list(starts)
    for name in dict.fromkeys(name for simulated in simulations for name in simulated.record.frames):
        there = [k for k, simulated in enumerate(simulations) if name in simulated.record.frames]
        open_ = [k for k in there if simulations[k].record.frames[name].unknown]
        known = [starts[k].frames[name] for k in there if k not in open_]
        points = [_points(simulations[k], starts[k], name) for k in open_]
        if known or any(len(base) for _, base in points):
            frame = known[0] if known else kabsch(*map(np.concatenate, zip(*points, strict=True)))
            for k in open_:
                found[k] = replace(found[k], frames={**found[k].frames, name: frame})
    return found


def _signal_to_noise(signal: Signal) -> float:
    """Return the signal-to-noise ratio of the motion of a signal."""
    spread = float(np.nanmax(np.nanstd(signal.values, axis=0)))
    return spread / (signal.noise_std or 1e-3 * spread or 1.0)


def _highest_snr(simulated: SimulatedRecord, clock: str) -> Signal | None:
    """Return the signal of a clock with the highest signal-to-noise ratio."""
    signals = [
        signal
        for signal in simulated.evidence.values()
        if signal.clock == clock
        and np.isfinite(simulated.effects(signal).true(signal.values)).all(axis=1).sum() > 3
    ]
    return max(signals, key=_signal_to_noise, default=None)


@dataclass(frozen=True)
class _Speeds:
    """Hold measured values at their stamps, and the simulated signal, both over the noise."""

    stamps: Floats
    values: Floats
    time: Floats
    predicted: Floats
    in_frame: bool
    """True if the readings depend on a frame: then their speeds correlate."""

    @classmethod
    def of(cls, simulated: SimulatedRecord, signal: Signal) -> _Speeds:
        noise = signal.noise_std or 1.0
        values = simulated.effects(signal).true(signal.values) / noise
        keep = np.isfinite(values).all(axis=1)
        stamps, values = simulated.instants(signal, Placement())[keep], values[keep]
        time = np.asarray(simulated.simulation.time)
        predicted = read(simulated.simulation, signal, time) / noise
        if signal.quantity == "orientation":
            values, predicted = continuous(values), continuous(predicted)
        return cls(stamps, values, time, predicted, signal.quantity in ("position", "orientation"))

    @cached_property
    def steps(self) -> Floats:
        """Return measured steps between stamps."""
        return np.asarray(np.linalg.norm(np.diff(self.values, axis=0), axis=1))

    def thinned(self, spacing: float) -> _Speeds:
        """Return the same over longer steps, of about this length [s]."""
        every = max(1, round(spacing / float(np.median(np.diff(self.stamps)))))
        kept = range(0, len(self.stamps), every)
        return replace(self, stamps=self.stamps[kept], values=self.values[kept]) if len(kept) > 3 else self

    def pairs(self, delay: float) -> tuple[Floats, Floats] | None:
        """Return centred measured and simulated steps or readings at one delay, shape (n, channels).

        None if too few lie in the run.
        """
        overlap = 0.25  # least share of the samples that must fall into the run
        instants = self.stamps - delay
        inside = (instants >= self.time[0]) & (instants <= self.time[-1])
        both = inside[1:] & inside[:-1]
        if both.sum() < max(3, overlap * len(both)):
            return None
        there = np.stack([np.interp(instants, self.time, channel) for channel in self.predicted.T], axis=1)
        if not self.in_frame:
            one, other = (each[inside] - each[inside].mean(axis=0) for each in (self.values, there))
            most = 2 * np.abs(other).max(axis=0)
            return np.clip(one, -most, most), other
        other = np.linalg.norm(np.diff(there, axis=0), axis=1)[both, None]
        one = np.minimum(self.steps[both, None], 2 * other.max())
        return one - one.mean(), other - other.mean()

    def agreement(self, pair: tuple[Floats, Floats]) -> float:
        """Return the sum of the products of a pair; of a reading's channels without their signs."""
        products = np.sum(pair[0] * pair[1], axis=0)
        return float(np.sum(products if self.in_frame else np.abs(products)))


def _delay(clock: str, moving: Sequence[tuple[SimulatedRecord, Signal]]) -> float:
    """Return the delay (1) over all records."""
    peaks = 3  # number of coarse delays about which finer ones are tried [1]: sines correlate at every period
    finest = 0.05  # greatest spacing of the delays that are tried [s]; the alignment refines the best
    tracks = [_Speeds.of(simulated, signal) for simulated, signal in moving]
    step = min(finest, *(float(np.median(np.diff(track.stamps))) for track in tracks))
    least = max(track.stamps[0] - track.time[-1] for track in tracks)
    most = min(track.stamps[-1] - track.time[0] for track in tracks)
    if most < least:
        raise InvalidParameter(
            f"cannot have one offset in all {len(tracks)} records: each would need another one. "
            "Clocks that were set anew need names of their own",
            where=f"clocks.{clock}",
        )
    delays, scores = _correlations([track.thinned(finest) for track in tracks], least, most, finest)
    found = []
    for peak in delays[np.argsort(-scores)[:peaks]]:
        near = max(least, peak - finest), min(most, peak + finest)
        delays, scores = _correlations(tracks, *near, step)
        best = int(np.argmax(scores))
        refined = delays[best] + step * _parabola_peak(scores[max(best - 1, 0) : best + 2])
        found.append((float(scores[best]), float(refined)))
    return max(found)[1]


def _correlations(tracks: Sequence[_Speeds], least: float, most: float, step: float) -> tuple[Floats, Floats]:
    """Return delays of a grid, and the correlation of (1) at each."""
    delays = np.arange(least, most + step, step)
    return delays, np.array([_correlation(tracks, delay) for delay in delays])


def _correlation(tracks: Sequence[_Speeds], delay: float) -> float:
    """Return the score of one delay; -1 where too few samples fall into a run.

    It is the correlation r of (1). Of readings it is their likelihood, -log(1 - r^2) for each sample, of all
    samples: r alone is large where two turns of the arm overlap and the rest does not.
    """
    pairs = [(track, pair) for track in tracks if (pair := track.pairs(delay)) is not None]
    if len(pairs) < len(tracks):
        return -1.0
    one, other = (sum(float(np.sum(pair[k] ** 2)) for _, pair in pairs) for k in (0, 1))
    if not one * other > 0:
        return -1.0
    r = sum(track.agreement(pair) for track, pair in pairs) / float(np.sqrt(one * other))
    if any(track.in_frame for track in tracks):
        return r
    share = sum(len(pair[0]) for _, pair in pairs) / sum(len(track.stamps) for track in tracks)
    return -share * float(np.log(max(1.0 - r**2, 1e-300)))


def _parabola_peak(scores: Floats) -> float:
    """Return the peak of the parabola through three values, from the middle, in steps; 0 at an end."""
    if len(scores) < 3 or scores.min() <= -1.0:
        return 0.0
    below, here, above = scores
    bend = below - 2 * here + above
    return float((below - above) / (2 * bend)) if bend < 0 else 0.0


def _points(simulated: SimulatedRecord, placement: Placement, frame: str) -> tuple[Floats, Floats]:
    """Return points measured in a frame, zero along axes not measured, and simulated in the base."""
    measured, predicted = [np.empty((0, 3))], [np.empty((0, 3))]
    for signal in simulated.evidence.values():
        if signal.frame != frame or signal.quantity != "position":
            continue
        instants = simulated.instants(signal, placement)
        known = base_position(simulated.simulation, signal, instants)
        seen = simulated.effects(signal)
        there = replace(seen.registration(IDENTITY), scale=1.0)
        known = there.positions(known, instants - simulated.simulation.time[0])
        full = np.zeros((len(signal), 3))
        full[:, columns(signal.axes)] = seen.true(signal.values) / seen.scale
        keep = np.isfinite(full).all(axis=1) & np.isfinite(known).all(axis=1)
        measured.append(full[keep])
        predicted.append(known[keep])
    return np.concatenate(measured), np.concatenate(predicted)


def kabsch(measured: Floats, base: Floats) -> Registration:
    """Return the frame (2) that maps measured points to points of the base, shape (n, 3)."""
    from scipy.spatial.transform import Rotation

    if len(base) == 0:
        return Registration()
    centre_y, centre_p = measured.mean(axis=0), base.mean(axis=0)
    u, _, vt = np.linalg.svd((measured - centre_y).T @ (base - centre_p))
    turn = vt.T @ np.diag([1.0, 1.0, float(np.sign(np.linalg.det(vt.T @ u.T)))]) @ u.T
    roll, pitch, yaw = Rotation.from_matrix(turn).as_euler("xyz", suppress_warnings=True).tolist()
    return Registration(origin=centre_p - turn @ centre_y, rpy=(roll, pitch, yaw))
