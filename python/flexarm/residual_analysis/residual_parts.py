"""The parts of a gap: harmonics of the motors first, then bands of frequency.

    gap = harmonics of the motors + parts by band,   orthogonal to each other in every record         (1)

so squares of parts add up to those of the gap. Harmonics come first: told in the motor's angle they are few
columns, whatever their frequencies (`residual_analysis.order_tracking`, `residual_analysis.spectrum`).
A part with k of n freedoms has the share k/n of white noise.

The gap of one signal, over all records: its parts by direction and band, beside what the arm did.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.comparison.bands import band_parts
from flexarm.comparison.gap import SignalGap, directions_of, drive_angles, signal_gap
from flexarm.measurement.kinematics import point_jacobian
from flexarm.measurement.torque import gear_ratio
from flexarm.residual_analysis.motion_states import JointStates, joined_states, joint_states
from flexarm.residual_analysis.order_tracking import MotorHarmonics, detected_harmonics, harmonic_parts
from flexarm.residual_analysis.spectrum import named_bands

if TYPE_CHECKING:
    from flexarm.record import Signal


PER_TURN = "per motor turn"
"""What a harmonic's name holds."""
POSES = "all poses"
"""Name of the one band that poses have."""


@dataclass(frozen=True, eq=False)
class ResidualPart:
    """What of a gap lies in one band, along one direction.

    Attributes
    ----------
    band : str
        Its name.
    band_hz : tuple of float
        Edges [Hz]; of a harmonic the frequencies that it had.
    values, noise : ndarray, shape (n,)
        The part, and 1 sigma of white noise in it, at every sample.
    freedoms : float
        Number of independent values.
    """

    band: str
    band_hz: tuple[float, float]
    values: Floats
    noise: Floats
    freedoms: float


@dataclass(frozen=True, eq=False)
class Split:
    """What the parts (1) of all directions of a signal in one record have in common.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Instants [s].
    states : sequence of JointStates
        Of the joints that move.
    ratios : sequence of float
        Their gear ratios.
    bands : sequence of (float, float, str)
        Named bands; none for poses.
    waves : MotorHarmonics
        Of the record.
    """

    time: Floats
    states: Sequence[JointStates]
    ratios: Sequence[float]
    bands: Sequence[tuple[float, float, str]]
    waves: MotorHarmonics

    def __call__(
        self, values: Floats, sigma: float, shares: Sequence[Floats | float]
    ) -> tuple[ResidualPart, ...]:
        """Parts of one direction."""
        n = len(values)
        if not self.bands:
            return (ResidualPart(POSES, (0.0, 0.0), values, np.full(n, sigma), float(n)),)
        harmonics = detected_harmonics(values, sigma, self.time, self.waves, self.states, self.ratios, shares)
        waves, rest = harmonic_parts(values, harmonics)
        found = []
        for each, wave in zip(harmonics, waves, strict=True):
            of = f" of {each.joint}" if len(self.states) > 1 else ""
            name, k = f"{each.multiple} {PER_TURN}{of}", float(each.columns.shape[1])
            found.append(ResidualPart(name, each.band_hz, wave, np.full(n, sigma * np.sqrt(k / n)), k))
        edges = [0.0, *(high for _, high, _ in self.bands)]
        split, freedoms = band_parts(self.time, rest[:, None], edges)
        freedoms = freedoms * (1 - sum(part.freedoms for part in found) / n)
        for (low, high, name), part, k in zip(self.bands, split, freedoms.tolist(), strict=True):
            found.append(ResidualPart(name, (low, high), part[:, 0], np.full(n, sigma * np.sqrt(k / n)), k))
        return _merged(found)


def _merged(parts: Sequence[ResidualPart]) -> tuple[ResidualPart, ...]:
    """Parts of one name as one: a folded mode may lie in the midst of a band."""
    found: dict[str, ResidualPart] = {}
    for part in parts:
        if part.band in found:
            part = _sum(found[part.band], part)
        found[part.band] = part
    return tuple(found.values())


def _sum(one: ResidualPart, other: ResidualPart) -> ResidualPart:
    """Two orthogonal parts of the same samples."""
    hull = (min(one.band_hz[0], other.band_hz[0]), max(one.band_hz[1], other.band_hz[1]))
    noise = np.hypot(one.noise, other.noise)
    return ResidualPart(one.band, hull, one.values + other.values, noise, one.freedoms + other.freedoms)


def joined_parts(
    pieces: Sequence[tuple[ResidualPart, ...]], lengths: Sequence[int]
) -> tuple[ResidualPart, ...]:
    """Parts over the samples of all records; a band that a record has not is zero there."""
    found = []
    for band in dict.fromkeys(part.band for parts in pieces for part in parts):
        own = [next((part for part in parts if part.band == band), None) for parts in pieces]
        there = [part for part in own if part is not None]
        pairs = list(zip(own, lengths, strict=True))
        found.append(
            ResidualPart(
                band,
                (min(p.band_hz[0] for p in there), max(p.band_hz[1] for p in there)),
                np.concatenate([p.values if p else np.zeros(n) for p, n in pairs]),
                np.concatenate([p.noise if p else np.zeros(n) for p, n in pairs]),
                sum(p.freedoms for p in there),
            )
        )
    return tuple(found)


