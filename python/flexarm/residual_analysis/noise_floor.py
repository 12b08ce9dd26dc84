r"""Noise floor of every signal: how small a residual could be, and the error of its simulation.

The noise of a signal is estimated from its own samples:

    quiet bands   of a residual: its frequencies in 16 bands with k degrees of freedom each,
                  sigma^2 = lower quartile of their sums of squares / that of chi-square             (1)
    repeats       of poses: the scatter of rows about the mean of their pose, pooled                 (2)
    differences   of a drive: `flexarm.measurement.drive_noise`

A slow residual and a vibration touch few of the bands of (1) and do not count. The strongest sines, which
leak into other bands, are removed first (orthogonal matching pursuit [Pati1993]), and so are outliers, which
spread over all of them. A residual that is fast and broad, as from impacts, does count: (1) is then more than
the noise. A residual is correlated from sample to sample unless it is white noise; its effective sample size
(3) is what an information criterion may count.

The error of the simulation is the rms change of the predicted signal, all channels together, when

    step     is halved: the method is of order two, so this is 3/4 of the error                      (4)
    mesh     of every beam is twice as fine: of order four, 15/16 of the error                       (5)
    alpha    is 0, without numerical damping, instead of its default                                 (6)

Each should be below the noise. (4) is found for every record, the others for that with the fastest drive, or
for all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf, isinf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord, by_name, simulate_record
from flexarm.comparison.bands import band_split
from flexarm.comparison.step_check import change, step_note, step_taken
from flexarm.errors import NotConverged
from flexarm.measurement.drive_noise import drive_noise
from flexarm.measurement.outliers import outliers
from flexarm.pictures import Summarised
from flexarm.record import Signal
from flexarm.residual_analysis.policy import POLICY
from flexarm.wording import with_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from flexarm.arm import Arm


BANDS = 16
LEAST_SAMPLES = 8 * BANDS


def exceeds_noise(squares: float, freedoms: float, false_alarm: float) -> bool:
    """Return True if a sum of squares, over their variance, exceeds the chi-square of white noise."""
    from scipy.special import chdtri

    # less than one degree of freedom spreads no wider than one whose variance is that much smaller
    scale = min(freedoms, 1.0)
    return bool(scale > 0 and squares / scale > chdtri(max(freedoms, 1.0), false_alarm))


def estimated_noise(pair: AlignedRecord, signal: Signal, residual: Floats) -> float | None:
    """Return 1 sigma of a channel by (1) or (2), from the residual; None given too few samples."""
    keep = np.isfinite(residual).all(axis=1)
    if pair.record.kind == "static":
        return repeated_noise(np.asarray(signal.pose)[keep], residual[keep])
    keep &= ~outliers(residual, pair.simulated.noise(signal))
    return quiet_band_noise(pair.simulated.instants(signal, pair.aligned.placement)[keep], residual[keep])


def quiet_band_noise(time: Floats, values: Floats) -> float | None:
    """Return 1 sigma of a channel by (1), given values of shape (n, channels)."""
    n, channels = values.shape
    if n < LEAST_SAMPLES:
        return None
    from scipy.special import chdtri

    nyquist = float(0.5 / np.median(np.diff(time)))
    values, taken = _without_sines(time, values)
    k = channels * (n - taken) / BANDS
    bands = band_split(time, values, np.linspace(0.0, nyquist, BANDS + 1).tolist())
    squares = n * np.array([band.rms**2 for band in bands])
    return float(np.sqrt(np.quantile(squares, 0.25) / chdtri(k, 0.75)))  # eq. (1)


def _without_sines(time: Floats, values: Floats) -> tuple[Floats, int]:
    """Return values without their strongest sines, at most eight, and the freedoms taken of each channel."""
    step = float(np.median(np.diff(time)))
    place = np.round((time - time[0]) / step).astype(np.intp)
    grid = np.zeros((place[-1] + 1, values.shape[1]))
    columns, rest = np.empty((len(time), 0)), values
    for _ in range(8):
        grid[place] = rest
        powers = np.sum(np.abs(np.fft.rfft(grid, 4 * len(grid), axis=0)) ** 2, axis=1)
        peak = int(np.argmax(powers))
        if powers[peak] <= POLICY.peak_over_median * np.median(powers):
            break
        phase = np.pi * peak / (2 * len(grid)) * (time - time[0]) / step
        columns = np.column_stack([columns, np.cos(phase), np.sin(phase)])
        basis = np.linalg.qr(columns)[0]
        rest = values - basis @ (basis.T @ values)
    return rest, columns.shape[1]


def repeated_noise(pose: NDArray[np.str_], values: Floats) -> float | None:
    """Return 1 sigma of a channel by (2); None where no pose was measured twice."""
    names, number = np.unique(pose, return_inverse=True)
    freedoms = len(pose) - len(names)
    if freedoms < 1:
        return None
    count = np.bincount(number)
    means = np.stack([np.bincount(number, column) / count for column in values.T], axis=1)
    return float(np.sqrt(np.sum((values - means[number]) ** 2) / (freedoms * values.shape[1])))  # eq. (2)


def effective_samples(values: Floats) -> float:
    r"""Return the effective sample size of values, shape (n, channels).

        n_eff = n/(1 + 2 sum_k rho_k),                                                               (3)

    the autocorrelations rho_k summed up to the first that is not positive [Geyer1992].
    """
    n = len(values)
    centred = values - values.mean(axis=0) if n else values
    if n < 4 or not np.any(centred):
        return float(n)
    spectrum = np.fft.rfft(centred, 2 * n, axis=0)
    covariance = np.fft.irfft(np.sum(np.abs(spectrum) ** 2, axis=1))[:n]
    rho = covariance[1:] / covariance[0]
    ends = np.flatnonzero(rho <= 0)
    return float(n / (1 + 2 * np.sum(rho[: ends[0] if len(ends) else n])))  # eq. (3)


@dataclass(frozen=True)
class SignalFloor:
    """Noise floor of one signal in one record."""

    record: str
    signal: str
    unit: str
    """Which one; the unit of everything below."""
    channels: int
    """Number of channels of the residual."""
    stated: float | None
    estimated: float | None
    """Noise of a channel, 1 sigma: from the record, effects of the model included, and from the samples."""
    errors: Mapping[str, float]
    """By "step", "mesh" and "alpha": change of the prediction, rms of all channels together; infinite where
    the other simulation did not converge."""
    samples: int
    """Rows with a value."""
    independent: float
    """Effective sample size of the residual."""
    is_drive: bool = False
    """True if it drives the simulation."""

    @property
    def total(self) -> float | None:
        """Noise of all channels together: the stated one, else the estimated one."""
        noise = self.stated or self.estimated
        return None if noise is None else noise * float(np.sqrt(self.channels))

    @property
    def below(self) -> Mapping[str, bool]:
        """By error: True if it is below the noise; without noise, if it is zero."""
        return {name: error <= (self.total or 0.0) for name, error in self.errors.items()}

    @property
    def contradicts(self) -> bool:
        """True if the samples show another noise than is stated."""
        if not self.stated or not self.estimated:
            return False
        return not 1 / POLICY.noise_ratio < self.estimated / self.stated < POLICY.noise_ratio


@dataclass(frozen=True, repr=False)
class NoiseFloor(Summarised):
    """Noise floor of every signal."""

    signals: tuple[SignalFloor, ...]
    """Floors by record and signal."""
    step: float = 2e-3
    """Time step of the simulations [s]."""

    @property
    def is_below_noise(self) -> bool:
        """True if step, mesh and alpha change every prediction by less than its noise."""
        return all(below for each in self.signals for below in each.below.values())

    @property
    def notes(self) -> tuple[str, ...]:
        """Contradictions of the stated noise, and errors above the noise, in words."""
        found = []
        for each in self.signals:
            at = f"{each.signal} of {each.record}"
            if each.contradicts and each.stated and each.estimated:
                found.append(
                    f"{at} scatters by {with_unit(each.estimated, each.unit, 2)}, "
                    f"{each.estimated / each.stated:.2g} times the stated noise"
                    + (": more noise, or a fast gap" if each.estimated > each.stated else "")
                )
            for name, below in each.below.items():
                if isinf(each.errors[name]):
                    found.append(f"{at}: no convergence with another {name}, whose error is unknown")
                elif name == "step":
                    said = step_note(each.errors[name], each.total or 0.0, self.step)
                    found += [f"{at}: {said}"] if said else []
                elif not below and each.total:
                    found.append(
                        f"{at}: the simulation's {name} counts, {with_unit(each.errors[name], each.unit, 2)} "
                        f"against a noise of {with_unit(each.total, each.unit, 2)}"
                    )
        return tuple(found)

    def summary(self) -> str:
        """Return a table that a person reads: noise of a channel, errors over the noise of all."""
        names = list(dict.fromkeys(name for each in self.signals for name in each.errors))
        head = f"{'record':<12}{'signal':<18}{'unit':<7}{'stated':>11}{'estimated':>11}"
        head += "".join(f"{name + '/noise':>13}" for name in names) + f"{'samples':>9}{'independent':>13}"
        lines = ["floor: noise of a channel, 1 sigma; change of the prediction over the noise", head]
        for each in self.signals:
            label = f"{each.signal} (drive)" if each.is_drive else each.signal
            noise = ["-" if value is None else f"{value:.2e}" for value in (each.stated, each.estimated)]
            total = each.total
            ratios = [f"{each.errors[n] / total:.3f}" if total and n in each.errors else "-" for n in names]
            lines.append(
                f"{each.record:<12}{label:<18}{each.unit:<7}{noise[0]:>11}{noise[1]:>11}"
                + "".join(f"{ratio:>13}" for ratio in ratios)
                + f"{each.samples:9d}{each.independent:13.0f}"
            )
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the errors of the simulation over the noise, one bar each; below 1 they do not matter."""
        import matplotlib.pyplot as plt

        axes = plt.subplots()[1] if ax is None else ax
        shown = [each for each in self.signals if each.errors and each.total]
        names = list(dict.fromkeys(name for each in shown for name in each.errors))
        for k, name in enumerate(names):
            errors = [each.errors.get(name, 0.0) for each in shown]
            ratios = [0.0 if isinf(e) else e / (s.total or 1.0) for e, s in zip(errors, shown, strict=True)]
            axes.bar(np.arange(len(shown)) + 0.25 * (k - 1), ratios, 0.25, label=name)
        axes.axhline(1.0, color="0.3", lw=1, label="noise")
        axes.set(yscale="log", ylabel="change of the prediction over the noise [-]")
        axes.set_xticks(np.arange(len(shown)), [f"{each.signal}\n{each.record}" for each in shown])
        axes.legend()
        return axes


