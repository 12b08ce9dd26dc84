r"""Free vibration of a record without a drive that begins in motion: tap, pluck and drop tests.

What the arm was given nobody knows. Its modes ring from amplitudes that the record itself shows,

.. math:: s(t) = \sum_w B_w(t) \, e^{A (t - t_w)} s_w                                                (1)

with hats B_w of which two overlap at any time and add up to one, `periods` periods of the record apart. A
right model rings on from one to the next; a wrong frequency or damping leaves a gap within each, but does not
fall out of step over the whole record, so that fits find their way from far. The s_w are those of least
squares,

.. math:: \min \sum \big( y_i - y_0 - c - C s(t_i) \big)^2 / \sigma^2                                (2)

with y_0 the readings of the equilibrium, C those of each state, and an offset c for each channel, that is
left out of the prediction. A row holds the s_w of two hats, and so a QR factorisation goes from interval to
interval between two tops and eliminates one s_w after the other [Golub2013]. Clocks and frames are as stated;
signals of unknown ones are not used.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.comparison.alignment_parameters import is_unknown_clock, stated_placement
from flexarm.comparison.simulated_record import Placement, SimulatedRecord, pair_record
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter
from flexarm.linear.free_motion import FreeMotion, free_motion
from flexarm.measurement.predict import read
from flexarm.measurement.state_snapshots import StateSnapshots
from flexarm.record import Record, Signal

Indices = NDArray[np.intp]


MODES = 6
"""Most modes that ring, of those that the fastest signal can show, and most that are told."""


def rings_freely(record: Record) -> bool:
    """Return True for a motion that nothing drives and that does not begin at rest."""
    return record.kind == "motion" and record.initial == "moving" and not record.drive


def simulate_free_vibration(arm: Arm, record: Record, step: float) -> StateSnapshots:
    """Return the free vibration (1) of a model that is nearest to a record, by (2), at a time step [s].

    The record has no drive and `initial = "moving"`.

    Raise InvalidParameter if no signal of a known clock and frame shows the vibration, and NotConverged if
    the arm has no stable equilibrium.
    """
    drive = Drive.from_record(record, arm)
    time = np.linspace(drive.start, drive.end, max(int(np.ceil((drive.end - drive.start) / step)), 1) + 1)
    motion = free_motion(arm, record.joints, MODES)
    pair = pair_record(motion.run(np.zeros(len(motion.A)), time[[0, -1]]), record, arm=arm)
    placement = stated_placement(record)
    seen = [_Channels.of(pair, signal, placement, motion) for signal in _usable(pair)]
    if not seen or not len(motion.A):
        what = "shows no free vibration: needed is a signal of a known clock and frame at a place that swings"
        raise InvalidParameter(what, where="signals")
    hats = _Hats.over(drive.start, drive.end, _dominant_frequency(seen))
    n, nyquist = len(motion.A) // 2, max(each.nyquist for each in seen)
    count = max(int(np.sum(_frequencies(motion) / (2 * np.pi) < nyquist)), 1)
    free = np.concatenate([np.arange(count), n + np.arange(count)])
    return motion.along(hats.states(motion, _amplitudes(motion, hats, free, seen), time), time)


def _usable(pair: SimulatedRecord) -> Iterator[Signal]:
    """Yield signals of known clocks and frames that hold values."""
    for signal in pair.evidence.values():
        unknown = is_unknown_clock(pair.record, signal.clock) or pair.record.frame_of(signal).unknown
        if not unknown and len(signal.time) > 1 and signal.valid.sum() > 1:
            yield signal


@dataclass(frozen=True, eq=False)
class _Channels:
    """A signal over its noise, and what it shows of each state."""

    time: Floats
    gap: Floats
    """Instants [s], and readings less those of the equilibrium, over the noise; NaN where there are none."""
    by_state: Floats
    """C of (2) over the noise, shape (channels, state)."""
    nyquist: float
    """Half the sampling rate [Hz]."""

    @classmethod
    def of(cls, pair: SimulatedRecord, signal: Signal, placement: Placement, motion: FreeMotion) -> _Channels:
        small = 1e-4  # motion for the derivatives of readings, of the array that moves most [SI]
        n = len(motion.A)
        size = np.max([np.abs(s).reshape(-1, n).max(axis=0, initial=0.0) for s in motion.slopes.values()], 0)
        steps = small / np.maximum(size, 1e-300)
        states = motion.along(np.vstack([np.zeros(n), np.diag(steps)]), np.arange(n + 1.0))
        effects = pair.effects(signal)
        shown = effects.reading(read(states, signal, states.time, pair.frame(signal, placement)), False)
        noise = pair.noise(signal)
        noise = np.where(noise > 0, noise, 1e-3 * float(np.nanmax(np.nanstd(signal.values, axis=0))) or 1.0)
        return cls(
            pair.instants(signal, placement),
            (signal.values - shown[0]) / noise,
            (shown[1:] - shown[0]).T / steps / noise[:, None],
            0.5 * float(signal.rate_hz),
        )


@dataclass(frozen=True)
class _Hats:
    """Hats B_w of (1): squares of cosines, the first and the last one go on at the ends."""

    start: float
    spacing: float
    """Of the first top, and from one to the next [s]."""
    count: int

    @classmethod
    def over(cls, start: float, end: float, frequency: float) -> _Hats:
        """Return hats over a record that swings at a frequency [Hz]."""
        # Periods of the record from one hat of (1) to the next: frequencies may be off by an eighth.
        periods = 4.0
        between = max(round((end - start) * frequency / periods), 1)
        return cls(start, (end - start) / between, between + 1)

    def at(self, time: Floats, w: int) -> Floats:
        """Return B_w at some times, shape (n,)."""
        along = np.clip((time - self.start) / self.spacing, 0.0, self.count - 1.0) - w
        return np.where(np.abs(along) < 1, np.cos(0.5 * np.pi * along) ** 2, 0.0)

    def interval(self, time: Floats) -> Indices:
        """Return the number of the hat before each of some times, of two that overlap there."""
        along = np.floor((time - self.start) / self.spacing)
        return np.clip(along, 0, self.count - 2).astype(np.intp)

    def begin(self, w: int) -> float:
        """Return t_w of (1), where a hat begins [s]: later states decay."""
        return self.start + max(w - 1, 0) * self.spacing

    def states(self, motion: FreeMotion, amplitudes: Floats, time: Floats) -> Floats:
        """Return (1), shape (n, state)."""
        found = np.zeros((len(time), len(motion.A)))
        for w in range(self.count):
            hat = self.at(time, w)
            on = hat > 0
            found[on] += hat[on, None] * motion.states(amplitudes[w], time[on] - self.begin(w))
        return found


def _amplitudes(motion: FreeMotion, hats: _Hats, free: Indices, seen: list[_Channels]) -> Floats:
    """Return the s_w of (2), shape (hats, state)."""
    large = 1.0  # 1 sigma of how far a mode swings [m, rad]: what no signal shows stays at rest
    m, per_motion = len(free), 1.0 / _motion(motion)[free]
    weak = np.eye(m) / large
    offsets = sum(each.gap.shape[1] for each in seen)
    kept: list[Floats] = []
    left: Floats = np.hstack([weak, np.zeros((m, offsets + 1))])
    for rows in _rows(motion, hats, free, seen, offsets):
        rows[:, : 2 * m] *= np.tile(per_motion, 2)
        before = np.hstack([left[:, :m], np.zeros((len(left), m)), left[:, m:]])
        next_weak = np.zeros((m, rows.shape[1]))
        next_weak[:, m : 2 * m] = weak
        triangle: Floats = np.asarray(np.linalg.qr(np.vstack([before, next_weak, rows]), mode="r"))
        kept.append(triangle[:m])
        left = triangle[m:, m:]
    last = np.linalg.lstsq(left[:, :-1], left[:, -1], rcond=None)[0]
    found = np.zeros((hats.count, len(motion.A)))
    for w in range(hats.count - 1, -1, -1):
        if w < hats.count - 1:
            row = kept[w]
            own = np.linalg.solve(row[:, :m], row[:, -1] - row[:, m:-1] @ last)
            last = np.concatenate([own, last[m:]])
        found[w, free] = per_motion * last[:m]
    return found


def _rows(
    motion: FreeMotion, hats: _Hats, free: Indices, seen: list[_Channels], offsets: int
) -> Iterator[Floats]:
    """Yield the rows of (2) of each interval between two tops: of both hats, offsets and right-hand side."""
    values, V = np.linalg.eig(motion.A)
    inverse = np.linalg.inv(V)[:, free]
    for w in range(hats.count - 1):
        rows, first = [], 0
        for each in seen:
            inside = hats.interval(each.time) == w
            modal = each.by_state @ V
            for c in range(each.gap.shape[1]):
                keep = inside & np.isfinite(each.gap[:, c])
                time, own = each.time[keep], np.zeros((np.count_nonzero(keep), offsets))
                own[:, first] = 1.0
                waves = (
                    hats.at(time, k)[:, None]
                    * np.real((np.exp(np.outer(time - hats.begin(k), values)) * modal[c]) @ inverse)
                    for k in (w, w + 1)
                )
                rows.append(np.hstack([*waves, own, each.gap[keep, c, None]]))
                first += 1
        yield np.vstack(rows)


def _frequencies(motion: FreeMotion) -> Floats:
    """Return the frequencies of the modes [rad/s]."""
    n = len(motion.A) // 2
    return np.sqrt(np.maximum(-np.diag(motion.A[n:, :n]), 0.0))


def _motion(motion: FreeMotion) -> Floats:
    """Return how far a point moves or turns by each state, at most [m, rad]."""
    n = len(motion.A) // 2
    places = (motion.slopes[name][..., :n].reshape(-1, n) for name in ("position", "orientation"))
    by_mode = np.max([np.abs(each).max(axis=0, initial=1e-300) for each in places], axis=0)
    return np.concatenate([by_mode, by_mode / np.maximum(_frequencies(motion), 1e-3)])


def _dominant_frequency(seen: list[_Channels]) -> float:
    """Return the frequency at which the channel that moves most swings [Hz]."""
    best = max(
        (
            (each, c)
            for each in seen
            for c in range(each.gap.shape[1])
            if np.isfinite(each.gap[:, c]).sum() > 1
        ),
        key=lambda pair: float(np.nanstd(pair[0].gap[:, pair[1]])),
    )
    time, values = best[0].time, best[0].gap[:, best[1]]
    keep = np.isfinite(values)
    even = np.linspace(time[keep][0], time[keep][-1], max(int(keep.sum()), 4))
    swing = np.interp(even, time[keep], values[keep])
    power = np.abs(np.fft.rfft(swing - swing.mean()))[1:]
    return float((1 + int(np.argmax(power))) / (even[-1] - even[0]))
