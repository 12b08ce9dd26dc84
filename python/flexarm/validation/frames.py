"""Consistency of frames: positions with a bias, frames that moved.

Positions y of a frame with the pose (R, x) in the base, and their predictions p, leave

    g = y - R^T (p - x)                                                                                (1)

on the measured axes. One pose for two records and one for each are fitted to the rms of (1) by Gauss-Newton
steps from one start, so that what the data do not determine stays. The records do not share the frame if one
pose leaves `unusual_ratio` times as much, and the two poses put places apart by more than `min_shift` of the
reach and `min_sigmas` of a stated registration.

With the gap g = measured - predicted and the prediction p in base axes, an error of the arm turns with the
arm. An offset that does not turn is that of a frame which is not stated:

    |mean g| std(p) > unusual_ratio std(g) |p|                                                         (2)

If a frame moved between two records, the step

    D = mean g in one record - mean g in another                                                       (3)

is the same for all its signals. It is reported beyond `min_sigmas` of the stated registration where two or
more signals agree on it to `shift_agreement`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np

from flexarm.arm.sizes import reach
from flexarm.arrays import Floats
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.frames import rotation_matrix
from flexarm.measurement.sampling import columns
from flexarm.measurement.tracker import base_position
from flexarm.record import Record, Signal
from flexarm.validation.initial_alignment import initial_alignment
from flexarm.validation.policy import POLICY
from flexarm.validation.unshared import Unshared
from flexarm.wording import with_unit


class _Sightings(NamedTuple):
    """Positions seen in a frame, NaN along axes that are not measured, and predicted in the base [m]."""

    measured: Floats
    predicted: Floats


@dataclass(frozen=True, eq=False)
class _Pose:
    """A pose of a frame in the base: p = R y + x."""

    R: Floats
    x: Floats

    def seen(self, places: Floats) -> Floats:
        """Return places of the base as seen in the frame."""
        return (places - self.x) @ self.R

    def rms(self, sightings: _Sightings) -> float:
        """Return the rms of (1), over places."""
        gap = sightings.measured - self.seen(sightings.predicted)
        return float(np.sqrt(np.nanmean(np.nansum(gap**2, axis=1))))

    def fitted(self, sightings: _Sightings) -> _Pose:
        """Return the pose nearby that leaves the least of (1)."""
        pose, centre = self, sightings.predicted.mean(axis=0)
        arms = sightings.predicted - centre
        for _ in range(POLICY.registration_steps):
            gap = sightings.measured - pose.seen(sightings.predicted)
            turning = -np.cross(np.eye(3)[None], arms[:, None])  # of a place about each axis, backwards
            rows = np.concatenate([np.broadcast_to(-np.eye(3), (len(arms), 3, 3)), turning], axis=1) @ pose.R
            known = np.isfinite(gap)
            jacobian = np.swapaxes(rows, 1, 2)[known]
            change = np.linalg.lstsq(jacobian, gap[known], rcond=POLICY.undetermined)[0]
            turn = rotation_matrix(np.asarray(change[3:], dtype=float))
            pose = _Pose(turn @ pose.R, centre + turn @ (pose.x - centre) + change[:3])
            if np.abs(change).max() < 1e-9:
                break
        return pose


def unshared_frames(simulations: Mapping[str, SimulatedRecord]) -> Iterator[Unshared]:
    """Yield frames of one name that are not the same in two records."""
    if len(simulations) < 2:
        return
    placements = {name: initial_alignment(simulated) for name, simulated in simulations.items()}
    names = dict.fromkeys(name for simulated in simulations.values() for name in simulated.record.frames)
    for frame in names:
        seen = {
            name: sightings
            for name, simulated in simulations.items()
            if (sightings := _sightings(simulated, placements[name], frame)) is not None
        }
        for one, other in combinations(seen, 2):
            pair = [(simulations[name], seen[name]) for name in (one, other)]
            start = _Pose(*placements[one].frames[frame].in_base)
            if (apart := _apart(pair, start, frame)) is not None:
                advice = (
                    ", and gaps told record by record do not show that. If the station or the base was "
                    "moved, give the frame two names, or state how the base stood in [base]"
                )
                yield Unshared("frames", frame, one, other, apart, advice)


def _sightings(simulated: SimulatedRecord, placement: Placement, frame: str) -> _Sightings | None:
    """Return the positions seen in a frame, or None if there are too few."""
    measured, predicted = [], []
    for signal in simulated.evidence.values():
        if signal.frame != frame or signal.quantity != "position":
            continue
        full = np.full((len(signal), 3), np.nan)
        full[:, columns(signal.axes)] = simulated.effects(signal).true(signal.values)
        places = base_position(simulated.simulation, signal, simulated.instants(signal, placement))
        keep = np.isfinite(full).any(axis=1) & np.isfinite(places).all(axis=1)
        measured.append(full[keep])
        predicted.append(places[keep])
    if sum(map(len, measured)) < POLICY.min_rows:
        return None
    return _Sightings(np.concatenate(measured), np.concatenate(predicted))


def _apart(pair: Sequence[tuple[SimulatedRecord, _Sightings]], start: _Pose, frame: str) -> str | None:
    """Return how far two records have a frame apart, in words; None if one pose serves both."""
    both = _Sightings(*map(np.concatenate, zip(pair[0][1], pair[1][1], strict=True)))
    shared = start.fitted(both)
    own = [shared.fitted(sightings) for _, sightings in pair]
    moved = own[0].seen(both.predicted) - own[1].seen(both.predicted)
    shift = float(np.sqrt(np.mean(np.sum(moved**2, axis=1))))
    size = reach(pair[0][0].arm)
    stated = [simulated.record.frames[frame] for simulated, _ in pair]
    sigma = 0.0 if any(f.unknown for f in stated) else max(f.translation + size * f.rotation for f in stated)
    together = shared.rms(both)
    squares = [pose.rms(sightings) ** 2 for pose, (_, sightings) in zip(own, pair, strict=True)]
    alone = float(np.sqrt(np.average(squares, weights=[len(each.measured) for _, each in pair])))
    least = max(POLICY.min_shift * size, POLICY.min_sigmas * sigma)
    if shift <= least or together <= POLICY.unusual_ratio * alone:
        return None
    turn = own[0].R.T @ own[1].R
    angle = float(np.arctan2(np.linalg.norm(turn - turn.T) / np.sqrt(8), (np.trace(turn) - 1) / 2))
    return (
        f"on the model it stands {with_unit(angle, 'rad', 2)} apart, and tells places "
        f"{with_unit(shift, 'm', 2)} apart; one pose for both leaves {with_unit(together, 'm', 2)} rms, one "
        f"for each {with_unit(alone, 'm', 2)}"
    )


def remarks_on_unstated_frames(simulations: Mapping[str, SimulatedRecord]) -> Iterator[str]:
    """Report positions without a frame for which (2) holds."""
    for name, simulated in simulations.items():
        for signal in simulated.evidence.values():
            if signal.quantity == "position" and signal.frame == "base":
                yield from (f"{name}: {what}" for what in _shift(simulated, signal))


def _shift(simulated: SimulatedRecord, signal: Signal) -> Iterator[str]:
    placement = initial_alignment(simulated)
    gap = simulated.residual(signal, placement, hold=True)
    known = np.isfinite(gap).all(axis=1)
    if known.sum() < 3:
        return
    gap, place = gap[known], simulated.predicted(signal, placement, hold=True)[known]
    off, far = np.mean(gap, axis=0), float(np.sqrt(np.mean(np.sum(place**2, axis=1))))
    size, left, turned = float(np.linalg.norm(off)), _scatter(gap), _scatter(place) / (far or 1.0)
    least = max(
        POLICY.min_shift * reach(simulated.arm), POLICY.min_noises * float(np.max(simulated.noise(signal)))
    )
    if turned > POLICY.min_motion and size > least and size * turned > POLICY.unusual_ratio * left:  # eq. (2)
        along = ", ".join(
            f"{with_unit(float(value), 'm')} along {axis}"
            for axis, value in zip(signal.axes, off, strict=True)
            if abs(value) > POLICY.min_shift_part * size
        )
        yield (
            f"{signal.name} is off by {along}, wherever the arm stands, to within {with_unit(left, 'm', 2)}, "
            "and no frame is stated for it: if it does not count from the base, give it one in [frames] with "
            "its sigma; else a diagnosis takes that for the arm's"
        )


def _scatter(values: np.ndarray) -> float:
    """Return the root mean square distance from the mean."""
    return float(np.sqrt(np.mean(np.sum((values - np.mean(values, axis=0)) ** 2, axis=1))))


def remarks_on_frames(simulations: Mapping[str, SimulatedRecord]) -> list[str]:
    """Report frames that moved between one record and the next, by (3)."""
    gaps = {name: _mean_gaps(simulated) for name, simulated in simulations.items()}
    return [
        remark
        for one, other in pairwise(simulations)
        for frame in dict.fromkeys(frame for frame, _, _ in gaps[one])
        for axis in "xyz"
        for remark in _moved(simulations[one].record, frame, axis, one, other, gaps)
    ]


def _mean_gaps(simulated: SimulatedRecord) -> dict[tuple[str, str, str], float]:
    """Return the mean gap of every position, by frame, signal and axis."""
    placement = initial_alignment(simulated)
    found = {}
    for signal in simulated.evidence.values():
        if signal.quantity == "position" and not simulated.record.frame_of(signal).unknown:
            means = np.nanmean(simulated.residual(signal, placement, hold=True), axis=0)
            for axis, mean in zip(signal.axes, means, strict=True):
                found[signal.frame, signal.name, axis] = float(mean)
    return found


def _moved(
    record: Record,
    frame: str,
    axis: str,
    one: str,
    other: str,
    gaps: Mapping[str, Mapping[tuple[str, str, str], float]],
) -> list[str]:
    """Report a step (3) that is large and alike for all signals of the frame."""
    keys = [key for key in gaps[one] if key[0] == frame and key[2] == axis and key in gaps[other]]
    if len(keys) < 2 or frame not in record.frames:
        return []
    steps = np.array([gaps[other][key] - gaps[one][key] for key in keys])  # eq. (3)
    middle = float(np.median(steps))
    sigma = float(np.max(record.frames[frame].translation))
    differ = np.ptp(steps) > POLICY.shift_agreement * abs(middle)
    if differ or abs(middle) <= POLICY.min_sigmas * max(sigma, 1e-6):
        return []
    return [
        f"{one} and {other} contradict each other: {', '.join(key[1] for key in keys)} lie {middle:.3g} m "
        f"apart along {axis}, as if the frame {frame} had moved between them"
    ]
