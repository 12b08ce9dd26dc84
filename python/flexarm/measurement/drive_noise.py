"""Noise of a drive, from its own samples.

A motion is smooth from sample to sample, so that its sixth divided differences hold noise alone,

    D_i = sum_j w_ij y_{i+j},   w_ij = prod_{k != j} 1/(t_{i+j} - t_{i+k}),   j, k = 0 ... 6,
    var(D_i) = sigma^2 sum_j w_ij^2,   sigma = 1.4826 median |D_i|/(sum_j w_ij^2)^(1/2)               (1)

whatever the distances of the stamps. Readings that are counts scatter by step/sqrt(12) at least; while the
joint stands that is all that they show.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from flexarm.arrays import Floats
from flexarm.record import Record, Signal
from flexarm.record.quantisation_grid import quantisation_step
from flexarm.wording import with_unit


def drive_noise(time: Floats, samples: Floats) -> float | None:
    """Return 1 sigma of samples of a smooth motion by (1); None if they are few.

    Both have shape (n,). Samples that are not finite are drop-outs.
    """
    order = 6  # a motion of 1 Hz, sampled at 50 Hz, shows 1e-7 of its amplitude in (1)
    least, most = 128, 20_000  # differences: the median of 128 errs by a tenth; more than 20 000 tell no more
    known = np.isfinite(samples)
    time, samples = time[known], samples[known]
    if len(samples) < least + order:
        return None
    first = np.unique(np.linspace(0, len(samples) - 1 - order, most).astype(np.intp))
    rows = first[:, None] + np.arange(order + 1)
    t = time[rows] / np.median(np.diff(time))
    weights = 1 / np.prod(t[:, :, None] - t[:, None, :] + np.eye(order + 1), axis=2)
    difference = np.sum(weights * samples[rows], axis=1)
    return float(1.4826 * np.median(np.abs(difference) / np.linalg.norm(weights, axis=1)))  # eq. (1)


def with_drive_noise(record: Record) -> tuple[Record, list[str]]:
    """Return a record of a motion with the noise of its driving angles, and remarks.

    Of a drive whose noise is not stated it is that of its samples. Few samples tell none.
    """
    noisy: dict[str, Signal] = {}
    for name in record.drive if record.kind == "motion" else ():
        signal = record.signals[name]
        if signal.quantity == "joint_angle" and signal.noise_std is None:
            samples = signal.values[:, 0]
            noise = drive_noise(signal.time, samples)
            if noise is not None:
                noise = max(noise, quantisation_step(samples) / sqrt(12))
                noisy[name] = signal.replace(noise_std=noise)
    remarks = [
        f"no noise is stated for the drive {name}: the {with_unit(noise, signal.unit, 2)} that its samples "
        "show count instead"
        for name, signal in noisy.items()
        if (noise := signal.noise_std)
    ]
    return record.replace(signals={**record.signals, **noisy}) if noisy else record, remarks