def noise_floor(
    pairs: Mapping[str, AlignedRecord] | AlignedRecord,
    *,
    thorough: bool = False,
    step: float = 2e-3,
    alpha: float = -0.05,
) -> NoiseFloor:
    """Return the noise of every record, and the error of its simulation.

    Takes a simulation of twice the work for each motion, and two more of the fastest; of poses one.

    Parameters
    ----------
    pairs : dict of str to AlignedRecord, or AlignedRecord
        Records by name, as for `localise`.
    thorough : bool
        Find (5) and (6) of every record, not only of the one with the fastest drive.
    step, alpha : float
        Of the simulations in `pairs` [s], [-].

    Raises
    ------
    InvalidParameter
        If there is no record.
    """
    records = by_name(pairs)

    def speed(name: str) -> float:
        """Return the greatest rms rate of a drive [rad/s]; the number of poses."""
        pair = records[name]
        if pair.record.kind == "static":
            return float(len(pair.record.poses))
        rates = np.asarray(pair.simulated.simulation.drive_rate)
        return float(np.sqrt(np.mean(rates**2, axis=0)).max(initial=0.0))

    fastest = max(records, key=speed)
    signals: list[SignalFloor] = []
    for name, pair in records.items():
        signals += _floors(name, pair, _variants(pair, step, alpha, thorough or name == fastest))
    return NoiseFloor(tuple(signals), min(step_taken(pair, step) for pair in records.values()))


