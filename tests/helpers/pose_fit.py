"""Parameters of a model fitted to static records by Gauss-Newton, apart from the diagnosis of the package.

Residuals are measured less predicted over the stated noise, derivatives those of `solve_poses`. Unknown
frames are parameters like others: a `frame_registration` effect of the model, which starts from the record's
rigid fit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flexarm import Arm, Record
from flexarm.arm.parameter import parameters, with_value
from flexarm.comparison.alignment_parameters import stated_placement
from flexarm.comparison.initial_guess import initial_guess
from flexarm.comparison.poses import pose_numbers, solve_poses
from flexarm.comparison.simulated_record import Placement, pair_record
from flexarm.measurement import predict, predict_slopes

Floats = NDArray[np.float64]


def fitted(arm: Arm, records: Sequence[Record], keys: Sequence[str], steps: int = 8) -> Arm:
    """The arm with the values of `keys` that leave the least squares; no priors."""
    keys = [parameter.key for parameter in parameters(arm, keys)]
    for _ in range(steps):
        values = np.array([parameter.value for parameter in parameters(arm, keys)])
        rows = [_rows(arm, record, keys) for record in records]
        right, slopes = (np.concatenate(part) for part in zip(*rows, strict=True))
        size = np.linalg.norm(slopes, axis=0)
        change = np.linalg.lstsq(slopes / size, right, rcond=1e-9)[0] / size
        # A stiffness does not lose more than half of itself in a step.
        limit = np.where(values > 1.0, 0.5 * np.abs(values), np.inf)
        for key, value in zip(keys, values + np.clip(change, -limit, limit), strict=True):
            arm = with_value(arm, key, float(value))
    return arm


def gap(arm: Arm, records: Sequence[Record]) -> list[Floats]:
    """Measured less predicted of every record's first signal that is no input [SI]."""
    found = []
    for record in records:
        (name, residual), *_ = _residuals(arm, record, ()).items()
        found.append(residual[0])
        assert name in record.signals
    return found


def rms(gaps: Sequence[Floats]) -> float:
    """Of all rows: the root of the mean square of their lengths."""
    return float(np.sqrt(np.mean(np.concatenate([np.sum(each**2, axis=1) for each in gaps]))))


def _rows(arm: Arm, record: Record, keys: Sequence[str]) -> tuple[Floats, Floats]:
    right, slopes = [], []
    for name, (residual, slope) in _residuals(arm, record, keys).items():
        noise = record.signals[name].noise_std
        assert noise
        right.append(residual.ravel() / noise)
        slopes.append(slope.reshape(residual.size, -1) / noise)
    return np.concatenate(right), np.concatenate(slopes)


def _residuals(arm: Arm, record: Record, keys: Sequence[str]) -> dict[str, tuple[Floats, Floats]]:
    run = solve_poses(record.applied_to(arm), record, sensitivities=keys)
    stamps = pose_numbers(record)
    inputs = {n: "input" for n, s in record.signals.items() if n in record.drive or s.quantity == "force"}
    pair = pair_record(run, record, stamps, inputs)
    placement = _placement(arm, record)
    found = {}
    for name, signal in pair.evidence.items():
        frame = placement.frame(signal)
        value = predict(run, signal, registration=frame, stamps=stamps[name])
        slope = predict_slopes(run, signal, registration=frame, stamps=stamps[name]) if keys else value
        found[name] = (signal.values - value, slope)
    return found


_PLACED: dict[int, Placement] = {}


def _placement(arm: Arm, record: Record) -> Placement:
    """Frames as stated, unknown ones where the model without effects puts them."""
    if id(record) not in _PLACED:
        plain = arm.replace(effects=(), uncertainty={})
        pair = pair_record(
            solve_poses(record.applied_to(plain), record), record, pose_numbers(record), arm=plain
        )
        _PLACED[id(record)] = initial_guess(pair, stated_placement(record))
    return _PLACED[id(record)]