@dataclass(frozen=True, eq=False)
class SignalResidual:
    """The gap of one signal at the samples of all records, one record after the other.

    Attributes
    ----------
    signal, unit : str
        Its name, and the unit of the gap.
    labels : tuple of str
        Names of the records that hold it.
    record : ndarray of int, shape (n,)
        Number of each sample's record in `labels`.
    time : ndarray, shape (n,)
        Instants [s], or numbers of poses.
    directions : dict of str to ndarray, shape (n,)
        The gap along each direction.
    noise : dict of str to ndarray, shape (n,)
        Its noise, 1 sigma.
    parts : dict of str to tuple of ResidualPart
        By direction: what it is the sum of.
    states : tuple of JointStates
        Of the joints that move.
    notes : tuple of str
        What a reader should know of aliasing.
    """

    signal: str
    unit: str
    labels: tuple[str, ...]
    record: NDArray[np.intp]
    time: Floats
    directions: Mapping[str, Floats]
    noise: Mapping[str, Floats]
    parts: Mapping[str, tuple[ResidualPart, ...]]
    states: tuple[JointStates, ...]
    notes: tuple[str, ...] = ()

    @property
    def whitened(self) -> Floats:
        """The gap over its noise, shape (n, directions)."""
        return np.stack([self.directions[name] / self.noise[name] for name in self.directions], axis=1)


def signal_residual(
    pairs: Mapping[str, AlignedRecord],
    waves: Mapping[str, MotorHarmonics],
    signal: str,
    joints: Sequence[str],
    joint: str | None,
    noise: float,
) -> SignalResidual | None:
    """The gap of a signal in every record that holds it; None if no row of it can be compared.

    Parameters
    ----------
    pairs : dict of str to AlignedRecord
        Records by name.
    waves : dict of str to MotorHarmonics
        Of the same records.
    signal : str
        The signal.
    joints : sequence of str
        Joints that move.
    joint : str or None
        The one joint whose directions are shown; None: x, y, z of the base.
    noise : float
        1 sigma of a channel where the record states none.
    """
    holding = {name: pair for name, pair in pairs.items() if signal in pair.simulated.evidence}
    found = {name: _of_record(holding[name], waves[name], signal, joints, joint, noise) for name in holding}
    found = {name: piece for name, piece in found.items() if len(piece.time)}
    if not found:
        return None
    directions = tuple(next(iter(found.values())).directions)
    other = [name for name, piece in found.items() if tuple(piece.directions) != directions]
    labels = tuple(name for name in found if name not in other)
    pieces = [found[name] for name in labels]
    lengths = [len(each.time) for each in pieces]
    notes = [note for each in pieces for note in each.notes]
    notes += [f"{signal} of {name} has other directions and is left out" for name in other]
    return SignalResidual(
        signal,
        pieces[0].unit,
        labels,
        np.repeat(np.arange(len(pieces)), lengths),
        np.concatenate([each.time for each in pieces]),
        {name: np.concatenate([each.directions[name] for each in pieces]) for name in directions},
        {name: np.concatenate([each.noise[name] for each in pieces]) for name in directions},
        {name: joined_parts([each.parts[name] for each in pieces], lengths) for name in directions},
        tuple(joined_states([each.states[j] for each in pieces]) for j in range(len(joints))),
        tuple(dict.fromkeys(notes)),
    )


def _of_record(
    pair: AlignedRecord,
    waves: MotorHarmonics,
    name: str,
    joints: Sequence[str],
    joint: str | None,
    noise: float,
) -> SignalResidual:
    """The gap of a signal in one record."""
    subject, signal = pair.simulated, pair.simulated.signals[name]
    gap = signal_gap(subject, signal, pair.aligned.placement, joint, ())
    directions = _directions(pair, signal, gap)
    n = len(gap.time)
    sigma = gap.noise_rms / np.sqrt(len(directions)) if gap.noise_rms else noise
    states = tuple(joint_states(pair, each, gap.time) for each in joints)
    bands, notes = _bands(pair, gap.time)
    split = Split(gap.time, states, [gear_ratio(subject.arm, each) for each in joints], bands, waves)
    parts = {
        direction: split(values, sigma, _shares(pair, signal, joint, joints, gap.time, direction))
        for direction, values in directions.items()
    }
    stated = {direction: np.full(n, sigma) for direction in directions}
    record = np.zeros(n, dtype=np.intp)
    return SignalResidual(
        name, gap.unit, ("",), record, gap.time, directions, stated, parts, states, tuple(notes)
    )


def _directions(pair: AlignedRecord, signal: Signal, gap: SignalGap) -> dict[str, Floats]:
    """The gap along every measured direction; along the sensor's axes where these span too few."""
    found = {name: part for name, part in gap.parts.items() if part is not None}
    channels = 3 if signal.quantity == "orientation" else signal.values.shape[1]
    if len(found) >= channels:
        return found
    residual = pair.simulated.residual(signal, pair.aligned.placement)
    keep = np.isfinite(residual).all(axis=1) & ~pair.simulated.outliers(signal, residual)
    return {f"sensor {axis}": residual[keep, k] for k, axis in enumerate(signal.axes)}


def _bands(pair: AlignedRecord, time: Floats) -> tuple[list[tuple[float, float, str]], list[str]]:
    """Named bands of a signal's samples; none for poses."""
    if pair.record.kind == "static" or len(time) < 3:
        return [], []
    return named_bands(pair.modes_hz, float(1 / np.median(np.diff(time))))


def _shares(
    pair: AlignedRecord,
    signal: Signal,
    joint: str | None,
    joints: Sequence[str],
    time: Floats,
    direction: str,
) -> list[Floats | float]:
    """How much of a turn of each joint shows along a direction; 1 where kinematics do not say."""
    if signal.quantity != "position" or signal.point is None or direction.startswith("sensor"):
        return [1.0] * len(joints)
    unit = directions_of(pair.simulated, signal, joint, time)[direction]
    angles, arm = drive_angles(pair.simulated, time), pair.simulated.arm
    return [np.sum(unit * point_jacobian(arm, each, signal.point, angles), axis=1) for each in joints]
