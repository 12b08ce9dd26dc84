r"""Free decay of an arm: frequency and damping by amplitude.

While the drive is at rest, an arm vibrates freely, and its frequency and damping are constant under a linear
law. Over each few periods

.. math:: y(t) = c_0 + c_1 t + A e^{-\zeta \omega t} \cos(\omega t + \varphi)                          (1)

is fitted by least squares, beside sines of the record's other spectral lines whose amplitude goes linearly
with time. Under a linear law omega and zeta are the same in every segment. A dry friction that holds F of a
spring k takes 4 F/k from the amplitude in each period, so that

.. math:: \zeta(A) = \frac{2}{\pi} \frac{F}{k A}                                                      (2)

grows as the vibration dies, and a spring k (1 + beta x^2) has omega^2 = omega_0^2 (1 + 3 beta A^2/4)
[Nayfeh1979]. The measured signal itself is analysed, not its residual: no model is needed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.residual_analysis.policy import POLICY
from flexarm.residual_analysis.spectrum import periodogram
from flexarm.wording import number, with_unit


@dataclass(frozen=True)
class DecaySegment:
    """A few periods of a free decay."""

    time: float
    """Middle [s]."""
    amplitude: float
    """A of (1) there [unit of the signal]."""
    frequency_hz: float
    damping_ratio: float
    """omega/2 pi and zeta of (1)."""
    frequency_std: float
    damping_std: float
    """Their 1 sigma, if the residual of (1) is white."""


@dataclass(frozen=True)
class FreeDecay:
    """A free decay of one channel."""

    record: str
    signal: str
    unit: str
    """Where it was measured."""
    pieces: tuple[DecaySegment, ...]
    """In order of time."""

    @property
    def frequency_moves(self) -> bool:
        """True if the frequencies of `ends` differ beyond their errors."""
        high, low = self.ends
        change = abs(high.frequency_hz - low.frequency_hz)
        sure = POLICY.decay_sigmas * float(np.hypot(high.frequency_std, low.frequency_std))
        return change > max(sure, POLICY.frequency_change * low.frequency_hz)

    @property
    def damping_moves(self) -> bool:
        """True if the damping ratios of `ends` differ beyond their errors."""
        high, low = self.ends
        change = abs(high.damping_ratio - low.damping_ratio)
        sure = POLICY.decay_sigmas * float(np.hypot(high.damping_std, low.damping_std))
        return change > max(sure, POLICY.damping_change * max(high.damping_ratio, low.damping_ratio))

    @property
    def ends(self) -> tuple[DecaySegment, DecaySegment]:
        """The segment of the greatest amplitude, and the mean of those below half of it or of the least."""
        ranked = sorted(self.pieces, key=lambda piece: -piece.amplitude)
        small = [piece for piece in ranked[1:] if piece.amplitude < ranked[0].amplitude / 2]
        return ranked[0], weighted_mean(small or ranked[-1:])

    def __str__(self) -> str:
        high, low = self.ends
        return (
            f"{self.signal} of {self.record}: {number(high.frequency_hz)} Hz, damped by "
            f"{number(100 * high.damping_ratio)} %, at {with_unit(high.amplitude, self.unit)}; "
            f"{number(low.frequency_hz)} Hz and {number(100 * low.damping_ratio)} % at "
            f"{with_unit(low.amplitude, self.unit)}"
        )


def weighted_mean(pieces: Sequence[DecaySegment]) -> DecaySegment:
    """Return the mean weighted by 1/sigma^2; time and amplitude have the weights of the damping."""
    by_frequency = np.array([piece.frequency_std**-2 for piece in pieces])
    by_damping = np.array([piece.damping_std**-2 for piece in pieces])
    damping = np.array([(piece.time, piece.amplitude, piece.damping_ratio) for piece in pieces])
    time, amplitude, ratio = (float(x) for x in by_damping @ damping / by_damping.sum())
    frequency = by_frequency @ [piece.frequency_hz for piece in pieces] / by_frequency.sum()
    errors = (float(weights.sum() ** -0.5) for weights in (by_frequency, by_damping))
    return DecaySegment(time, amplitude, float(frequency), ratio, *errors)


def free_decays(pairs: Mapping[str, AlignedRecord]) -> list[FreeDecay]:
    """Return the decay of the strongest channel of each signal that goes on while the drive is at rest."""
    found = []
    for name, pair in pairs.items():
        if pair.record.kind == "static":
            continue
        since = _at_rest_since(pair)
        for signal in pair.simulated.evidence.values():
            time = pair.simulated.instants(signal, pair.aligned.placement)  # by the drives' clock
            rows = (time > since) & np.isfinite(signal.values).all(axis=1)
            if np.count_nonzero(rows) < POLICY.decay_segments * POLICY.decay_periods * POLICY.decay_samples:
                continue
            values = signal.values[rows]
            strongest = values[:, int(np.argmax(np.var(values, axis=0)))]
            pieces = tuple(decay_segments(time[rows], strongest))
            if len(pieces) >= POLICY.decay_segments:
                found.append(FreeDecay(name, signal.name, signal.unit, pieces))
    return found


def describe_free_decays(found: Sequence[FreeDecay]) -> str:
    """Return a sentence if frequency or damping change with the amplitude somewhere; else an empty one."""
    moving = [each for each in found if each.frequency_moves or each.damping_moves]
    if not moving:
        return ""
    what = {
        (True, True): "frequency and damping move",
        (True, False): "the frequency moves",
        (False, True): "the damping moves",
    }[any(each.frequency_moves for each in moving), any(each.damping_moves for each in moving)]
    cases = "; ".join(map(str, moving[:3]))
    return f"While the drive stands, {what} with the amplitude, as of no linear law: {cases}."


def decay_segments(time: Floats, values: Floats) -> Iterator[DecaySegment]:
    """Yield the segments of a vibration until noise hides it; none if it has too few periods or samples."""
    trend = np.polyval(np.polyfit(time - time[0], values, 1), time - time[0])
    lowest = POLICY.decay_segments * POLICY.decay_periods / float(time[-1] - time[0])
    highest = 1 / float(np.median(np.diff(time))) / POLICY.decay_samples
    if not np.any(values - trend) or lowest >= highest:
        return
    frequencies, powers = periodogram(time, values - trend, highest=highest)
    inside = frequencies >= lowest
    start, guess = float(time[0]), float(frequencies[inside][np.argmax(powers[inside])])
    others = _other_lines(frequencies[inside], powers[inside], guess)
    while True:
        end = start + POLICY.decay_periods / guess
        rows = (time >= start) & (time < end)
        if time[-1] < end or np.count_nonzero(rows) < POLICY.decay_periods * POLICY.decay_samples:
            return
        piece, std = fitted_segment(time[rows], values[rows], guess, others)
        if piece is None or piece.amplitude < POLICY.decay_amplitude * std:
            return
        yield piece
        start, guess = end, piece.frequency_hz


def _other_lines(frequencies: Floats, powers: Floats, first: float) -> list[float]:
    """Return the strongest spectral lines but the first one [Hz], at most three: other modes.

    They stand out of what lies between, which for a side lobe of the first line is much.
    """
    wide = 1.5  # least ratio of two lines; a mode whose frequency moves has a wide one
    found: list[float] = []
    peaks = 1 + np.flatnonzero((powers[1:-1] > powers[:-2]) & (powers[1:-1] > powers[2:]))
    for k in peaks[np.argsort(-powers[peaks])]:
        f = float(frequencies[k])
        if powers[k] < POLICY.peak_over_median * np.median(powers) or len(found) == 3:
            break
        around = powers[(frequencies > f / wide) & (frequencies < f * wide)]
        if powers[k] == around.max() and abs(np.log(f / first)) > np.log(wide):
            between = powers[(frequencies > min(f, first)) & (frequencies < max(f, first))]
            if powers[k] > POLICY.peak_over_median * np.median(between):
                found.append(f)
    return found


def fitted_segment(
    time: Floats, values: Floats, frequency: float, others: Sequence[float] = ()
) -> tuple[DecaySegment | None, float]:
    """Return (1) fitted from a guess of the frequency (None if not found), and 1 sigma of its amplitude.

    `others` are frequencies of further lines [Hz].
    """
    from scipy.optimize import least_squares

    middle = float((time[0] + time[-1]) / 2)
    t = time - middle
    turns = 2 * np.pi * np.outer(t, others)
    sines = np.column_stack([np.cos(turns), np.sin(turns)])
    beside = np.column_stack([np.ones_like(t), t, sines, t[:, None] * sines])

    def columns(x: Floats) -> Floats:
        fades = np.exp(-x[1] * t)
        return np.column_stack([fades * np.cos(x[0] * t), fades * np.sin(x[0] * t), beside])

    def residual(x: Floats) -> Floats:
        a = columns(x)
        return values - a @ np.linalg.lstsq(a, values, rcond=None)[0]

    omega = 2 * np.pi * frequency
    bounds = ([0.6 * omega, -0.5 * omega], [1.6 * omega, 0.7 * omega])
    found = least_squares(residual, [omega, 0.03 * omega], bounds=bounds, x_scale=[omega, 0.1 * omega])
    if not found.success or np.any(found.active_mask != 0):
        return None, 0.0
    w, rate = (float(x) for x in found.x)
    cosine, sine = np.linalg.lstsq(columns(found.x), values, rcond=None)[0][:2]
    variance = float(found.fun @ found.fun) / max(len(t) - 4 - beside.shape[1], 1)
    std = np.sqrt(np.diag(np.linalg.pinv(found.jac.T @ found.jac)) * variance)
    errors = max(float(std[0]), 1e-12 * w), max(float(std[1]), 1e-12 * w)  # data may be exact
    amplitude = float(np.hypot(cosine, sine))
    piece = DecaySegment(middle, amplitude, w / (2 * np.pi), rate / w, errors[0] / (2 * np.pi), errors[1] / w)
    return piece, float(np.sqrt(2 * variance / len(t)))


def _at_rest_since(pair: AlignedRecord) -> float:
    """Return the last instant at which a drive moved [s]; -inf if nothing drives."""
    found = -np.inf
    for signal in (pair.record.signals[name] for name in pair.record.drive):
        known = np.isfinite(signal.values[:, 0])
        values, time = signal.values[known, 0], signal.time[known]
        allowed = 5 * signal.noise_std if signal.noise_std else POLICY.rest * float(np.ptp(values))
        moved = np.flatnonzero(np.abs(values - np.median(values[-max(len(values) // 20, 1) :])) > allowed)
        if len(moved):
            found = max(found, float(time[moved[-1]]))
    return found
