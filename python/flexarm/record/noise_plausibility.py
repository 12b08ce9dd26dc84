"""Noise, jitter and clocks that contradict the samples that they are stated of.

White noise of 1 sigma s makes the k-th differences of readings, and those of rows of one pose, scatter,

    rms(diff^k y) >= s sqrt(binomial(2k, k))                                                          (1)

so that a noise far above that is stated in another unit, if it is a part worth a word of what the signal
shows: records of simulations have none, whatever they state. Filters and air make noise last; samples at more
than 20 Hz are thinned out before they are looked at. Readings that are multiples of a step scatter by
step/sqrt(12) at least: a noise of a twentieth of the step is in another unit as well. What was stated in
between may be wrong too, and samples do not tell. Of joint angles that are sampled quickly the check of a
diagnosis says more (`flexarm.validation.record_remarks`), and steps of encoders are effects.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import comb
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import Problem
from flexarm.record.quantisation_grid import quantisation_step

if TYPE_CHECKING:
    from flexarm.record.record import Record
    from flexarm.record.signal import Signal

STEADY_SHARE, OTHER_SHARE = 0.03, 0.5
"""Least share of the motion that such a noise is of places and angles, and of what rings or rubs."""
STEADY_QUANTITIES = ("position", "deflection", "joint_angle", "inclination", "orientation")
"""Quantities that do not ring by as much as they move."""
ROUNDING = 1e-9
"""Scatter over the stated noise below which it is rounding, of an arm at rest that was simulated."""
LEAST_DIFFERENCES = 12
"""Differences of readings that tell a scatter."""
QUICK_HZ = 50.0
"""Rate of joint angles of which the check says more [Hz]."""


def noise_problems(signal: Signal) -> Iterable[Problem]:
    """Noise unlike the samples, and jitter beyond their distance."""
    where = f"signals.{signal.name}"
    quick = signal.quantity == "joint_angle" and len(signal.time) > 2 and signal.rate_hz >= QUICK_HZ
    if signal.noise_std and not quick and len(signal) > LEAST_DIFFERENCES:
        with np.errstate(over="ignore"):  # of numbers that no sensor gives
            found = list(_noise(signal, signal.noise_std))
        yield from (Problem(f"{where}.noise_std", what) for what in found)
    if len(signal.time) > 2 and signal.jitter_std > 1 / signal.rate_hz:
        what = f"is {signal.jitter_std:g} s (1 sigma), samples are {1 / signal.rate_hz:.3g} s apart"
        yield Problem(f"{where}.jitter_std", f"{what}; it is in s, whatever time_unit")


def _noise(signal: Signal, stated: float) -> Iterable[str]:
    least_step = 20.0  # step of readings over the stated noise
    # Stated noise over (1): what lasts longer than a twentieth of a second may be ten times as much.
    least_ratio = 30.0
    scatter = max(_bound(signal, column) for column in signal.values.T)
    motion = float(np.max(np.nanstd(signal.values, axis=0)))
    share = STEADY_SHARE if signal.quantity in STEADY_QUANTITIES else OTHER_SHARE
    if scatter > ROUNDING * stated and stated > max(least_ratio * scatter, share * motion):
        yield (
            f"is {stated:.3g} {signal.unit}, but values scatter by {scatter:.2g} {signal.unit} at most; "
            "noise_std is in the unit of the signal"
        )
    step = _step(signal)
    if step > least_step * stated:
        yield (
            f"is {stated:.3g} {signal.unit}, but all values are {step:.3g} {signal.unit} apart or multiples "
            "of it, which is noise as well; noise_std is in the unit of the signal"
        )


def _step(signal: Signal) -> float:
    """Step of which all readings of a channel are multiples, 0 if there is none."""
    if signal.quantity in ("joint_angle", "joint_command", "force", "payload_mass"):
        return 0.0  # encoders count, and who loads an arm does so in equal steps
    return max(quantisation_step(column) for column in signal.values.T)


def _bound(signal: Signal, values: Floats) -> float:
    """Return the greatest noise that a channel can have by (1), the least s of its orders; 0 if unknown."""
    repeats = 0.5  # share of readings equal to the one before, above which a coarse sensor hides its scatter
    found = []
    for order in (1, 2, 3) if signal.pose is None else (1,):  # k of (1)
        steps = _differences(signal, values, order)
        steps = steps[np.isfinite(steps)]
        if len(steps) < LEAST_DIFFERENCES or (order == 1 and np.mean(steps == 0) >= repeats):
            return 0.0
        found.append(float(np.sqrt(np.mean(steps**2) / comb(2 * order, order))))  # eq. (1)
    return min(found)


def _differences(signal: Signal, values: Floats, order: int) -> Floats:
    """Return differences of thinned readings; in a record of poses, those of rows of one pose."""
    thinned = 20.0  # rate at which differences are taken [Hz]
    if signal.pose is None:
        return np.diff(values[:: max(1, int(min(signal.rate_hz / thinned, len(values))))], order)
    return np.concatenate([np.diff(values[signal.pose == pose], order) for pose in np.unique(signal.pose)])


def clock_problems(record: Record) -> Iterable[Problem]:
    """Yield clocks whose sigma is large compared with the duration of their signals."""
    # Sigma of a clock [s], and share of what its signals last, from which on it is as good as unknown.
    bad, late = 1.0, 0.05
    for name, clock in record.clocks.items():
        spans = [s.time[-1] - s.time[0] for s in record.signals.values() if s.clock == name and len(s.time)]
        longest = float(max(spans, default=0.0))
        if clock.sigma >= bad and clock.sigma > late * longest > 0:
            what = f"is {clock.sigma:g} s (1 sigma), its signals last {longest:.3g} s; it is in s, not in ms"
            yield Problem(f"clocks.{name}", f'{what}; a clock of which nothing is known is "unknown"')
