"""Smoothing of a measured drive: variations above its stated noise stay, the rest is removed.

An encoder's samples are y_i = f(t_i) + sigma e_i. Joined as they are they accelerate the arm at random (5e-6
rad at 2 ms is 1 rad/s^2) and ring its first mode. f is sought as a cubic spline whose breaks are dense only
where the samples demand it:

    s_p = least-squares spline with a break at every 2^p-th sample,  p = P, P - 1, ..., 0            (1)
    E   = sum over a window of (s_p - s_{p+1})^2 / sigma^2                                          (2)

The spaces of (1) are nested, so s_p - s_{p+1} is a projection of the samples, and E, if they hold nothing but
noise there, is chi-square distributed with as many degrees of freedom as breaks were added in the window.
Windows of 2, 4, 8, ... intervals up to the whole record are tested from narrow to wide; intervals that a
narrow one explains are left out of the wider. A narrow window finds the sharp start of a move, a wide one a
weak oscillation that lasts. Wherever E is above its limit for the false-alarm probability `alarm`, breaks of
step p are set; neighbouring intervals differ by about a factor of two. One last fit, as wide as these breaks
but without their own wave (`penalised_spline`), gives f, which is constant in dwells (`knots_at_rest`).

No property of the arm enters, and noise passes only while the motion itself is as quick as the arm's modes.
Drives are held before their first sample: the fit starts at rest unless the samples contradict that.

Units: those of the samples, times in s. Source: docs/measurement.md; [deBoor2001].
"""

from __future__ import annotations

from functools import lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexarm import _core
from flexarm.errors import InvalidParameter
from flexarm.measurement.knots_at_rest import place_knots_at_rest
from flexarm.measurement.least_squares_spline import fit_spline
from flexarm.measurement.penalised_spline import with_penalty
from flexarm.wording import stamp

COARSEST = 8
"""Intervals of the coarsest spline, about."""

_Number = TypeVar("_Number", np.intp, np.float64)
Pieces = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Breaks (m + 1,) and coefficients (4, m), highest power first, as scipy.interpolate.PPoly has them."""


def smooth(
    time: ArrayLike, values: ArrayLike, noise_std: float, shown: tuple[ArrayLike, ArrayLike] | None = None
) -> Pieces:
    """Return a twice continuously differentiable drive through noisy samples.

    Parameters
    ----------
    time : array_like, shape (n,)
        Rising times [s], with gaps and jitter as they come.
    values : array_like, shape (n,)
        Samples; those that are not finite are drop-outs.
    noise_std : float
        1 sigma of a sample, its quantisation included (step/sqrt(12)); 0 joins the samples as `interpolate`
        does.
    shown : pair of array_like, shapes (n,) and (n,), optional
        Stamps and readings, with this noise, that times and samples were made of. They then say where breaks
        lie and whether the drive starts at rest, so that it depends smoothly on how it was made of them.

    Returns
    -------
    breaks : ndarray, shape (m + 1,)
    coefficients : ndarray, shape (4, m)
        Piecewise cubic polynomial as scipy.interpolate.PPoly has it.

    Raises
    ------
    InvalidParameter
        If noise_std is negative, or times do not rise, or fewer than two samples are finite.

    Examples
    --------
    >>> time = np.linspace(0, 10, 5001)
    >>> breaks, coefficients = smooth(time, np.sin(time), 1e-3)
    >>> coefficients.shape[1] < 100
    True
    """
    t, y = _finite(time, values)
    if not np.isfinite(noise_std) or noise_std < 0:
        raise InvalidParameter(f"noise_std of a drive must be a number not below 0, got {noise_std}")
    if noise_std == 0 or len(t) < 2 * COARSEST:
        return interpolate(t, y)
    stamps, reading = (t, y) if shown is None else _finite(*shown)
    layout = _layout(stamps.tobytes(), reading.tobytes(), float(noise_std))
    if layout is None:
        return interpolate(t, y)
    breaks, at_rest, equal = layout
    breaks, equal, penalty = with_penalty(t, breaks, equal)
    from scipy.interpolate import PPoly

    whole = PPoly.from_spline(fit_spline(t, y, breaks, at_rest, equal, penalty)[0])
    inside = np.flatnonzero(np.diff(whole.x) > 0)  # the repeated knots at both ends span nothing
    return np.append(whole.x[inside], whole.x[-1]), np.ascontiguousarray(whole.c[:, inside])


@lru_cache(maxsize=16)
def _layout(
    stamps: bytes, reading: bytes, noise_std: float
) -> tuple[NDArray[np.intp], bool, frozenset[int]] | None:
    """Return breaks, start at rest, and equal coefficients of the fit; None if every sample is a break.

    A record drives many models: its layout is found once.
    """
    t, y = np.frombuffer(stamps), np.frombuffer(reading)
    steps = _steps(t, y / noise_std)
    if np.all(steps == 0):
        return None
    breaks = _breaks(np.maximum(steps, 1))  # no more coefficients than samples
    breaks, equal = place_knots_at_rest(t, y / noise_std, breaks)
    # Increase of chi-square, one degree of freedom, above which a drive does not start at rest: 5 sigma.
    rest_limit = 25.0
    at_rest, fitted = (fit_spline(t, y, breaks, resting, equal)[1] for resting in (True, False))
    increase = (np.sum((y - at_rest) ** 2) - np.sum((y - fitted) ** 2)) / noise_std**2
    return breaks, bool(increase < rest_limit), equal


def interpolate(time: ArrayLike, values: ArrayLike) -> Pieces:
    """Return the cubic spline through the samples, with the not-a-knot condition at both ends.

    Two samples are joined by a line, three by a parabola. Parameters, result and errors as for `smooth`.
    """
    t, y = _finite(time, values)
    return t, _core.cubic_spline(t, y)


def _finite(time: ArrayLike, values: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    t, y = np.asarray(time, float), np.asarray(values, float)
    if t.ndim != 1 or t.shape != y.shape:
        raise InvalidParameter(f"a drive needs one value for each time, got shapes {t.shape} and {y.shape}")
    keep = np.isfinite(t) & np.isfinite(y)
    t, y = t[keep], y[keep]
    if len(t) < 2:
        raise InvalidParameter(f"a drive needs at least two finite samples, got {len(t)}")
    if np.any(np.diff(t) <= 0):
        row = int(np.flatnonzero(np.diff(t) <= 0)[0]) + 1
        after = f"{stamp(t[row])} s after {stamp(t[row - 1])} s"
        raise InvalidParameter(f"the times of a drive must rise, got {after} in sample {row + 1}")
    return t, y


def _every(step: int, count: int) -> NDArray[np.intp]:
    """Return indices 0, step, 2 step, ... and the last of `count`; a rest below half a step is joined."""
    found = np.arange(0, count, step)
    if count - 1 - found[-1] >= step / 2 and found[-1] < count - 1:
        return np.append(found, count - 1)
    found[-1] = count - 1
    return found


def _steps(t: NDArray[np.float64], scaled: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the exponent p that every sample needs: the smallest for which (2) exceeds the noise there."""
    count = len(t)
    coarsest = int(np.log2(count / COARSEST))
    need = np.full(count, coarsest)
    ends = _every(2**coarsest, count)
    fitted = fit_spline(t, scaled, ends)[1]
    for p in range(coarsest - 1, -1, -1):
        finer = _every(2**p, count)
        finer_fit = fit_spline(t, scaled, finer)[1] if p else scaled
        energy = np.add.reduceat((finer_fit - fitted) ** 2, ends[:-1])  # eq. (2), per interval
        found = _above_noise(energy, (len(finer) - len(ends)) / len(energy))
        need[np.repeat(found, np.diff(np.append(ends[:-1], count)))] = p
        ends, fitted = finer, finer_fit
    return need


