r"""What a gap looks like that nothing explained: size, frequency, state, and where it is greatest.

The dominant frequency is that of the sine, with a mean of its own, that takes away most of the squares of the
gap (generalised Lomb-Scargle periodogram [Zechmeister2009]); samples may fall as they like. It is looked for
up to half the sampling rate: a faster vibration appears folded, and the same samples then fit any of

    f, rate - f, rate + f, ...                                                                      (1)
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexarm.diagnosis.curves import CONSTANT
from flexarm.diagnosis.gap_bands import SLOW
from flexarm.diagnosis.gap_rows import GapRows
from flexarm.diagnosis.locate import Located
from flexarm.diagnosis.wording import number, with_unit

Floats = NDArray[np.float64]

DOMINANT = 0.3
"""Share of the squares that a sine must take away to be called dominant."""
OVERSAMPLING = 4
"""Frequencies looked at in each 1/T."""


@dataclass(frozen=True)
class Remainder:
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
        Of the dominant sine; None for poses.
    frequency_share : float
        What it takes of the squares, in that direction.
    aliases_hz : tuple of float
        Other frequencies that the same samples would fit, eq. (1); none where it is quasi-static.
    follows : str
        The state that it follows best.
    follows_share : float
        How much a curve over that state explains of what is not constant, or the constant of all.
    record : str
        Where it is greatest.
    time : float
        When [s], or the number of the pose.
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
    aliases_hz: tuple[float, ...]
    follows: str
    follows_share: float
    record: str
    time: float
    in_time: bool = True

    def __str__(self) -> str:
        at = f"at {self.time:.3g} s" if self.in_time else f"in pose number {self.time + 1:.0f}"
        where = f"{at} of {self.record}" if self.record else at
        said = (
            f"{with_unit(self.rms, self.unit)} rms are left at {self.signal}, {number(self.ratio)} times the "
            f"noise, mostly {self.direction}, at most {with_unit(self.max, self.unit)} {where}"
        )
        if self.frequency_hz is not None and self.frequency_share >= DOMINANT:
            said += f"; {100 * self.frequency_share:.0f} % of it swings at {self.frequency_hz:.3g} Hz"
            folded = ", ".join(f"{f:.3g}" for f in self.aliases_hz)
            said += f" (folded, if it is {folded} Hz)" if folded else ", as slow as the motion"
        if self.follows == CONSTANT:
            said += f"; it is {'constant' if self.follows_share >= DOMINANT else 'no curve over any state'}"
        else:
            said += f"; of what is not constant, {100 * self.follows_share:.0f} % follow {self.follows}"
        return said + "."


def describe_remainder(located: Located) -> dict[str, Any]:
    """What `remainder_of` gives, as a dictionary with a `sentence`; that is empty if nothing was measured."""
    found = remainder_of(located)
    return {"sentence": ""} if found is None else {**asdict(found), "sentence": str(found)}


def remainder_of(located: Located) -> Remainder | None:
    """The signal that stands furthest out of its noise, described; None if nothing was measured.

    Parameters
    ----------
    located : Located
        With the best model.
    """
    if not located.gaps:
        return None
    rows = max(located.gaps.values(), key=lambda each: float(np.mean(each.whitened**2)))
    direction = max(rows.directions, key=lambda name: float(np.sum(rows.directions[name] ** 2)))
    length = np.sqrt(np.sum([values**2 for values in rows.directions.values()], axis=0))
    noise = float(np.sqrt(np.mean(np.sum([sigma**2 for sigma in rows.noise.values()], axis=0))))
    rms, worst, follows = (
        float(np.sqrt(np.mean(length**2))),
        int(np.argmax(length)),
        located.follows[rows.signal],
    )
    moves = any(each.moves for each in rows.states)
    frequency, share, aliases = _dominant(rows, rows.directions[direction]) if moves else (None, 0.0, ())
    return Remainder(
        rows.signal,
        direction,
        rows.unit,
        rms,
        float(length[worst]),
        noise,
        rms / noise if noise > 0 else np.inf,
        frequency,
        share,
        aliases,
        follows.best,
        follows.constant if follows.best == CONSTANT else follows.beyond[follows.best],
        rows.labels[rows.record[worst]],
        float(rows.time[worst]),
        moves,
    )


def _dominant(rows: GapRows, values: Floats) -> tuple[float | None, float, tuple[float, ...]]:
    """Frequency, share and aliases of the sine that takes away most, of the record where it takes most."""
    found: tuple[float | None, float, tuple[float, ...]] = (None, 0.0, ())
    for k in range(len(rows.labels)):
        time, own = rows.time[rows.record == k], values[rows.record == k]
        if len(own) < 8 or not np.any(own):
            continue
        frequencies, powers = periodogram(time, own)
        best = int(np.argmax(powers))
        if powers[best] > found[1]:
            rate = float(1 / np.median(np.diff(time)))
            f = float(frequencies[best])
            found = (f, float(powers[best]), () if f < _slow_edge(rows) else (rate - f, rate + f))
    return found


def _slow_edge(rows: GapRows) -> float:
    """Upper edge of the quasi-static band [Hz]."""
    parts = next(iter(rows.parts.values()))
    return max((part.band_hz[1] for part in parts if part.band.startswith(SLOW)), default=0.0)


def periodogram(time: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Frequencies [Hz] up to half the rate, and the share of the squares that a sine of each takes away."""
    from scipy.signal import lombscargle

    length, rate = float(time[-1] - time[0]), float(1 / np.median(np.diff(time)))
    frequencies = np.arange(1, int(OVERSAMPLING * length * rate / 2) + 1) / (OVERSAMPLING * length)
    powers = lombscargle(time, values, 2 * np.pi * frequencies, normalize=True, floating_mean=True)
    # a power is a share of the variance about the mean; the mean is no swing
    powers = powers * float(np.var(values) / np.mean(values**2))
    return frequencies, np.asarray(powers)
