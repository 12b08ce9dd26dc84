r"""What a gap looks like that nothing explained: size, frequency, state, and where it is greatest.

The dominant frequency f is the peak of the generalised Lomb-Scargle periodogram [Zechmeister2009] in the band
from f/1.1 to 1.1 f that holds most of it: a vibration that comes and goes, or whose frequency moves with the
pose, is no sharp line. Samples may fall as they like. Bands end at half the sampling rate: a faster vibration
appears folded, and the same samples then fit any of

    f, rate - f, rate + f, ...                                                                      (1)

A gap is a burst if half of its squares lie in the shortest interval of one record that holds a small part of
all samples.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.bands import band_split
from flexarm.residual_analysis.covariates import CONSTANT
from flexarm.residual_analysis.localisation import Localisation
from flexarm.residual_analysis.residual_parts import PER_TURN, ResidualPart, SignalResidual
from flexarm.residual_analysis.spectrum import SLOW, periodogram
from flexarm.wording import instant, number, with_unit

DOMINANT = 0.25
"""Share of the squares that a band or a state must hold to be named."""
NEAR = 1.1
"""Half the width of a band, as a factor."""
BURST = 0.2
"""Share of all samples that may hold half of the squares of a burst."""
OVERSAMPLING = 4
"""Frequencies looked at in each 1/T."""


@dataclass(frozen=True)
class UnexplainedResidual:
    """What is left of a gap.

    Attributes
    ----------
    signal, direction, unit : str
        Where most of it is.
    rms, max, noise_rms : float
        Of all measured directions of that signal.
    ratio : float
        rms over noise.
    frequency_hz : float or None
        The dominant one; None for poses.
    frequency_share : float
        What its band holds of the squares, in that direction and the record where it holds most.
    band : str
        The part of the gap in whose band it lies.
    aliases_hz : tuple of float
        Other frequencies that the same samples would fit, eq. (1); none where it is quasi-static.
    follows : str
        The state that it follows best.
    covariate_share : float
        How much a curve over that state explains of what is not constant, or the constant of all.
    record : str
        Where it is greatest.
    time : float
        When [s], or the number of the pose.
    burst : tuple of float, or None
        The shortest interval [s] of that record that holds half of the squares of all, if it is short.
    in_time : bool
        False for poses.
    """

    signal: str
    direction: str
    unit: str
    rms: float
    max: float
    noise_rms: float
    ratio: float
    frequency_hz: float | None
    frequency_share: float
    band: str
    aliases_hz: tuple[float, ...]
    follows: str
    covariate_share: float
    record: str
    time: float
    burst: tuple[float, float] | None = None
    in_time: bool = True

    @property
    def sentence(self) -> str:
        """What a person reads."""
        return f"{self._size()}{self._swing()}{self._state()}."

    def __str__(self) -> str:
        return self.sentence

    def _size(self) -> str:
        at = f"at {instant(self.time)} s" if self.in_time else f"in pose number {self.time + 1:.0f}"
        where = f"{at} of {self.record}" if self.record else at
        burst = ", half of it from {} to {} s".format(*map(instant, self.burst)) if self.burst else ""
        return (
            f"{with_unit(self.rms, self.unit)} rms are left at {self.signal}, {number(self.ratio)} times the "
            f"noise, mostly {self.direction}, at most {with_unit(self.max, self.unit)} {where}{burst}"
        )

    def _swing(self) -> str:
        if self.frequency_hz is None or self.frequency_share < DOMINANT:
            return ""
        said = f"; {100 * self.frequency_share:.0f} % of it swings near {self.frequency_hz:.3g} Hz, "
        if not self.aliases_hz:
            return f"{said}as slow as the motion"
        folded = ", ".join(f"{f:.3g}" for f in self.aliases_hz)
        return f"{said}in the band {self.band!r} (or folded from {folded} Hz)"

    def _state(self) -> str:
        share = f"{100 * self.covariate_share:.0f} %"
        if self.follows == CONSTANT:
            return f"; {share} of it is constant" if self.covariate_share >= DOMINANT else ""
        if self.covariate_share < DOMINANT:
            return f"; no state of the joints explains more than {share} of what is not constant"
        return f"; of what is not constant, {share} follow {self.follows}"


def unexplained_residual(located: Localisation) -> UnexplainedResidual | None:
    """The signal that stands furthest out of its noise, described; None if nothing was measured.

    Parameters
    ----------
    located : Localisation
        With the best model.
    """
    if not located.gaps:
        return None
    rows = max(located.gaps.values(), key=lambda each: float(np.mean(each.whitened**2)))
    direction = max(rows.directions, key=lambda name: float(np.sum(rows.directions[name] ** 2)))
    length = np.sqrt(np.sum([values**2 for values in rows.directions.values()], axis=0))
    noise = float(np.sqrt(np.mean(np.sum([sigma**2 for sigma in rows.noise.values()], axis=0))))
    rms, worst = float(np.sqrt(np.mean(length**2))), int(np.argmax(length))
    follows = located.follows[rows.signal]
    moves = any(each.moves for each in rows.states)
    frequency, share, aliases = _dominant(rows, rows.directions[direction]) if moves else (None, 0.0, ())
    band = _band(rows.parts[direction], frequency) if frequency is not None else ""
    return UnexplainedResidual(
        rows.signal,
        direction,
        rows.unit,
        rms,
        float(length[worst]),
        noise,
        rms / noise if noise > 0 else np.inf,
        frequency,
        share,
        band,
        aliases,
        follows.best,
        follows.constant if follows.best == CONSTANT else follows.beyond[follows.best],
        rows.labels[rows.record[worst]],
        float(rows.time[worst]),
        _burst(rows.time, rows.record, length**2, int(rows.record[worst])) if moves else None,
        moves,
    )


def _dominant(rows: SignalResidual, values: Floats) -> tuple[float | None, float, tuple[float, ...]]:
    """Frequency, share of its band, and aliases, of the record in which a band holds most."""
    found: tuple[float | None, float, tuple[float, ...]] = (None, 0.0, ())
    most = 0.0
    for k in range(len(rows.labels)):
        time, own = rows.time[rows.record == k], values[rows.record == k]
        if len(own) < 8 or not np.any(own):
            continue
        f, share = _widest(time, own)
        if share * np.sum(own**2) > most:
            most, rate = float(share * np.sum(own**2)), float(1 / np.median(np.diff(time)))
            found = (f, share, () if f < _slow_edge(rows) else (rate - f, rate + f))
    return found


def _widest(time: Floats, values: Floats) -> tuple[float, float]:
    """The peak of the band that holds most of the periodogram, and the band's share of the squares."""
    frequencies, powers = periodogram(time, values, OVERSAMPLING)
    powers = powers / float(np.mean(values**2))
    sums = np.concatenate([[0.0], np.cumsum(powers)])
    first = np.searchsorted(frequencies, frequencies / NEAR)
    last = np.searchsorted(frequencies, frequencies * NEAR, side="right")
    best = int(np.argmax(sums[last] - sums[first]))
    inside = slice(first[best], last[best])
    f = float(frequencies[inside][np.argmax(powers[inside])])
    nyquist = float(0.5 / np.median(np.diff(time)))
    bands = band_split(time, values[:, None], [0.0, f / NEAR, min(f * NEAR, 0.999 * nyquist), nyquist])
    return f, max(float(powers[inside].max()), float(bands[1].rms ** 2 / np.mean(values**2)))


def _burst(time: Floats, record: NDArray[np.intp], squares: Floats, k: int) -> tuple[float, float] | None:
    """The shortest interval of record k that holds half of all squares, if it holds few samples."""
    own, at = squares[record == k], time[record == k]
    sums = np.concatenate([[0.0], np.cumsum(own)])
    ends = np.searchsorted(sums, sums[:-1] + 0.5 * squares.sum())  # samples up to there hold half
    starts = np.flatnonzero(ends <= len(own))
    if not len(starts):
        return None
    best = int(starts[np.argmin(at[ends[starts] - 1] - at[starts])])
    if ends[best] - best > BURST * len(squares):
        return None
    return float(at[best]), float(at[ends[best] - 1])


def _band(parts: Sequence[ResidualPart], frequency: float) -> str:
    """The band of a frequency; harmonics of motors are none."""
    inside = [part.band for part in parts if part.band_hz[0] <= frequency <= part.band_hz[1]]
    return next((name for name in inside if PER_TURN not in name), "")


def _slow_edge(rows: SignalResidual) -> float:
    """Upper edge of the quasi-static band [Hz]."""
    parts = next(iter(rows.parts.values()))
    return max((part.band_hz[1] for part in parts if part.band.startswith(SLOW)), default=0.0)
