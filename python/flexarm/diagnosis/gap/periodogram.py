r"""How much of the squares of a signal a sine of each frequency takes away, from samples at any instants.

The periodogram of Lomb and Scargle with a floating mean [Zechmeister2009, eq. (5) to (15)]. With means over
the samples, Y = <y>, C = <cos wt>, S = <sin wt>,

.. math:: p = \frac{SS \, YC^2 + CC \, YS^2 - 2 \, CS \, YC \, YS}{CC \, SS - CS^2},                   (1)

where YC = <y cos wt> - Y C, CC = <cos^2 wt> - C^2 and so on; p is what the best sine takes of <y^2> - Y^2.
Sums over n samples for as many frequencies are n^2 operations, and numbers where all are laid out at once:
minutes and tens of GB for a minute at 1 kHz. So the stamps are put on a grid finer than the sampling, on
which the sums are fast Fourier transforms; the squares of cosine and sine follow from 2w.
"""

from __future__ import annotations

import numpy as np

from flexarm.arrays import Floats

GRID = 16
"""Places of the grid in the shortest period: a stamp is off by at most a 32nd of it."""
SINGULAR = 1e-6
"""Least CC SS - CS^2 of (1): below it cosine and sine are one wave, as near half a regular rate."""


def periodogram(
    time: Floats, values: Floats, oversampling: float, highest: float | None = None
) -> tuple[Floats, Floats]:
    """Frequencies [Hz] up to the highest, by default half the rate, and p of (1).

    There are `oversampling` of them in each 1/T.
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
        """<y cos wt>, <y sin wt>, at w = 0 too and up to twice the frequencies."""
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
