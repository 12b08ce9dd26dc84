"""What the noise of encoders that drive does to everything else.

The angle that drives a simulation is smoothed (`flexarm.measurement.smoothing`), and yet a part of its
noise is left, which moves all that the drive moves; modes with little damping answer it most. With f the
smoothed drive,

    y'_i = f(t_i) + n_i,    n_i white, as large as the record states,                                  (1)

smoothed anew, is as far from f as f is from the truth. The difference of the simulations along both is an
error of each channel: its mean square over `DRAWS` of n is added to the variance of the noise. Without it a
machine whose encoder shakes the model by more than a tracker sees would seem to lack something.
"""

from __future__ import annotations

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.diagnosis.residuals.observed import Observed
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.smoothing import smooth
from flexarm.record import Record

DRAWS = 4
"""Of n in (1): a mode is shaken by little more than its own bandwidth, which is few values."""
COUNTS = 0.3
"""Least error of some channel, over its noise, that is added: a smaller one is 4 % of it."""
SAID = 0.5
"""The same of one that is said."""


def with_drive_noise(observed: Observed, seed: int) -> tuple[Observed, tuple[str, ...]]:
    """The same with noise that holds the errors of (1), and sentences on channels where these matter.

    Raises
    ------
    InvalidParameter, NotConverged
        If the model cannot be simulated along its own drives once more.
    """
    rng = np.random.default_rng(seed)
    errors = [_squared_error(observed, rng)]
    if errors[0].max(initial=0.0) < COUNTS**2:
        return observed, ()
    errors += [_squared_error(observed, rng) for _ in range(DRAWS - 1)]
    square = np.mean(errors, axis=0)
    return observed.with_noise(np.sqrt(1.0 + square)), tuple(_sentences(observed, np.sqrt(square)))


def _squared_error(observed: Observed, rng: np.random.Generator) -> Floats:
    """What (1) does to each of `rows`, mean square over its variance."""
    again = {name: _noisy_again(record, observed.arm, rng) for name, record in observed.records.items()}
    if all(again[name] is record for name, record in observed.records.items()):
        return np.zeros(len(observed.rows))
    moved = observed.with_drives(again).residual(observed.arm) - observed.residual(observed.arm)
    return np.array([float(np.mean(moved[each.where] ** 2)) for each in observed.rows])


def _noisy_again(record: Record, arm: Arm, rng: np.random.Generator) -> Record:
    """A record whose encoders that drive read (1)."""
    if record.kind == "static":
        return record
    noisy = {
        name: record.signals[name].replace(values=_reading(record, name, arm, rng))
        for name in record.drive
        if record.signals[name].quantity == "joint_angle" and record.signals[name].noise_std
    }
    return record.replace(signals=list({**record.signals, **noisy}.values())) if noisy else record


def _reading(record: Record, name: str, arm: Arm, rng: np.random.Generator) -> Floats:
    """Eq. (1)."""
    from scipy.interpolate import PPoly

    signal = record.signals[name]
    noise = float(effects_of(arm, signal).noise(signal.noise_std or 0.0)[0])
    breaks, coefficients = smooth(signal.time, signal.values[:, 0], noise)
    values = PPoly(coefficients, breaks)(signal.time) + noise * rng.standard_normal(len(signal))  # eq. (1)
    values[~np.isfinite(signal.values[:, 0])] = np.nan
    return np.asarray(values[:, None])


def _sentences(observed: Observed, error: Floats) -> list[str]:
    """Of each signal that is disturbed, the most in any of its channels and records."""
    most: dict[str, float] = {}
    for each, size in zip(observed.rows, error.tolist(), strict=True):
        most[each.signal] = max(most.get(each.signal, 0.0), size)
    drives = " and ".join(dict.fromkeys(n for r in observed.records.values() for n in r.drive))
    return [
        f"noise of {drives}, as stated, moves {signal} by up to {size:.2g} times its own noise, which "
        "counts as noise"
        for signal, size in most.items()
        if size > SAID
    ]