def refined(arm: Arm) -> Arm:
    """Return the arm with twice as many elements in every beam."""
    links = [link.replace(elements=2 * link.elements) if link.type == "beam" else link for link in arm.links]
    return arm.replace(links=tuple(links))


def _floors(
    name: str, pair: AlignedRecord, variants: Mapping[str, AlignedRecord | None]
) -> list[SignalFloor]:
    """Return the floors of the signals of one record, given its variants with other simulations."""
    found = []
    for signal in pair.simulated.signals.values():
        residual = pair.simulated.residual(signal, pair.aligned.placement)
        rows = residual[np.isfinite(residual).all(axis=1)]
        is_drive = signal.name in pair.record.drive
        others = {} if is_drive else variants
        stated = float(np.sqrt(np.mean(pair.simulated.noise(signal) ** 2)))
        shown = (
            drive_noise(signal.time, signal.values[:, 0])
            if is_drive and pair.record.kind == "motion"
            else estimated_noise(pair, signal, residual)
        )
        found.append(
            SignalFloor(
                name,
                signal.name,
                "rad" if signal.quantity == "orientation" else signal.unit,
                residual.shape[1],
                None if signal.noise_std is None else stated,
                shown,
                {kind: inf if each is None else change(pair, each, signal) for kind, each in others.items()},
                len(rows),
                effective_samples(rows),
                is_drive,
            )
        )
    return found


def _variants(pair: AlignedRecord, step: float, alpha: float, whole: bool) -> dict[str, AlignedRecord | None]:
    """Return the record with other simulations, (4) or all of them; None where one does not converge."""
    arm, record = pair.simulated.arm, replace(pair.record, links={})  # the arm has these lengths already
    wanted: dict[str, tuple[Arm, float, float]] = {}
    if record.kind == "motion":
        wanted["step"] = (arm, step_taken(pair, step) / 2, alpha)  # eq. (4)
    if whole and any(link.type == "beam" for link in arm.links):
        wanted["mesh"] = (refined(arm), step, alpha)  # eq. (5)
    if whole and record.kind == "motion":
        wanted["alpha"] = (arm, step, 0.0 if alpha else -0.05)  # eq. (6)
    found: dict[str, AlignedRecord | None] = {}
    for kind, (model, length, damping) in wanted.items():
        try:
            found[kind] = simulate_record(model, record, align=False, step=length, alpha=damping)
        except NotConverged:
            found[kind] = None
    return found
