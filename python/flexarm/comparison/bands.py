"""Energy of samples in bands of frequencies, also for unequal spacing.

Samples at times t_i, of a length T, are projected on the cosines

    c_k(t) = cos(pi k (t - t_0 + dt/2)/T),   frequency k/(2 T),   k = 0, 1, 2, ...                    (1)

made orthogonal one after another, so that the energies of bands add up to the energy of the samples. At equal
spacing (1) is the discrete cosine transform; else it is computed in blocks of at most `BLOCK` samples. The
last band is the rest. With a few per cent of drop-outs or jitter as much of a tone leaks into other bands.
Cosines have no jump at the ends of a block, so a slow gap leaks little. The highest edge is the Nyquist
frequency; faster motion appears below it (aliasing), in measurement and prediction alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats

BLOCK = 128
"""Most samples of a block whose samples are not equally spaced."""
EVEN = 1e-3
"""Greatest distance of stamps from an even grid, as a share of its step."""


@dataclass(frozen=True)
class Band:
    """Hold a band of frequencies and the part of a gap in it."""

    low: float
    high: float
    """Its edges [Hz]."""
    rms: float
    """Root of the mean square of the gap's part in the band, all measured directions together."""


def band_edges(time: Floats, modes_hz: Sequence[float], inner: Sequence[float] | None = None) -> list[float]:
    """Return edges [Hz] of bands: half and twice the first mode, or `inner` ones, between 0 and Nyquist.

    Without modes the edges are an eighth and a half of Nyquist.
    """
    if len(time) < 2:
        return []
    nyquist = float(0.5 / np.median(np.diff(time)))
    if inner is None:
        inner = [0.5 * modes_hz[0], 2.0 * modes_hz[0]] if len(modes_hz) else [nyquist / 8, nyquist / 2]
    return [0.0, *(edge for edge in sorted(inner) if 0 < edge < nyquist), nyquist]


def alias(frequency: float, rate: float) -> float:
    """Return the frequency [Hz] at which samples at `rate` [Hz] show a motion of `frequency`."""
    return abs(frequency - rate * round(frequency / rate))


def band_split(time: Floats, values: Floats, edges: Sequence[float]) -> list[Band]:
    """Return the rms of finite samples, (n, channels), in each band; squares add up to their mean square.

    Edges [Hz] rise from 0 to Nyquist, as the instants [s] do.
    """
    if len(edges) < 2 or not len(time):
        return []
    rms = np.sqrt(np.maximum(_energies(time, values, edges), 0.0) / len(time))
    return [Band(low, high, float(r)) for low, high, r in zip(edges[:-1], edges[1:], rms, strict=True)]


def band_parts(time: Floats, values: Floats, edges: Sequence[float]) -> tuple[Floats, Floats]:
    """Split samples into orthogonal parts, (bands, n, channels), which add up to them; as `band_split`.

    The number of cosines (1) of each band adds up to n: white noise has this share of its squares there.
    """
    if _evenly_spaced(time):
        from scipy.fft import dct, idct

        spectrum = dct(values, norm="ortho", axis=0)
        ends = _ends(edges, _length(time), len(time))
        masks = [(np.arange(len(time)) >= i) & (np.arange(len(time)) < j) for i, j in ends]
        parts = [idct(spectrum * mask[:, None], norm="ortho", axis=0) for mask in masks]
        return np.stack(parts), np.array([mask.sum() for mask in masks], dtype=float)
    blocks = max(1, -(-len(time) // BLOCK))
    found = [
        _block_parts(t, v, edges)
        for t, v in zip(np.array_split(time, blocks), np.array_split(values, blocks), strict=True)
    ]
    return np.concatenate([parts for parts, _ in found], axis=1), np.sum([f for _, f in found], axis=0)


def _block_parts(time: Floats, values: Floats, edges: Sequence[float]) -> tuple[Floats, Floats]:
    """Split one block by Householder's QR of its cosines; the last band is the rest."""
    step = float(np.median(np.diff(time))) if len(time) > 1 else 1.0
    length = float(time[-1] - time[0]) + step
    ends = _ends(edges, length, len(time))
    phase = np.pi * (time - time[0] + step / 2) / length
    basis = np.linalg.qr(np.cos(phase[:, None] * np.arange(ends[-1][0])))[0]  # eq. (1)
    parts = [basis[:, i:j] @ (basis[:, i:j].T @ values) for i, j in ends[:-1]]
    return np.stack([*parts, values - sum(parts)]), np.array([j - i for i, j in ends], dtype=float)


def _evenly_spaced(time: Floats) -> bool:
    """Return True if stamps lie on a grid to within `EVEN` of its step, such as those rounded in a file."""
    if len(time) < 2 or time[-1] == time[0]:
        return False
    grid = np.linspace(time[0], time[-1], len(time))
    return bool(np.max(np.abs(time - grid)) < EVEN * (grid[1] - grid[0]))


def _length(time: Floats) -> float:
    """Return the duration [s] of even samples, each of which stands for a step."""
    return float(time[-1] - time[0]) * len(time) / (len(time) - 1)


def _ends(edges: Sequence[float], length: float, count: int) -> list[tuple[int, int]]:
    """Return the range of numbers k of the cosines of each band: k/(2 T) < edge."""
    inner = [min(int(np.ceil(2 * length * edge)), count) for edge in edges[1:-1]]
    return list(zip([0, *inner], [*inner, count], strict=True))


def _energies(time: Floats, values: Floats, edges: Sequence[float]) -> Floats:
    """Return the sum of squares in each band."""
    if _evenly_spaced(time):
        from scipy.fft import dct

        powers = np.sum(dct(values, norm="ortho", axis=0) ** 2, axis=1)
        return _summed(powers, float(np.sum(values**2)), edges, _length(time))
    blocks = max(1, -(-len(time) // BLOCK))
    parts = zip(np.array_split(time, blocks), np.array_split(values, blocks), strict=True)
    found: Floats = np.sum([_block_energy(t, v, edges) for t, v in parts], axis=0)
    return found


def _summed(powers: Floats, total: float, edges: Sequence[float], length: float) -> Floats:
    """Sum powers of the cosines (1) by band; the last band gets the rest of the total."""
    inner = [float(powers[i:j].sum()) for i, j in _ends(edges, length, len(powers))[:-1]]
    return np.array([*inner, total - sum(inner)])


def _block_energy(time: Floats, values: Floats, edges: Sequence[float]) -> Floats:
    """Return the sums of squares of one block; the Cholesky factor of overlaps makes cosines orthogonal."""
    from scipy.linalg import cholesky, solve_triangular

    # Share of a cosine's energy added to each, so that nearly equal ones (aliases) can be told apart.
    rounding = 1e-12
    step = float(np.median(np.diff(time))) if len(time) > 1 else 1.0
    length = float(time[-1] - time[0]) + step
    below = min(int(np.ceil(2 * length * edges[-2])), len(time))  # cosines below the last band
    phase = np.pi * (time - time[0] + step / 2) / length
    cosines = np.cos(phase[:, None] * np.arange(below))  # eq. (1)
    overlap = cosines.T @ cosines + rounding * len(time) * np.eye(below)
    parts = solve_triangular(cholesky(overlap, lower=True), cosines.T @ values, lower=True)
    powers = np.sum(parts**2, axis=1)
    return _summed(powers, float(np.sum(values**2)), edges, length)
