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
from flexarm.residual_analysis.policy import POLICY

SLOW = "quasi-static"

Named = tuple[float, float, str]
"""Lower and upper edge [Hz], name."""


def periodogram(
    time: Floats, values: Floats, oversampling: float = 4.0, highest: float | None = None
) -> tuple[Floats, Floats]:
    """Return frequencies [Hz] up to the highest, by default half the rate, and p of (1).

    There are `oversampling` of them in each 1/T. A stamp is off by at most 1/32 of the shortest period.
    """
    from scipy.fft import next_fast_len, rfft

    if highest is None:
        highest = 0.5 / float(np.median(np.diff(time)))
    grid = 16  # places in the shortest period
    step = 1.0 / (grid * highest)
    place = np.round((time - time[0]) / step).astype(int)
    size = next_fast_len(int(np.ceil(oversampling * (place[-1] + 1))))
    count = size // grid
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
    least = 1e-6  # below it cosine and sine are one wave, as near half a regular rate
    found = (ss * yc**2 + cc * ys**2 - 2 * cs * yc * ys) / np.maximum(d, least)  # eq. (1)
    return frequency, np.where(d > least, found, 0.0)


def named_bands(modes_hz: Sequence[float], rate: float) -> tuple[list[Named], list[str]]:
    """Return bands from 0 to half the rate [Hz], without gaps, and notes on aliasing.

    `modes_hz` are the arm's frequencies [Hz], ascending; without any, bands end at an eighth of half the
    rate.
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
        for low, high in folded if k <= POLICY.modes else []:
            bands = [
                piece
                for start, end, own in bands
                for piece in (
                    (start, min(end, low), own),
                    (max(start, low), min(end, high), f"{own} or mode {k} aliased"),
                    (max(start, high), end, own),
                )
                if piece[1] > piece[0]
            ]
    return bands, notes


def _unfolded(modes_hz: Sequence[float], nyquist: float) -> list[Named]:
    """Return the bands of the modes below half the rate."""
    above = "above the modes"
    if not len(modes_hz):
        return [(0.0, nyquist / 8, SLOW), (nyquist / 8, nyquist, above)]
    edges, names = [0.0, modes_hz[0] / 2], [SLOW]
    for k, frequency in enumerate(f for f in modes_hz if f < nyquist):
        between = np.sqrt(frequency * modes_hz[k + 1]) if k + 1 < len(modes_hz) else np.inf
        edges.append(float(min(2 * frequency, between)))
        names.append(f"mode {k + 1}")
    edges = [min(edge, nyquist) for edge in edges] + [nyquist]
    pairs = zip(pairwise(edges), [*names, above], strict=True)
    return [(low, high, name) for (low, high), name in pairs if high > low]


def _folded(frequency: float, rate: float) -> list[tuple[float, float]]:
    """Return the disjoint intervals in which the frequencies about one appear, eq. (2)."""
    width, nyquist = POLICY.band_half_width, rate / 2
    low, high = (1 - width) * frequency, (1 + width) * frequency
    turns = np.arange(np.ceil(low / nyquist), np.floor(high / nyquist) + 1) * nyquist
    ends = [alias(float(f), rate) for f in (low, *turns, high)]  # between two turns (2) is monotonic
    joined: list[tuple[float, float]] = []
    for start, end in sorted((min(pair), max(pair)) for pair in pairwise(ends)):
        if joined and start <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(end, joined[-1][1]))
        elif end > start:
            joined.append((start, end))
    return joined
