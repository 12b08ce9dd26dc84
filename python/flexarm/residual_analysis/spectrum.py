r"""Spectra of samples at any instants, and named bands of frequency.

The generalised Lomb-Scargle periodogram [Zechmeister2009, eq. (5) to (15)] tells how much of the squares a
sine of each frequency explains. With means over the samples, Y = <y>, C = <cos wt>, S = <sin wt>,

.. math:: p = \frac{SS \, YC^2 + CC \, YS^2 - 2 \, CS \, YC \, YS}{CC \, SS - CS^2},                   (1)

where YC = <y cos wt> - Y C, CC = <cos^2 wt> - C^2 and so on; p is the part of <y^2> - Y^2 that the best sine
explains. Direct sums over n samples for n frequencies take n^2 operations. The stamps are therefore put on a
grid finer than the sampling, on which the sums are fast Fourier transforms; squares of cosine and sine follow
from 2w.

Bands are quasi-static, about each mode, and above the modes. With modes f_1 < f_2 < ... [Hz] below half the
sampling rate, edges lie at f_1/2, between two modes at their geometric mean (at most 2 f_k), and at 2 f_n. A
mode above half the rate appears folded,

    f -> |f - rate round(f/rate)|                                                                    (2)

and so do the frequencies within `band_half_width` of it. The content of a folded band may be either, and its
name says both. The first `modes` modes get folded bands. Higher ones, and modes whose folded band would cover
more than half of all frequencies, appear in a note.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.bands import alias

GRID = 16
"""Places of the grid in the shortest period: a stamp is off by at most a 32nd of it."""
SINGULAR = 1e-6
"""Least CC SS - CS^2 of (1): below it cosine and sine are one wave, as near half a regular rate."""


def periodogram(
    time: Floats, values: Floats, oversampling: float, highest: float | None = None
) -> tuple[Floats, Floats]:
    """Return frequencies [Hz] up to the highest, by default half the rate, and p of (1).

    There are `oversampling` of them in each 1/T. A stamp is off by at most 1/32 of the shortest period.
    """
    from scipy.fft import next_fast_len, rfft

    if highest is None:
        highest = 0.5 / float(np.median(np.diff(time)))
    step = 1.0 / (GRID * highest)
    place = np.round((time - time[0]) / step).astype(int)
    size = next_fast_len(int(np.ceil(oversampling * (place[-1] + 1))))
    count = size // GRID
    frequency = np.arange(1, count + 1) / (size * step)

    def means(y: Floats) -> tuple[Floats, Floats]:
        """Return <y cos wt>, <y sin wt>, at w = 0 too and up to twice the frequencies."""
        sums = rfft(np.bincount(place, weights=y, minlength=size)) / len(time)
        return sums.real, -sums.imag

    cosine, sine = means(np.ones(len(time)))
    c, s = cosine[1 : count + 1], sine[1 : count + 1]
    c2, s2 = cosine[2 : 2 * count + 1 : 2], sine[2 : 2 * count + 1 : 2]
    y, yc, ys = float(np.mean(values)), *(mean[1 : count + 1] for mean in means(values))
    yc, ys = yc - y * c, ys - y * s
    cc, ss, cs = (1 + c2) / 2 - c**2, (1 - c2) / 2 - s**2, s2 / 2 - c * s
    d = cc * ss - cs**2
    found = (ss * yc**2 + cc * ys**2 - 2 * cs * yc * ys) / np.maximum(d, SINGULAR)  # eq. (1)
    return frequency, np.where(d > SINGULAR, found, 0.0)


NEAR = 0.1
"""Half the width of a folded mode's band, over its frequency."""
FOLDED = 2
"""Modes that are looked for where they appear folded: higher ones hold little of a motion."""
QUIET = "above the modes"
SLOW = "quasi-static"

Named = tuple[float, float, str]
"""Lower and upper edge [Hz], name."""


def named_bands(modes_hz: Sequence[float], rate: float) -> tuple[list[Named], list[str]]:
    """Return bands from 0 to half the rate [Hz], without gaps, and notes on aliasing.

    Parameters
    ----------
    modes_hz : sequence of float
        Frequencies of the arm [Hz], ascending; empty: bands end at an eighth of half the rate.
    rate : float
        Samples a second.
    """
    nyquist = rate / 2
    bands, notes = _unfolded(modes_hz, nyquist), []
    for k, frequency in enumerate(modes_hz, 1):
        if frequency <= nyquist:
            continue
        folded = _folded(frequency, rate)
        if sum(high - low for low, high in folded) > nyquist / 2:
            notes.append(f"at {rate:.3g} Hz, mode {k} folds onto most frequencies")
            continue
        appears = alias(frequency, rate)
        notes.append(f"at {rate:.3g} Hz, mode {k} of {frequency:.3g} Hz appears at {appears:.3g} Hz")
        for low, high in folded if k <= FOLDED else []:
            bands = [piece for band in bands for piece in _overlaid(band, low, high, f"mode {k} aliased")]
    return bands, notes


def _unfolded(modes_hz: Sequence[float], nyquist: float) -> list[Named]:
    """Return the bands of the modes below half the rate."""
    if not len(modes_hz):
        return [(0.0, nyquist / 8, SLOW), (nyquist / 8, nyquist, QUIET)]
    seen = [f for f in modes_hz if f < nyquist]
    edges = [0.0, modes_hz[0] / 2]
    for k, frequency in enumerate(seen):
        between = np.sqrt(frequency * modes_hz[k + 1]) if k + 1 < len(modes_hz) else np.inf
        edges.append(float(min(2 * frequency, between)))
    names = [SLOW, *(f"mode {k}" for k in range(1, len(seen) + 1)), QUIET]
    edges = [min(edge, nyquist) for edge in edges] + [nyquist]
    return [
        (low, high, name) for low, high, name in zip(edges[:-1], edges[1:], names, strict=True) if high > low
    ]


def _folded(frequency: float, rate: float) -> list[tuple[float, float]]:
    """Return the disjoint intervals in which the frequencies about one appear, eq. (2)."""
    low, high, nyquist = (1 - NEAR) * frequency, (1 + NEAR) * frequency, rate / 2
    turns = np.arange(np.ceil(low / nyquist), np.floor(high / nyquist) + 1) * nyquist
    ends = [alias(float(f), rate) for f in (low, *turns, high)]  # between two turns (1) is monotonic
    pieces = sorted((min(pair), max(pair)) for pair in pairwise(ends))
    joined: list[tuple[float, float]] = []
    for start, end in pieces:
        if joined and start <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(end, joined[-1][1]))
        elif end > start:
            joined.append((start, end))
    return joined


def _overlaid(band: Named, low: float, high: float, name: str) -> list[Named]:
    """A band cut where another one lies over it."""
    start, end, own = band
    inner = (max(start, low), min(end, high))
    if inner[0] >= inner[1]:
        return [band]
    pieces = [(start, inner[0], own), (*inner, f"{own} or {name}"), (inner[1], end, own)]
    return [piece for piece in pieces if piece[1] > piece[0]]
