r"""Free vibration of a record without a drive that begins in motion: tap, pluck and drop tests.

What the arm was given nobody knows. Its modes ring from amplitudes that the record itself shows,

.. math:: s(t) = \sum_w B_w(t) \, e^{A (t - t_w)} s_w                                                (1)

with hats B_w of which two overlap at any time and add up to one, `periods` periods of the record apart. A
right model rings on from one to the next; a wrong frequency or damping leaves a gap within each, but does not
fall out of step over the whole record, so that fits find their way from far. The s_w are those of least
squares,

.. math:: \min \sum \big( y_i - y_0 - c - C s(t_i) \big)^2 / \sigma^2                                (2)

with y_0 the readings of the equilibrium, C those of each state, and an offset c for each channel, that is
left out of the prediction. Clocks and frames are as stated; signals of unknown ones are not used.
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
    values, V = np.linalg.eig(motion.A)
    inverse = np.linalg.inv(V)[:, free]
    rows, right = [], []
    offsets = sum(each.gap.shape[1] for each in seen)
    first = 0
    for each in seen:
        modal = each.by_state @ V
        for c in range(each.gap.shape[1]):
            keep = np.isfinite(each.gap[:, c])
            time = each.time[keep]
            blocks = []
            for w in range(hats.count):
                hat = hats.at(time, w)
                waves = np.exp(np.outer(np.where(hat > 0, time - hats.begin(w), 0.0), values))
                blocks.append(hat[:, None] * np.real((waves * modal[c]) @ inverse))
            own = np.zeros((len(time), offsets))
            own[:, first] = 1.0
            rows.append(np.hstack([*blocks, own]))
            right.append(each.gap[keep, c])
            first += 1
    A, y = np.vstack(rows), np.concatenate(right)
    per_motion = np.tile(1.0 / _motion(motion)[free], hats.count)
    A[:, : len(per_motion)] *= per_motion
    weak = np.eye(len(per_motion), A.shape[1]) / large
    best = np.linalg.lstsq(np.vstack([A, weak]), np.append(y, np.zeros(len(weak))), rcond=None)[0]
    best[: len(per_motion)] *= per_motion
    found = np.zeros((hats.count, len(motion.A)))
    found[:, free] = best[: hats.count * len(free)].reshape(hats.count, len(free))
    return found


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
