r"""Frequency and damping of a free vibration against its amplitude: whether the law behind it is linear.

While the drive stands, an arm swings by itself. Over each few periods of it

.. math:: y(t) = c_0 + c_1 t + A e^{-\zeta \omega t} \cos(\omega t + \varphi)                          (1)

is fitted by least squares. Of a linear law omega and zeta are the same in every piece. A dry friction that
holds F of a spring k takes 4 F/k from the amplitude in each period, so that

.. math:: \zeta(A) = \frac{2}{\pi} \frac{F}{k A}                                                      (2)

grows as the vibration dies, and a spring k (1 + beta x^2) has omega^2 = omega_0^2 (1 + 3 beta A^2/4)
[Nayfeh1979]. What is measured is looked at, not a gap: no model need be near for it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.residual_analysis.spectrum import periodogram
from flexarm.wording import number, with_unit

PERIODS = 3.0
"""Of a piece that (1) is fitted to."""
LEAST = 3
"""Pieces that say how frequency and damping move."""
SEEN = 15.0
"""Least amplitude of a piece over its standard deviation: its damping ratio is then known to 0.01."""
STILL = 1e-3
"""Part of its range that a drive may move while it stands."""
SAMPLES = 8
"""Least number in a period."""
SURE, FREQUENCY, DAMPING = 3.0, 0.02, 0.2
"""Standard deviations, and parts of itself, by which a frequency or a damping moves."""


@dataclass(frozen=True)
class DecaySegment:
    """A few periods of a vibration.

    Attributes
    ----------
    time : float
        Middle [s].
    amplitude : float
        A of (1) there [unit of the signal].
    frequency_hz, damping_ratio : float
        omega/2 pi and zeta of (1).
    frequency_std, damping_std : float
        1 sigma of them, if what (1) leaves is white.
    """

    time: float
    amplitude: float
    frequency_hz: float
    damping_ratio: float
    frequency_std: float
    damping_std: float


@dataclass(frozen=True)
class FreeDecay:
    """A free vibration of one channel, piece by piece.

    Attributes
    ----------
    record, signal, unit : str
        Where it was measured.
    pieces : tuple of DecaySegment
        In order of time.
    """

    record: str
    signal: str
    unit: str
    pieces: tuple[DecaySegment, ...]

    @property
    def frequency_moves(self) -> bool:
        """Whether the frequency of `ends` differs beyond its errors."""
        high, low = self.ends
        apart = abs(high.frequency_hz - low.frequency_hz)
        return apart > SURE * float(np.hypot(high.frequency_std, low.frequency_std)) and (
            apart > FREQUENCY * low.frequency_hz
        )

    @property
    def damping_moves(self) -> bool:
        """The same of the damping ratio."""
        high, low = self.ends
        apart = abs(high.damping_ratio - low.damping_ratio)
        return apart > SURE * float(np.hypot(high.damping_std, low.damping_std)) and (
            apart > DAMPING * max(high.damping_ratio, low.damping_ratio)
        )

    @property
    def ends(self) -> tuple[DecaySegment, DecaySegment]:
        """The piece of the greatest amplitude, and the mean of those below half of it or of the least."""
        ranked = sorted(self.pieces, key=lambda piece: -piece.amplitude)
        small = [piece for piece in ranked[1:] if piece.amplitude < ranked[0].amplitude / 2]
        return ranked[0], mean(small or ranked[-1:])

    def __str__(self) -> str:
        high, low = self.ends
        return (
            f"{self.signal} of {self.record}: {number(high.frequency_hz)} Hz, damped by "
            f"{number(100 * high.damping_ratio)} %, at {with_unit(high.amplitude, self.unit)}; "
            f"{number(low.frequency_hz)} Hz and {number(100 * low.damping_ratio)} % at "
            f"{with_unit(low.amplitude, self.unit)}"
        )


def mean(pieces: Sequence[DecaySegment]) -> DecaySegment:
    """Of several pieces, by what each knows; time and amplitude by what it knows of the damping."""
    by_frequency = np.array([piece.frequency_std**-2 for piece in pieces])
    by_damping = np.array([piece.damping_std**-2 for piece in pieces])
    damping = np.array([(piece.time, piece.amplitude, piece.damping_ratio) for piece in pieces])
    time, amplitude, ratio = (float(x) for x in by_damping @ damping / by_damping.sum())
    frequency = by_frequency @ [piece.frequency_hz for piece in pieces] / by_frequency.sum()
    errors = (float(weights.sum() ** -0.5) for weights in (by_frequency, by_damping))
    return DecaySegment(time, amplitude, float(frequency), ratio, *errors)


def free_decays(pairs: Mapping[str, AlignedRecord]) -> list[FreeDecay]:
    """Of every record that goes on while its drive stands, the channel of each signal that swings most."""
    found = []
    for name, pair in pairs.items():
        if pair.record.kind == "static":
            continue
        since = _still_since(pair)
        for signal in pair.simulated.evidence.values():
            rows = (signal.time > since) & np.isfinite(signal.values).all(axis=1)
            if np.count_nonzero(rows) < LEAST * PERIODS * SAMPLES:
                continue
            values = signal.values[rows]
            strongest = values[:, int(np.argmax(np.var(values, axis=0)))]
            pieces = tuple(decay(signal.time[rows], strongest))
            if len(pieces) >= LEAST:
                found.append(FreeDecay(name, signal.name, signal.unit, pieces))
    return found


def describe_free_decays(found: Sequence[FreeDecay]) -> str:
    """A sentence if frequency or damping move with the amplitude somewhere; else nothing."""
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


def decay(time: Floats, values: Floats) -> Iterator[DecaySegment]:
    """Pieces of a vibration that dies, until noise hides it."""
    frequency = _dominant(time, values)
    if frequency is None:
        return
    start, guess = float(time[0]), frequency
    while True:
        rows = (time >= start) & (time < start + PERIODS / guess)
        if time[-1] < start + PERIODS / guess or np.count_nonzero(rows) < PERIODS * SAMPLES:
            return
        piece, std = fitted_piece(time[rows], values[rows], guess)
        if piece is None or piece.amplitude < SEEN * std:
            return
        yield piece
        start, guess = start + PERIODS / guess, piece.frequency_hz


def fitted_piece(time: Floats, values: Floats, frequency: float) -> tuple[DecaySegment | None, float]:
    """Eq. (1) from a guess of the frequency, and 1 sigma of the amplitude; None without an optimum nearby."""
    from scipy.optimize import least_squares

    middle = float((time[0] + time[-1]) / 2)
    t = time - middle

    def columns(x: Floats) -> Floats:
        fades = np.exp(-x[1] * t)
        return np.stack([np.ones_like(t), t, fades * np.cos(x[0] * t), fades * np.sin(x[0] * t)], axis=1)

    def left(x: Floats) -> Floats:
        a = columns(x)
        found: Floats = values - a @ np.linalg.lstsq(a, values, rcond=None)[0]
        return found

    omega = 2 * np.pi * frequency
    bounds = ([0.6 * omega, -0.5 * omega], [1.6 * omega, 0.7 * omega])
    found = least_squares(left, [omega, 0.03 * omega], bounds=bounds, x_scale=[omega, 0.1 * omega])
    w, rate = (float(x) for x in found.x)
    a = columns(found.x)
    cosine, sine = np.linalg.lstsq(a, values, rcond=None)[0][2:]
    variance = float(found.fun @ found.fun) / max(len(t) - 6, 1)
    if not found.success or np.any(found.active_mask != 0):
        return None, 0.0
    std = np.sqrt(np.diag(np.linalg.pinv(found.jac.T @ found.jac)) * variance)
    amplitude = float(np.hypot(cosine, sine))
    errors = max(float(std[0]), 1e-12 * w), max(float(std[1]), 1e-12 * w)  # data may be exact
    piece = DecaySegment(middle, amplitude, w / (2 * np.pi), rate / w, errors[0] / (2 * np.pi), errors[1] / w)
    return piece, float(np.sqrt(2 * variance / len(t)))


def _dominant(time: Floats, values: Floats) -> float | None:
    """Frequency of the vibration, if there are some periods and samples of it."""
    about = values - np.polyval(np.polyfit(time - time[0], values, 1), time - time[0])
    length, rate = float(time[-1] - time[0]), 1 / float(np.median(np.diff(time)))
    lowest, highest = LEAST * PERIODS / length, rate / SAMPLES
    if not np.any(about) or lowest >= highest:
        return None
    frequencies, powers = periodogram(time, about, 4.0, highest)
    inside = frequencies >= lowest
    return float(frequencies[inside][np.argmax(powers[inside])])


def _still_since(pair: AlignedRecord) -> float:
    """Last instant at which a drive moved [s]; before everything if nothing drives."""
    found = -np.inf
    for name in pair.record.drive:
        signal = pair.record.signals[name]
        values = signal.values[:, 0]
        known = np.isfinite(values)
        values, time = values[known], signal.time[known]
        allowed = max(STILL * float(np.ptp(values)), 5 * float(np.max(signal.noise_std or 0.0)))
        moved = np.flatnonzero(np.abs(values - np.median(values[-max(len(values) // 20, 1) :])) > allowed)
        if len(moved):
            found = max(found, float(time[moved[-1]]))
    return found
