r"""Spectra of samples at any instants, named bands of frequency, and order tracking.

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

Order tracking finds the part of a residual that repeats with every turn of a motor. With
the motor's angle n q, n the gear ratio, and the share w of a turn of the joint that the direction shows,

    h = w sum_m a_m u_m + sum_r (b_mr x_mr + c_mr x'_mr/omega_r),     u_m = cos(m n q), sin(m n q)    (3)
    x'' + 2 zeta_r omega_r x' + omega_r^2 x = omega_r^2 u_m                                          (4)

x_mr is the response of mode r of the model to the wave of order m: near resonance most of the residual. An
angle does not alias: waves and responses are computed at the simulation's steps and read at the samples'
instants, however fast the motor turns.

The columns of (3) are made orthogonal to the slow part of the residual, polynomials in angle, rate and
acceleration. Any columns explain something. An order m is taken only if it explains `order_contrast` times
what the columns of slightly higher or lower orders explain, more than noise and `order_share` of the squares,
and if the motor turns often enough.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.comparison.bands import alias
from flexarm.filters import recursive_filter
from flexarm.residual_analysis.motion_states import JointStates
from flexarm.residual_analysis.noise_floor import exceeds_noise
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


@dataclass(frozen=True, eq=False)
class Harmonic:
    """One motor order of a residual."""

    joint: str
    """Whose motor turns."""
    multiple: int
    """Order: periods a turn of the motor."""
    columns: Floats
    """Of (3), without slow parts. Shape (n, k)."""
    band_hz: tuple[float, float]
    """Frequencies of the wave, 5 to 95 % of the samples."""


@dataclass(eq=False)
class MotorHarmonics:
    """Waves of the motors of one record, with the responses of its modes; each is computed once."""

    pair: AlignedRecord
    _found: dict[tuple[str, float], Floats] = field(default_factory=dict)

    def at(self, joint: str, multiple: float, instants: Floats) -> Floats:
        """Return u, x, x'/omega of (3)-(4), shape (m, columns), for `multiple` rad a radian of the joint."""
        run = self.pair.simulated.simulation
        grid = np.linspace(run.time[0], run.time[-1], len(run.time))
        key = (joint, multiple)
        if key not in self._found:
            angle = np.interp(grid, run.time, np.asarray(run.drive_angle)[:, run.joints.index(joint)])
            columns = []
            for wave in (np.cos(multiple * angle), np.sin(multiple * angle)):
                columns.append(wave)
                for frequency, damping in self.pair.modes[: POLICY.modes]:
                    columns += _modal_response(wave, grid[1] - grid[0], 2 * np.pi * frequency, damping)
            self._found[key] = np.stack(columns, axis=1)
        return np.stack([np.interp(instants, grid, column) for column in self._found[key].T], axis=1)


def _modal_response(wave: Floats, step: float, omega: float, damping: float) -> list[Floats]:
    """Return x and x'/omega of (4) from rest under the first value, by the trapezoidal rule.

    The damping ratio is 0.005 at least, so that a response forgets how it began.
    """
    k, loss = 2 / step, 2 * max(damping, 5e-3) * omega  # d/dt is k (z - 1)/(z + 1)
    below = np.array([k**2 + k * loss + omega**2, 2 * (omega**2 - k**2), k**2 - k * loss + omega**2])
    above = omega**2 * np.array([1.0, 2.0, 1.0]), omega * k * np.array([1.0, 0.0, -1.0])
    given = wave - wave[0]
    return [recursive_filter(np.convolve(given, each)[: len(given)], below) for each in above]


def detected_harmonics(
    values: Floats,
    sigma: float,
    time: Floats,
    waves: MotorHarmonics,
    states: Sequence[JointStates],
    ratios: Sequence[float],
    shares: Sequence[Floats | float],
) -> list[Harmonic]:
    """Return the motor orders 1 to 4 that the residual `values` (n,) of one signal along one direction holds.

    `sigma` is its noise, `time` (n,) its instants [s], `waves` those of the record. `states`, gear `ratios`
    and `shares` w of (3), each a number or of shape (n,), are of the joints.
    """
    slow = _slow_basis(states)
    rest = values - slow @ (slow.T @ values)
    spacing, found = POLICY.order_spacing, []
    for each, ratio, share in zip(states, ratios, shares, strict=True):

        def columns(
            multiple: float, joint: str = each.joint, ratio: float = ratio, share: Floats | float = share
        ) -> Floats:
            raw = waves.at(joint, multiple * ratio, time) * np.reshape(share, (-1, 1))
            return np.asarray(raw - slow @ (slow.T @ raw))

        for multiple in (1, 2, 3, 4):
            periods = float(np.ptp(each.angle)) * multiple * ratio / (2 * np.pi)
            if not np.any(share) or not each.moves or periods <= 1 / spacing:
                continue
            own = columns(multiple)
            explained, freedoms = _explained(own, rest), own.shape[1]
            few = len(values) < 4 * freedoms or explained < POLICY.order_share * (values @ values)
            if few or not exceeds_noise(explained / sigma**2, freedoms, POLICY.order_false_alarm):
                continue
            factors = (1 - 2 * spacing, 1 - spacing, 1 + spacing, 1 + 2 * spacing)
            if explained > POLICY.order_contrast * max(
                _explained(columns(factor * multiple), rest) for factor in factors
            ):
                speed = multiple * ratio * np.abs(each.rate) / (2 * np.pi)
                low, high = np.quantile(speed, [0.05, 0.95])
                found.append(Harmonic(each.joint, multiple, own, (float(low), float(high))))
    return found


def harmonic_parts(values: Floats, harmonics: Iterable[Harmonic]) -> tuple[list[Floats], Floats]:
    """Return what each harmonic adds to those before it, and the rest; all orthogonal to each other."""
    parts, basis, rest = [], np.empty((len(values), 0)), values
    for each in harmonics:
        own = _orthonormal(each.columns - basis @ (basis.T @ each.columns))
        parts.append(own @ (own.T @ values))
        basis, rest = np.concatenate([basis, own], axis=1), rest - parts[-1]
    return parts, rest


def _orthonormal(columns: Floats) -> Floats:
    """Return a basis of the space of columns, shape (n, rank)."""
    left, size, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, size > 1e-9 * max(size.max(initial=0.0), 1e-300)])


def _slow_basis(states: Sequence[JointStates]) -> Floats:
    """Return a basis of slow functions of the joints' states."""
    columns = [np.ones(len(states[0].angle))]
    for each in states:
        angle = each.angle - each.angle.mean()
        angle = angle / max(np.abs(angle).max(), 1e-12)
        columns += [angle**p for p in range(1, 5)]
        columns += [state / max(np.abs(state).max(), 1e-12) for state in (each.rate, each.acceleration)]
    return _orthonormal(np.stack(columns, axis=1))


def _explained(columns: Floats, values: Floats) -> float:
    """Return the squares of values that columns explain, by their normal equations."""
    right = columns.T @ values
    return float(right @ np.linalg.pinv(columns.T @ columns, rcond=1e-10, hermitian=True) @ right)