def _above_noise(energy: NDArray[np.float64], freedom: float) -> NDArray[np.bool_]:
    """Return the intervals in a window whose energy (2) noise does not explain; `freedom` per interval."""
    from scipy.special import chdtri  # chi2.isf is this; all of scipy.stats takes half a second to import

    alarm = 1e-6  # probability that noise alone sets breaks in a window (2)
    found = np.zeros(len(energy), dtype=bool)
    window = 1
    while window < len(energy) and not found.all():
        window = min(2 * window, len(energy))
        open_ = ~found
        total = _window_sums(energy * open_, window)
        members = _window_sums(open_.astype(np.intp), window)
        counts = np.unique(members[members > 0])
        limit = np.full(window + 1, np.inf)
        limit[counts] = chdtri(counts * freedom, alarm)
        found |= _cover(np.flatnonzero(total > limit[members]), window, len(energy))
    return found


def _window_sums(values: NDArray[_Number], window: int) -> NDArray[_Number]:
    sums = np.concatenate([np.zeros(1, values.dtype), np.cumsum(values, dtype=values.dtype)])
    total: NDArray[_Number] = sums[window:] - sums[:-window]
    return total


def _cover(starts: NDArray[np.intp], window: int, count: int) -> NDArray[np.bool_]:
    """Return the intervals covered by the windows that begin at `starts`."""
    ends = np.zeros(count + 1, dtype=np.intp)
    ends[starts] += 1
    np.subtract.at(ends, starts + window, 1)
    return np.cumsum(ends)[:-1] > 0


def _breaks(need: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return breaks that give every sample the step it needs, and half of that on either side."""
    count = len(need)
    keep = np.zeros(count, dtype=bool)
    keep[_every(2 ** int(need.max()), count)] = True
    for p in range(int(need.max()) - 1, 0, -1):
        coarse = 2 ** (p + 1)
        here = np.logical_or.reduceat(need <= p, np.arange(0, count, coarse))
        near = here.copy()
        near[1:] |= here[:-1]
        near[:-1] |= here[1:]
        fine = _every(2**p, count)
        keep[fine[near[fine // coarse]]] = True
    keep[-1] = True
    return np.flatnonzero(keep)
