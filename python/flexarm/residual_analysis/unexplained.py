"""The unexplained residual: its size, dominant frequency, covariate and place.

The dominant frequency f is the peak of the generalised Lomb-Scargle periodogram [Zechmeister2009] in the band
from f/1.1 to 1.1 f that holds most of the squares: a vibration that comes and goes, or whose frequency moves
with the pose, is no sharp line. Bands end at half the sampling rate. A faster vibration appears folded, and
the same samples then fit any of

    f, rate - f, rate + f, ...                                                                      (1)

A residual is a burst if half of its squares lie in an interval of one record that holds few of all samples.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.bands import band_split
from flexarm.residual_analysis.localisation import Localisation
from flexarm.residual_analysis.motion_states import CONSTANT
from flexarm.residual_analysis.policy import POLICY
from flexarm.residual_analysis.residual_parts import PER_TURN, POSES, SignalResidual
from flexarm.residual_analysis.spectrum import SLOW, periodogram
from flexarm.wording import instant, number, with_unit


@dataclass(frozen=True)
class UnexplainedResidual:
    """Residual that no effect explains."""

    signal: str
    direction: str
    unit: str
    """Where most of it is."""
    rms: float
    max: float
    noise_rms: float
    """Of all measured directions of that signal."""
    ratio: float
    """rms over noise."""
    frequency_hz: float | None
    """The dominant one; None for poses."""
    frequency_share: float
    """Share of the squares in its band, in that direction and the record where it holds most."""
    band: str
    """The part of the residual in whose band it lies."""
    aliases_hz: tuple[float, ...]
    """Other frequencies that the same samples would fit, eq. (1); none where it is quasi-static."""
    covariate: str
    """The state that it follows best."""
    covariate_share: float
    """Share of what is not constant that a curve over that state explains, or the constant's share of all."""
    record: str
    """Where it is greatest."""
    time: float
    """When [s], or the number of the pose."""
    burst: tuple[float, float] | None = None
    """The shortest interval [s] of that record that holds half of the squares of all, if it is short."""
    in_time: bool = True
    """False for poses."""

    def __str__(self) -> str:
        at = f"at {instant(self.time)} s" if self.in_time else f"in pose number {self.time + 1:.0f}"
        place = f"{at} of {self.record}" if self.record else at
        burst = ", half of it from {} to {} s".format(*map(instant, self.burst)) if self.burst else ""
        said = (
            f"{with_unit(self.rms, self.unit)} rms are left at {self.signal}, {number(self.ratio)} times the "
            f"noise, mostly {self.direction}, at most {with_unit(self.max, self.unit)} {place}{burst}"
        )
        if self.frequency_hz is not None and self.frequency_share >= POLICY.dominant_share:
            said += f"; {100 * self.frequency_share:.0f} % of it swings near {self.frequency_hz:.3g} Hz, "
            folded = ", ".join(f"{f:.3g}" for f in self.aliases_hz)
            said += (
                f"in the band {self.band!r} (or folded from {folded} Hz)"
                if folded
                else "as slow as the motion"
            )
        share = f"{100 * self.covariate_share:.0f} %"
        named = self.covariate_share >= POLICY.dominant_share
        if self.covariate == CONSTANT:
            return f"{said}; {share} of it is constant." if named else f"{said}."
        if not named:
            return f"{said}; no state of the joints explains more than {share} of what is not constant."
        return f"{said}; of what is not constant, {share} follow {self.covariate}."


def unexplained_residual(localised: Localisation) -> UnexplainedResidual | None:
    """Return the residual of the signal furthest above its noise; None if there is none."""
    if not localised.gaps:
        return None
    rows = max(localised.gaps.values(), key=lambda each: float(np.mean(each.whitened**2)))
    direction = rows.largest_direction
    length = np.sqrt(np.sum([values**2 for values in rows.directions.values()], axis=0))
    noise = float(np.sqrt(np.mean(np.sum([sigma**2 for sigma in rows.noise.values()], axis=0))))
    rms, worst = float(np.sqrt(np.mean(length**2))), int(np.argmax(length))
    dependence = localised.dependence[rows.signal]
    in_time = any(part.band != POSES for part in rows.parts[direction])
    frequency, share, aliases = _dominant_frequency(rows, direction) if in_time else (None, 0.0, ())
    bands = [
        part.band
        for part in rows.parts[direction]
        if frequency is not None
        and part.band_hz[0] <= frequency <= part.band_hz[1]
        and PER_TURN not in part.band
    ]
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
        bands[0] if bands else "",
        aliases,
        dependence.best,
        dependence.adjusted.get(dependence.best, dependence.constant),
        rows.labels[rows.record[worst]],
        float(rows.time[worst]),
        _burst(rows.time, rows.record, length**2, int(rows.record[worst])) if in_time else None,
        in_time,
    )


def _dominant_frequency(
    rows: SignalResidual, direction: str
) -> tuple[float | None, float, tuple[float, ...]]:
    """Return frequency, share of its band, and aliases, of the record in which a band holds most."""
    parts = next(iter(rows.parts.values()))
    slow = max((part.band_hz[1] for part in parts if part.band.startswith(SLOW)), default=0.0)
    found: tuple[float | None, float, tuple[float, ...]] = (None, 0.0, ())
    most = 0.0
    for k in range(len(rows.labels)):
        time, values = rows.time[rows.record == k], rows.directions[direction][rows.record == k]
        if len(values) < 8 or not np.any(values):
            continue
        f, share = _widest_peak(time, values)
        if share * np.sum(values**2) > most:
            most, rate = float(share * np.sum(values**2)), float(1 / np.median(np.diff(time)))
            found = (f, share, () if f < slow else (rate - f, rate + f))  # eq. (1)
    return found


def _widest_peak(time: Floats, values: Floats) -> tuple[float, float]:
    """Return the peak of the band that holds most of the periodogram, and the band's share of the squares."""
    frequencies, powers = periodogram(time, values)
    powers = powers / float(np.mean(values**2))
    factor = 1 + POLICY.band_half_width
    sums = np.concatenate([[0.0], np.cumsum(powers)])
    first = np.searchsorted(frequencies, frequencies / factor)
    last = np.searchsorted(frequencies, frequencies * factor, side="right")
    best = int(np.argmax(sums[last] - sums[first]))
    inside = slice(first[best], last[best])
    f = float(frequencies[inside][np.argmax(powers[inside])])
    nyquist = float(0.5 / np.median(np.diff(time)))
    bands = band_split(time, values[:, None], [0.0, f / factor, min(f * factor, 0.999 * nyquist), nyquist])
    return f, max(float(powers[inside].max()), float(bands[1].rms ** 2 / np.mean(values**2)))


def _burst(time: Floats, record: NDArray[np.intp], squares: Floats, k: int) -> tuple[float, float] | None:
    """Return the shortest interval of record k that holds half of all squares, if it holds few samples."""
    own, at = squares[record == k], time[record == k]
    sums = np.concatenate([[0.0], np.cumsum(own)])
    ends = np.searchsorted(sums, sums[:-1] + 0.5 * squares.sum())  # samples up to there hold half
    starts = np.flatnonzero(ends <= len(own))
    if not len(starts):
        return None
    best = int(starts[np.argmin(at[ends[starts] - 1] - at[starts])])
    if ends[best] - best > POLICY.burst_share * len(squares):
        return None
    return float(at[best]), float(at[ends[best] - 1])
